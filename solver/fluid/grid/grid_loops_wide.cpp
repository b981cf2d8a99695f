// The grid loops over SIMD lanes, compiled once for each target. The formulas are those of grid_loops_scalar.cpp.
#include <froude/solver/fluid/grid/grid_loops.h>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "froude/solver/fluid/grid/grid_loops_wide.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep
#include <hwy/highway.h>

#if HWY_TARGET != HWY_SCALAR  // scalar is grid_loops_scalar.cpp
HWY_BEFORE_NAMESPACE();
namespace froude {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using F = hn::CappedTag<float, 16>;
using V = hn::Vec<F>;
using M = hn::Mask<F>;
constexpr std::size_t kLanes = HWY_LANES(float) < 16 ? HWY_LANES(float) : 16;
constexpr std::size_t kChunks = 16 / kLanes;  // of a row

// What a tile's rows need: the places around, and which lanes lie at its sides.
struct TileView {
  TileView(const GridOperator& a, std::size_t t) : link(a.links[t]), base(t * 256) {
    const F f;
    for (std::size_t c = 0; c < kChunks; ++c) {
      last[c] = hn::Eq(hn::Iota(f, static_cast<float>(c * kLanes)), hn::Set(f, static_cast<float>(link.lane)));
    }
  }
  const TileLinks& link;
  std::size_t base;
  M last[kChunks];

  HWY_INLINE std::size_t row(std::int32_t j) const { return base + static_cast<std::size_t>(16 * j); }
  HWY_INLINE std::size_t below(std::int32_t j) const { return j == 0 ? link.down : row(j) - 16; }
  HWY_INLINE std::size_t above(std::int32_t j) const { return j == link.rows - 1 ? link.up : row(j) + 16; }
};

// Σ a·x_neighbour of chunk c of row j.
HWY_INLINE V neighbours(const GridOperator& a, const TileView& tile, const float* x, std::int32_t j, std::size_t c) {
  const F f;
  const std::size_t row = tile.row(j), at = row + c * kLanes, shift = c * kLanes;
  const std::size_t above = tile.above(j) + shift, below = tile.below(j) + shift;
  V left = hn::LoadU(f, x + at - 1);
  if (c == 0) {
    left = hn::IfThenElse(hn::FirstN(f, 1), hn::Set(f, x[tile.link.left + static_cast<std::size_t>(16 * j)]), left);
  }
  const V beyond = hn::Set(f, x[tile.link.right + static_cast<std::size_t>(16 * j)]);
  const V right = hn::IfThenElse(tile.last[c], beyond, hn::LoadU(f, x + at + 1));
  V sum = hn::Mul(hn::Load(f, a.ax + at), left);
  sum = hn::MulAdd(hn::Load(f, a.ar + at), right, sum);
  V other = hn::Mul(hn::Load(f, a.ay + at), hn::Load(f, x + below));
  other = hn::MulAdd(hn::Load(f, a.ay + above), hn::Load(f, x + above), other);
  return hn::Add(sum, other);
}

// r − A x.
HWY_INLINE V rest(const GridOperator& a, const TileView& tile, const float* r, const float* x, std::int32_t j,
                  std::size_t c) {
  const F f;
  const std::size_t at = tile.row(j) + c * kLanes;
  const V sum = hn::Add(hn::Load(f, r + at), neighbours(a, tile, x, j, c));
  return hn::NegMulAdd(hn::Load(f, a.diagonal + at), hn::Load(f, x + at), sum);
}

HWY_INLINE double total(const V* sums) {
  const F f;
  double all = 0.0;
  for (std::size_t c = 0; c < kChunks; ++c) all += static_cast<double>(hn::GetLane(hn::SumOfLanes(f, sums[c])));
  return all;
}

HWY_INLINE double largest(const V* values) {
  const F f;
  V all = values[0];
  for (std::size_t c = 1; c < kChunks; ++c) all = hn::Max(all, values[c]);
  return static_cast<double>(hn::GetLane(hn::MaxOfLanes(f, all)));
}

HWY_INLINE void clear(V* sums) {
  for (std::size_t c = 0; c < kChunks; ++c) sums[c] = hn::Zero(F());
}

// Sums of neighbouring lanes of a row of 16, stored as 8.
HWY_INLINE void storePairs(const V* row, float* to) {
  const F f;
  if constexpr (kChunks == 1) {
    const hn::Half<F> half;
    const V even = hn::ConcatEven(f, row[0], row[0]), odd = hn::ConcatOdd(f, row[0], row[0]);
    hn::StoreU(hn::LowerHalf(half, hn::Add(even, odd)), half, to);
  } else {
    for (std::size_t c = 0; c < kChunks; c += 2) {
      const V even = hn::ConcatEven(f, row[c + 1], row[c]), odd = hn::ConcatOdd(f, row[c + 1], row[c]);
      hn::StoreU(hn::Add(even, odd), f, to + c / 2 * kLanes);
    }
  }
}

// Every second lane of a row of 16, stored as 8.
HWY_INLINE void storeEven(const V* row, float* to) {
  const F f;
  if constexpr (kChunks == 1) {
    const hn::Half<F> half;
    hn::StoreU(hn::LowerHalf(half, hn::ConcatEven(f, row[0], row[0])), half, to);
  } else {
    for (std::size_t c = 0; c < kChunks; c += 2) {
      hn::StoreU(hn::ConcatEven(f, row[c + 1], row[c]), f, to + c / 2 * kLanes);
    }
  }
}

void assemble(const GridAssembly& a, double* sums, std::size_t begin, std::size_t end) {
  const F f;
  GridOperator links;
  links.links = a.links;
  const V one = hn::Set(f, 1.0f), zero = hn::Zero(f);
  for (std::size_t t = begin; t < end; ++t) {
    const TileView tile(links, t);
    TileLinks& rows = a.links[t];
    rows.first = rows.end = 0;
    V sum[kChunks];
    clear(sum);
    for (std::int32_t j = 0; j < 16; ++j) {
      V most = zero;
      const bool within = j < tile.link.rows;
      for (std::size_t c = 0; c < kChunks; ++c) {
        const std::size_t at = tile.row(j) + c * kLanes;
        if (!within) {
          for (float* out : {a.ar, a.diagonal, a.inverse}) hn::Store(zero, f, out + at);
          continue;
        }
        const V lane = hn::Iota(f, static_cast<float>(c * kLanes)),
                last = hn::Set(f, static_cast<float>(tile.link.lane));
        const V beyond = hn::Set(f, a.ax[tile.link.right + static_cast<std::size_t>(16 * j)]);
        V right = hn::IfThenElse(tile.last[c], beyond, hn::LoadU(f, a.ax + at + 1));
        right = hn::IfThenElseZero(hn::Le(lane, last), right);
        hn::Store(right, f, a.ar + at);
        const V upright = hn::Add(hn::Load(f, a.ay + at), hn::Load(f, a.ay + tile.above(j) + c * kLanes));
        const V joined = hn::Add(hn::Add(hn::Load(f, a.ax + at), right), upright);
        sum[c] = hn::Add(sum[c], joined);
        const V diagonal = hn::Add(joined, hn::Load(f, a.ground + at));
        hn::Store(diagonal, f, a.diagonal + at);
        const M known = hn::Gt(diagonal, zero);
        most = hn::Max(most, diagonal);
        hn::Store(hn::IfThenElseZero(known, hn::Div(one, hn::IfThenElse(known, diagonal, one))), f, a.inverse + at);
      }
      if (hn::AllFalse(f, hn::Gt(most, zero))) continue;
      if (rows.end == 0) rows.first = j;
      rows.end = j + 1;
    }
    sums[t] = total(sum);
  }
}

void coarsen(const GridCoarsening& a, std::size_t begin, std::size_t end) {
  const F f;
  const V half = hn::Set(f, 0.5f), share = hn::Set(f, a.share);
  for (std::size_t t = begin; t < end; ++t) {
    for (std::size_t j = 0; j < 8; ++j) {
      V x[kChunks], y[kChunks], ground[kChunks];
      for (std::size_t c = 0; c < kChunks; ++c) {
        const std::size_t at = t * 256 + 32 * j + c * kLanes;
        x[c] = hn::Mul(half, hn::Add(hn::Load(f, a.ax + at), hn::Load(f, a.ax + at + 16)));
        y[c] = hn::Mul(half, hn::Load(f, a.ay + at));
        ground[c] = hn::Mul(share, hn::Add(hn::Load(f, a.ground + at), hn::Load(f, a.ground + at + 16)));
      }
      const std::size_t to = a.parents[t].place + 16 * j;
      storeEven(x, a.coarseX + to);
      storePairs(y, a.coarseY + to);
      storePairs(ground, a.coarseGround + to);
    }
  }
}

void positive(const float* values, std::uint16_t* bits, std::size_t begin, std::size_t end) {
  const F f;
  for (std::size_t row = 16 * begin; row < 16 * end; ++row) {
    std::uint32_t word = 0;
    for (std::size_t c = 0; c < kChunks; ++c) {
      std::uint8_t bytes[8] = {};
      hn::StoreMaskBits(f, hn::Gt(hn::Load(f, values + 16 * row + c * kLanes), hn::Zero(f)), bytes);
      word |= (bytes[0] | static_cast<std::uint32_t>(bytes[1]) << 8) << (c * kLanes);
    }
    bits[row] = static_cast<std::uint16_t>(word);
  }
}

void clean(const GridOperator& a, float* x, std::size_t begin, std::size_t end) {
  const F f;
  for (std::size_t k = begin * 256; k < end * 256; k += kLanes) {
    const M known = hn::Gt(hn::Load(f, a.inverse + k), hn::Zero(f));
    hn::Store(hn::IfThenElseZero(known, hn::Load(f, x + k)), f, x + k);
  }
}

void apply(const GridOperator& a, const float* x, float* q, double* sums, std::size_t begin, std::size_t end) {
  const F f;
  for (std::size_t t = begin; t < end; ++t) {
    const TileView tile(a, t);
    V sum[kChunks];
    clear(sum);
    for (std::int32_t j = tile.link.first; j < tile.link.end; ++j) {
      for (std::size_t c = 0; c < kChunks; ++c) {
        const std::size_t at = tile.row(j) + c * kLanes;
        const V own = hn::Load(f, x + at);
        const V value = hn::MulSub(hn::Load(f, a.diagonal + at), own, neighbours(a, tile, x, j, c));
        hn::Store(value, f, q + at);
        sum[c] = hn::MulAdd(own, value, sum[c]);
      }
    }
    sums[t] = total(sum);
  }
}

void residual(const GridOperator& a, const float* b, const float* x, float* r, std::size_t begin, std::size_t end) {
  const F f;
  for (std::size_t t = begin; t < end; ++t) {
    const TileView tile(a, t);
    for (std::int32_t j = tile.link.first; j < tile.link.end; ++j) {
      for (std::size_t c = 0; c < kChunks; ++c) {
        const std::size_t at = tile.row(j) + c * kLanes;
        const M known = hn::Gt(hn::Load(f, a.inverse + at), hn::Zero(f));
        hn::Store(hn::IfThenElseZero(known, rest(a, tile, b, x, j, c)), f, r + at);
      }
    }
  }
}

void smooth(const GridOperator& a, const float* r, const float* x, float weight, float* out, double* sums,
            std::size_t begin, std::size_t end) {
  const F f;
  const V w = hn::Set(f, weight), keep = hn::Set(f, 1.0f - weight);
  for (std::size_t t = begin; t < end; ++t) {
    const TileView tile(a, t);
    V sum[kChunks];
    clear(sum);
    for (std::int32_t j = tile.link.first; j < tile.link.end; ++j) {
      for (std::size_t c = 0; c < kChunks; ++c) {
        const std::size_t at = tile.row(j) + c * kLanes;
        const V own = hn::Load(f, r + at);
        const V change = hn::Mul(hn::Load(f, a.inverse + at), hn::Add(own, neighbours(a, tile, x, j, c)));
        const V value = hn::MulAdd(w, change, hn::Mul(keep, hn::Load(f, x + at)));
        hn::Store(value, f, out + at);
        sum[c] = hn::MulAdd(own, value, sum[c]);
      }
    }
    if (sums != nullptr) sums[t] = total(sum);
  }
}

void start(const GridOperator& a, const float* r, float weight, float* out, double* sums, std::size_t begin,
           std::size_t end) {
  const F f;
  const V w = hn::Set(f, weight);
  for (std::size_t t = begin; t < end; ++t) {
    V most[kChunks];
    clear(most);
    for (std::int32_t j = a.links[t].first; j < a.links[t].end; ++j) {
      for (std::size_t c = 0; c < kChunks; ++c) {
        const std::size_t at = t * 256 + static_cast<std::size_t>(16 * j) + c * kLanes;
        const V own = hn::Load(f, r + at);
        hn::Store(hn::Mul(hn::Mul(w, hn::Load(f, a.inverse + at)), own), f, out + at);
        most[c] = hn::Max(most[c], hn::Abs(own));
      }
    }
    if (sums != nullptr) sums[t] = largest(most);
  }
}

void restrictResidual(const GridOperator& a, const float* r, const float* x, const TileParent* parents, float* coarse,
                      std::size_t begin, std::size_t end) {
  for (std::size_t t = begin; t < end; ++t) {
    const TileView tile(a, t);
    for (std::int32_t j = tile.link.first & ~1; j < tile.link.end; j += 2) {
      V sum[kChunks];
      for (std::size_t c = 0; c < kChunks; ++c) {
        sum[c] = rest(a, tile, r, x, j, c);
        if (j + 1 < tile.link.rows) sum[c] = hn::Add(sum[c], rest(a, tile, r, x, j + 1, c));
      }
      storePairs(sum, coarse + parents[t].place + 8 * j);
    }
  }
}

void prolong(const GridOperator& a, const float* coarse, const TileParent* parents, float* x, std::size_t begin,
             std::size_t end) {
  const F f;
  const hn::RebindToSigned<F> whole;
  const auto twice = hn::IndicesFromVec(f, hn::ShiftRight<1>(hn::Iota(whole, 0)));
  for (std::size_t t = begin; t < end; ++t) {
    for (auto j = static_cast<std::size_t>(a.links[t].first); j < static_cast<std::size_t>(a.links[t].end); ++j) {
      const float* from = coarse + parents[t].place + 16 * (j / 2);
      for (std::size_t c = 0; c < kChunks; ++c) {
        const std::size_t at = t * 256 + 16 * j + c * kLanes;
        const M known = hn::Gt(hn::Load(f, a.inverse + at), hn::Zero(f));
        const V change = hn::TableLookupLanes(hn::LoadU(f, from + c * kLanes / 2), twice);
        hn::Store(hn::Add(hn::Load(f, x + at), hn::IfThenElseZero(known, change)), f, x + at);
      }
    }
  }
}

void advance(const GridOperator& a, float step, const float* p, const float* q, float* kappa, float* r, float weight,
             float* z, double* sums, std::size_t begin, std::size_t end) {
  const F f;
  const V along = hn::Set(f, step), w = hn::Set(f, weight);
  for (std::size_t t = begin; t < end; ++t) {
    V most[kChunks];
    clear(most);
    for (std::int32_t j = a.links[t].first; j < a.links[t].end; ++j) {
      for (std::size_t c = 0; c < kChunks; ++c) {
        const std::size_t at = t * 256 + static_cast<std::size_t>(16 * j) + c * kLanes;
        hn::Store(hn::MulAdd(along, hn::Load(f, p + at), hn::Load(f, kappa + at)), f, kappa + at);
        const V left = hn::NegMulAdd(along, hn::Load(f, q + at), hn::Load(f, r + at));
        hn::Store(left, f, r + at);
        hn::Store(hn::Mul(hn::Mul(w, hn::Load(f, a.inverse + at)), left), f, z + at);
        most[c] = hn::Max(most[c], hn::Abs(left));
      }
    }
    sums[t] = largest(most);
  }
}

void direct(const GridOperator& a, const float* z, float share, float* p, std::size_t begin, std::size_t end) {
  const F f;
  const V keep = hn::Set(f, share);
  for (std::size_t t = begin; t < end; ++t) {
    const auto first = t * 256 + static_cast<std::size_t>(16 * a.links[t].first);
    const auto last = t * 256 + static_cast<std::size_t>(16 * a.links[t].end);
    for (std::size_t k = first; k < last; k += kLanes) {
      hn::Store(hn::MulAdd(keep, hn::Load(f, p + k), hn::Load(f, z + k)), f, p + k);
    }
  }
}

}  // namespace

const GridLoops& wideGridLoops() {
  static constexpr GridLoops kLoops{assemble, coarsen, positive,         clean,   apply,   residual,
                                    smooth,   start,   restrictResidual, prolong, advance, direct};
  return kLoops;
}

}  // namespace HWY_NAMESPACE
}  // namespace froude
HWY_AFTER_NAMESPACE();
#endif

#if HWY_ONCE
namespace froude {

const GridLoops& gridLoops(SimdTarget target) {
  switch (target) {
#if (HWY_TARGETS & HWY_AVX3)
    case SimdTarget::Avx3:
      return N_AVX3::wideGridLoops();
#endif
#if (HWY_TARGETS & HWY_AVX2)
    case SimdTarget::Avx2:
      return N_AVX2::wideGridLoops();
#endif
#if (HWY_TARGETS & HWY_SSE4)
    case SimdTarget::Sse4:
      return N_SSE4::wideGridLoops();
#endif
    default:
      return scalarGridLoops();
  }
}

}  // namespace froude
#endif
