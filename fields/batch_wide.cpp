// The batch over SIMD lanes, compiled once for each target. The formulas are those of EdgeGrid::sample, without fused
// multiply-adds, so that all targets agree to the bit.
//
// A chunk of points is looked up first; those near an outline are packed together, so that no lane waits for a point
// that is far from everything. Then each lane walks the list of its own point: a repeated edge changes nothing, so
// lanes with shorter lists repeat their last one. What lanes cannot decide (mixed outlines, long lists, signs within
// rounding, points outside the grid) is asked for point by point.
#include <froude/fields/batch_loop.h>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "froude/fields/batch_wide.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep
#include <hwy/highway.h>

#if HWY_TARGET != HWY_SCALAR
HWY_BEFORE_NAMESPACE();
namespace froude::detail {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using D = hn::CappedTag<double, 8>;
using I = hn::Rebind<std::int32_t, D>;
using U = hn::RebindToUnsigned<D>;
using V = hn::Vec<D>;
using W = hn::Vec<hn::RebindToSigned<D>>;
using M = hn::Mask<D>;

constexpr std::size_t kChunk = 256;
constexpr std::size_t kMostLanes = 8;

static_assert(sizeof(GridEdge) == 64);
constexpr std::size_t kEdgeDoubles = sizeof(GridEdge) / sizeof(double);
constexpr std::size_t kStart = 0, kDirection = 4, kLength = 6;  // pairs of doubles in a GridEdge
constexpr std::uint64_t kConvexStart = std::uint64_t{1} << 62;  // in its last eight bytes

/// Points of a chunk, with the codes of their lists.
struct Packed {
  alignas(64) std::int32_t code[kChunk + kMostLanes];
  alignas(64) std::int32_t point[kChunk + kMostLanes];
  std::size_t count = 0;
};

/// A chunk of points in the grid's frame, and those of them that are near an outline.
struct Chunk {
  alignas(64) double x[kChunk];
  alignas(64) double y[kChunk];
  Packed few;             // with one or two edges: most
  Packed many;            // with more
  std::size_t begin = 0;  // number of the chunk's first point
};

constexpr unsigned kAllLanes = (1u << HWY_MIN(HWY_LANES(double), 8)) - 1;

HWY_INLINE W wide(hn::Vec<I> v) { return hn::PromoteTo(hn::RebindToSigned<D>(), v); }

HWY_INLINE unsigned bitsOf(M mask) {
  std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(D(), mask, bytes);
  return bytes[0];
}

/// Two neighbouring doubles of one edge for each lane, turned into two vectors.
HWY_INLINE void loadPairs(const double* const* edges, std::size_t at, V& first, V& second) {
  const D d;
#if HWY_TARGET <= HWY_AVX3
  const auto pair = [&](std::size_t k) HWY_ATTR { return hn::LoadDup128(d, edges[k] + at); };
  const V even = hn::ConcatUpperLower(d, hn::OddEvenBlocks(pair(6), pair(4)), hn::OddEvenBlocks(pair(2), pair(0)));
  const V odd = hn::ConcatUpperLower(d, hn::OddEvenBlocks(pair(7), pair(5)), hn::OddEvenBlocks(pair(3), pair(1)));
#elif HWY_TARGET <= HWY_AVX2
  const V even = hn::ConcatUpperLower(d, hn::LoadDup128(d, edges[2] + at), hn::LoadDup128(d, edges[0] + at));
  const V odd = hn::ConcatUpperLower(d, hn::LoadDup128(d, edges[3] + at), hn::LoadDup128(d, edges[1] + at));
#else
  const V even = hn::Load(d, edges[0] + at), odd = hn::Load(d, edges[1] + at);
#endif
  first = hn::InterleaveLower(d, even, odd);
  second = hn::InterleaveUpper(d, even, odd);
}

class Batch {
 public:
  explicit Batch(const BatchTask& task) : task_(task), grid_(*task.grid), b_(*task.batch) {}

  void run(std::size_t begin, std::size_t end) {
    const std::size_t lanes = hn::Lanes(D());
    const std::size_t whole = begin + (end - begin) / lanes * lanes;
    for (; begin < whole; begin += kChunk) {
      chunk_.begin = begin;
      chunk_.few.count = chunk_.many.count = 0;
      for (std::size_t i = begin; i < std::min(whole, begin + kChunk); i += lanes) lookUp(i);
      pad(chunk_.few);
      for (std::size_t n = 0; n < chunk_.few.count; n += lanes) nearestOfTwo(n);
      pad(chunk_.many);
      for (std::size_t n = 0; n < chunk_.many.count; n += lanes) nearestOfMany(n);
    }
    batchScalar(task_, whole, end);
  }

 private:
  /// The lanes behind the last point ask for it again.
  static HWY_INLINE void pad(Packed& packed) {
    if (packed.count == 0) return;
    for (std::size_t n = packed.count; n < packed.count + hn::Lanes(D()); ++n) {
      packed.code[n] = packed.code[packed.count - 1];
      packed.point[n] = packed.point[packed.count - 1];
    }
  }

  /// A vector of points from i on. Those near an outline are packed for more; if there are others, all get the bound of
  /// their cell first.
  HWY_INLINE void lookUp(std::size_t i) {
    const D d;
    const I n;
    const V x0 = hn::LoadU(d, b_.x.data() + i), y0 = hn::LoadU(d, b_.y.data() + i);
    V x = x0, y = y0;
    if (task_.placed) {
      const V c = hn::Set(d, task_.pose.rotation.c), s = hn::Set(d, task_.pose.rotation.s);
      const V dx = hn::Sub(x, hn::Set(d, task_.pose.position.x())),
              dy = hn::Sub(y, hn::Set(d, task_.pose.position.y()));
      x = hn::Add(hn::Mul(c, dx), hn::Mul(s, dy));
      y = hn::Add(hn::Mul(hn::Neg(s), dx), hn::Mul(c, dy));
    }
    const Box& box = grid_.box();
    const M in = hn::And(hn::And(hn::Ge(x, hn::Set(d, box.min.x())), hn::Le(x, hn::Set(d, box.max.x()))),
                         hn::And(hn::Ge(y, hn::Set(d, box.min.y())), hn::Le(y, hn::Set(d, box.max.y()))));
    const V inverse = hn::Set(d, grid_.inverseCellSize());
    const V cx = hn::IfThenElseZero(in, hn::Mul(hn::Sub(x, hn::Set(d, box.min.x())), inverse));
    const V cy = hn::IfThenElseZero(in, hn::Mul(hn::Sub(y, hn::Set(d, box.min.y())), inverse));
    const V ix = hn::Min(hn::Floor(cx), hn::Set(d, grid_.nx() - 1));
    const V iy = hn::Min(hn::Floor(cy), hn::Set(d, grid_.ny() - 1));
    hn::Store(x, d, chunk_.x + (i - chunk_.begin));
    hn::Store(y, d, chunk_.y + (i - chunk_.begin));
    // Whole numbers below 2³¹ as doubles are exact, and so is the number of the cell. Behind the last cell there is one
    // more for what lies outside.
    const V number = hn::Add(hn::Mul(iy, hn::Set(d, grid_.nx())), ix);
    const auto cell = hn::DemoteTo(n, hn::IfThenElse(in, number, hn::Set(d, static_cast<double>(grid_.cellCount()))));
    auto code = hn::GatherIndex(n, reinterpret_cast<const std::int32_t*>(grid_.codes().data()), cell);
    const auto divided = hn::Lt(code, hn::Zero(n));
    if (!hn::AllFalse(n, divided)) {
      code = hn::IfThenElse(divided, partCode(divided, code, hn::Sub(cx, ix), hn::Sub(cy, iy)), code);
    }
    const auto listed = hn::Gt(code, hn::Set(n, static_cast<std::int32_t>(kListOffsetMask)));
    const auto many = hn::Gt(code, hn::Set(n, static_cast<std::int32_t>(listCode(kListOffsetMask, 2))));
    const auto first = static_cast<std::int32_t>(i - chunk_.begin);
    pack(hn::AndNot(many, listed), code, first, chunk_.few);
    if (HWY_UNLIKELY(!hn::AllFalse(n, many))) pack(many, code, first, chunk_.many);
    if (hn::AllTrue(n, listed)) return;
    V clearance = hn::PromoteTo(d, hn::GatherIndex(hn::Rebind<float, D>(), grid_.clearance().data(), cell));
    M answered = in;
    if (!hn::AllTrue(d, in) && grid_.freeOutside()) {
      const V infinity = hn::Set(d, kInfinity);
      answered = hn::Or(in, hn::And(hn::Lt(hn::Abs(x), infinity), hn::Lt(hn::Abs(y), infinity)));
      clearance = hn::IfThenElse(in, clearance, gapToOutlines(x, y));
    }
    writeBound(i, x0, y0, clearance);
    const auto unlisted = hn::AndNot(listed, hn::Ne(code, hn::Zero(n)));
    if (HWY_UNLIKELY(!hn::AllTrue(d, answered) || !hn::AllFalse(n, unlisted))) {
      std::uint8_t odd[8] = {};
      hn::StoreMaskBits(n, unlisted, odd);
      for (unsigned bits = (odd[0] | ~bitsOf(answered)) & kAllLanes; bits != 0; bits &= bits - 1) {
        const std::size_t at = i - chunk_.begin + static_cast<std::size_t>(__builtin_ctz(bits));
        writeSample(task_, chunk_.begin + at, Vec2(chunk_.x[at], chunk_.y[at]));
      }
    }
  }

  /// As EdgeGrid::lowerBound outside the grid.
  HWY_INLINE V gapToOutlines(V x, V y) const {
    const D d;
    const Box& box = grid_.outlines();
    const V zero = hn::Zero(d);
    const V outX = hn::Max(hn::Max(hn::Sub(hn::Set(d, box.min.x()), x), hn::Sub(x, hn::Set(d, box.max.x()))), zero);
    const V outY = hn::Max(hn::Max(hn::Sub(hn::Set(d, box.min.y()), y), hn::Sub(y, hn::Set(d, box.max.y()))), zero);
    return hn::Mul(hn::Sqrt(hn::Add(hn::Mul(outX, outX), hn::Mul(outY, outY))), hn::Set(d, 1.0 - 1e-15));
  }

  template <class Mask32, class V32>
  static HWY_INLINE void pack(Mask32 wanted, V32 code, std::int32_t first, Packed& packed) {
    const I n;
#if HWY_TARGET <= HWY_AVX3
    hn::StoreU(hn::Compress(code, wanted), n, packed.code + packed.count);
    hn::StoreU(hn::Compress(hn::Iota(n, first), wanted), n, packed.point + packed.count);
    packed.count += hn::CountTrue(n, wanted);
#else
    alignas(32) std::int32_t codes[kMostLanes];
    hn::Store(code, n, codes);
    std::uint8_t bits[8] = {};
    hn::StoreMaskBits(n, wanted, bits);
    for (std::size_t k = 0; k < hn::Lanes(n); ++k) {
      packed.code[packed.count] = codes[k];
      packed.point[packed.count] = first + static_cast<std::int32_t>(k);
      packed.count += bits[0] >> k & 1;
    }
#endif
  }

  /// As partIndex, for the lanes that are divided; (fx, fy) is the place in the cell.
  template <class Mask32, class V32>
  HWY_INLINE V32 partCode(Mask32 divided, V32 code, V fx, V fy) const {
    const D d;
    const I n;
    const auto shift = hn::And(hn::ShiftRight<kPartsBits>(code), hn::Set(n, 7));
    const auto one = hn::Set(n, 1);
    // 2^shift for the shifts there are; a shift by lanes is not to be had everywhere.
    const auto side = hn::IfThenElse(hn::Eq(shift, hn::Set(n, kManyPartsShift)), hn::Set(n, 1 << kManyPartsShift),
                                     hn::Set(n, 1 << kPartsShift));
    const V sideWide = hn::PromoteTo(d, side);
    const auto last = hn::Sub(side, one);
    const auto px = hn::Min(hn::Max(hn::DemoteTo(n, hn::Mul(fx, sideWide)), hn::Zero(n)), last);
    const auto py = hn::Min(hn::Max(hn::DemoteTo(n, hn::Mul(fy, sideWide)), hn::Zero(n)), last);
    const auto first = hn::And(code, hn::Set(n, static_cast<std::int32_t>(kFirstPartMask)));
    const auto at = hn::IfThenElseZero(divided, hn::Add(first, hn::Add(hn::Mul(py, side), px)));
    return hn::GatherIndex(n, reinterpret_cast<const std::int32_t*>(grid_.partCodes().data()), at);
  }

  HWY_INLINE void writeBound(std::size_t i, V x, V y, V clearance) {
    const D d;
    if (!b_.distance.empty()) hn::StoreU(clearance, d, b_.distance.data() + i);
    if (!b_.normalX.empty()) {
      hn::StoreU(hn::Zero(d), d, b_.normalX.data() + i);
      hn::StoreU(hn::Zero(d), d, b_.normalY.data() + i);
    }
    if (!b_.closestX.empty()) {
      hn::StoreU(x, d, b_.closestX.data() + i);
      hn::StoreU(y, d, b_.closestY.data() + i);
    }
    if (!b_.edge.empty()) std::fill_n(b_.edge.data() + i, hn::Lanes(d), -1);
    if (!b_.feature.empty()) std::fill_n(b_.feature.data() + i, hn::Lanes(d), FeatureKind::None);
  }

  /// The closest feature so far; as EdgeGrid::Nearest, for one outline.
  struct Best {
    V inside, outside, square;  // squared distances
    V x, y;                     // outward, unit for edges
    V left;                     // of the line of the edge, signed
    W edge;
    M vertex;

    HWY_INLINE Best()
        : inside(hn::Set(D(), kInfinity)),
          outside(inside),
          square(inside),
          x(hn::Zero(D())),
          y(x),
          left(x),
          edge(hn::Zero(hn::RebindToSigned<D>())),
          vertex(hn::MaskFromVec(x)) {}
  };

  HWY_INLINE void consider(W number, V x, V y, Best& best) const {
    const D d;
    const U u;
    const V zero = hn::Zero(d), infinity = hn::Set(d, kInfinity);
    alignas(64) std::int64_t index[kMostLanes];
    hn::Store(number, hn::RebindToSigned<D>(), index);
    const auto* edges = reinterpret_cast<const double*>(grid_.edges().data());
    const double* edge[kMostLanes];
    for (std::size_t l = 0; l < hn::Lanes(d); ++l) edge[l] = edges + kEdgeDoubles * static_cast<std::size_t>(index[l]);
    V ax, ay, dx, dy, length, flags;
    loadPairs(edge, kStart, ax, ay);
    loadPairs(edge, kDirection, dx, dy);
    loadPairs(edge, kLength, length, flags);
    const V armX = hn::Sub(x, ax), armY = hn::Sub(y, ay);
    const V along = hn::Add(hn::Mul(dx, armX), hn::Mul(dy, armY));
    const V left = hn::Sub(hn::Mul(dx, armY), hn::Mul(dy, armX));
    const M vertex = hn::Lt(along, zero);
    const V square = hn::IfThenElse(vertex, hn::Add(hn::Mul(armX, armX), hn::Mul(armY, armY)), hn::Mul(left, left));
    const V counted = hn::IfThenElse(hn::Gt(along, length), infinity, square);
    const M convex = hn::RebindMask(d, hn::TestBit(hn::BitCast(u, flags), hn::Set(u, kConvexStart)));
    const M within = hn::Or(hn::AndNot(vertex, hn::Gt(left, zero)), hn::AndNot(convex, vertex));
    best.inside = hn::IfThenElse(within, hn::Min(best.inside, counted), best.inside);
    best.outside = hn::IfThenElse(within, best.outside, hn::Min(best.outside, counted));
    const M better = hn::Lt(counted, best.square);
    best.square = hn::IfThenElse(better, counted, best.square);
    best.x = hn::IfThenElse(better, hn::IfThenElse(vertex, armX, dy), best.x);
    best.y = hn::IfThenElse(better, hn::IfThenElse(vertex, armY, hn::Neg(dx)), best.y);
    best.left = hn::IfThenElse(better, left, best.left);
    best.edge = hn::IfThenElse(hn::RebindMask(hn::RebindToSigned<D>(), better), number, best.edge);
    best.vertex = hn::Or(hn::And(better, vertex), hn::AndNot(better, best.vertex));
  }

  /// Both edges of a list by one look-up, and no branch that depends on the points.
  HWY_INLINE void nearestOfTwo(std::size_t k) {
    const hn::RebindToSigned<D> w;
    const I n;
    const auto point = hn::LoadU(n, chunk_.few.point + k);
    const auto code = hn::LoadU(n, chunk_.few.code + k);
    const W offset = wide(hn::And(code, hn::Set(n, static_cast<std::int32_t>(kListOffsetMask))));
    const auto* lists = reinterpret_cast<const std::int64_t*>(grid_.lists().data());
    const W both = hn::GatherOffset(w, lists, hn::ShiftLeft<2>(offset));
    const W first = hn::And(both, hn::Set(w, 0xFFFFFFFF)), second = hn::ShiftRight<32>(both);
    const auto one = hn::Lt(wide(code), hn::Set(w, static_cast<std::int64_t>(listCode(0, 2))));
    const V x = hn::GatherIndex(D(), chunk_.x, wide(point)), y = hn::GatherIndex(D(), chunk_.y, wide(point));
    Best best;
    consider(first, x, y, best);
    consider(hn::IfThenElse(one, first, second), x, y, best);
    answer(chunk_.few, k, x, y, best);
  }

  HWY_INLINE void nearestOfMany(std::size_t k) {
    const I n;
    const auto point = hn::LoadU(n, chunk_.many.point + k);
    const auto code = hn::LoadU(n, chunk_.many.code + k);
    const auto offset = hn::And(code, hn::Set(n, static_cast<std::int32_t>(kListOffsetMask)));
    const auto last = hn::Sub(hn::ShiftRight<kListOffsetBits>(code), hn::Set(n, 1));
    const auto* lists = reinterpret_cast<const std::int32_t*>(grid_.lists().data());
    const auto longest = hn::GetLane(hn::MaxOfLanes(n, last));
    const V x = hn::GatherIndex(D(), chunk_.x, wide(point)), y = hn::GatherIndex(D(), chunk_.y, wide(point));
    Best best;
    for (std::int32_t it = 0; it <= longest; ++it) {
      consider(wide(hn::GatherIndex(n, lists, hn::Add(offset, hn::Min(hn::Set(n, it), last)))), x, y, best);
    }
    answer(chunk_.many, k, x, y, best);
  }

  HWY_INLINE void answer(const Packed& packed, std::size_t n, V x, V y, const Best& best) {
    const D d;
    const V rounding = hn::Set(d, grid_.rounding() * grid_.rounding());
    // As EdgeGrid::Nearest::closeSource: what is within rounding, of both kinds or of the boundary, is not for lanes.
    const V gap = hn::Sub(best.inside, best.outside);
    const V doubt = hn::Mul(rounding, hn::Max(best.square, rounding));
    const M sure = hn::And(hn::Gt(hn::Mul(gap, gap), hn::Mul(hn::Set(d, 4.0), doubt)), hn::Gt(best.square, rounding));
    const M in = hn::Lt(best.inside, best.outside);
    const V magnitude = hn::IfThenElse(best.vertex, hn::Sqrt(best.square), hn::Abs(best.left));
    const V sign = hn::IfThenElse(in, hn::Set(d, -1.0), hn::Set(d, 1.0));
    const V distance = hn::Mul(sign, magnitude);
    const V scale = hn::IfThenElse(best.vertex, hn::Div(sign, magnitude), hn::Set(d, 1.0));
    const V normalX = hn::Mul(best.x, scale), normalY = hn::Mul(best.y, scale);
    M known = sure;
    if (!grid_.oneOutline()) {
      const double reach = kBandMargin * grid_.band();
      known = hn::And(known, hn::Le(best.square, hn::Set(d, reach * reach)));
    }
    const std::size_t count = std::min(packed.count - n, hn::Lanes(d));
    const unsigned wide = bitsOf(known) & ((1u << count) - 1);
    const bool contiguous =
        packed.point[n + count - 1] - packed.point[n] + 1 == static_cast<std::int32_t>(hn::Lanes(d)) &&
        count == hn::Lanes(d);
    write(packed, n, count, contiguous, distance, b_.distance);
    if (!b_.normalX.empty()) {
      const auto [wx, wy] = turned(normalX, normalY);
      write(packed, n, count, contiguous, wx, b_.normalX);
      write(packed, n, count, contiguous, wy, b_.normalY);
    }
    if (!b_.closestX.empty()) writeClosest(packed, n, count, contiguous, x, y, distance, normalX, normalY, best);
    if (!b_.edge.empty() || !b_.feature.empty()) writeFeature(packed, n, count, best);
    if (HWY_UNLIKELY(wide != (1u << count) - 1)) {
      for (unsigned odd = ~wide & ((1u << count) - 1); odd != 0; odd &= odd - 1) {
        const std::size_t k = n + static_cast<std::size_t>(__builtin_ctz(odd));
        const auto at = static_cast<std::size_t>(packed.point[k]);
        writeSample(task_, chunk_.begin + at, Vec2(chunk_.x[at], chunk_.y[at]));
      }
    }
  }

  std::size_t pointOf(const Packed& packed, std::size_t n) const {
    return chunk_.begin + static_cast<std::size_t>(packed.point[n]);
  }

  struct Pair {
    V x, y;
  };
  HWY_INLINE Pair turned(V x, V y) const {
    if (!task_.placed) return {x, y};
    const D d;
    const V c = hn::Set(d, task_.pose.rotation.c), s = hn::Set(d, task_.pose.rotation.s);
    return {hn::Sub(hn::Mul(c, x), hn::Mul(s, y)), hn::Add(hn::Mul(s, x), hn::Mul(c, y))};
  }

  HWY_INLINE void writeClosest(const Packed& packed, std::size_t n, std::size_t count, bool contiguous, V x, V y,
                               V distance, V normalX, V normalY, const Best& best) {
    const D d;
    // A vertex is itself: the point less the arm would round.
    alignas(64) double ax[kMostLanes], ay[kMostLanes];
    alignas(64) std::int64_t e[kMostLanes];
    hn::Store(best.edge, hn::RebindToSigned<D>(), e);
    for (std::size_t k = 0; k < hn::Lanes(d); ++k) {
      const Vec2& a = grid_.edges()[static_cast<std::size_t>(e[k])].a;
      ax[k] = a.x();
      ay[k] = a.y();
    }
    const V cx = hn::IfThenElse(best.vertex, hn::Load(d, ax), hn::Sub(x, hn::Mul(distance, normalX)));
    const V cy = hn::IfThenElse(best.vertex, hn::Load(d, ay), hn::Sub(y, hn::Mul(distance, normalY)));
    auto [wx, wy] = turned(cx, cy);
    if (task_.placed) {
      wx = hn::Add(hn::Set(d, task_.pose.position.x()), wx);
      wy = hn::Add(hn::Set(d, task_.pose.position.y()), wy);
    }
    write(packed, n, count, contiguous, wx, b_.closestX);
    write(packed, n, count, contiguous, wy, b_.closestY);
  }

  HWY_INLINE void writeFeature(const Packed& packed, std::size_t n, std::size_t count, const Best& best) {
    alignas(64) std::int64_t e[kMostLanes];
    hn::Store(best.edge, hn::RebindToSigned<D>(), e);
    const unsigned vertices = bitsOf(best.vertex);
    for (std::size_t k = 0; k < count; ++k) {
      const std::size_t i = pointOf(packed, n + k);
      if (!b_.edge.empty()) b_.edge[i] = static_cast<std::int32_t>(e[k]);
      if (!b_.feature.empty()) b_.feature[i] = (vertices >> k & 1) != 0 ? FeatureKind::StartVertex : FeatureKind::Edge;
    }
  }

  HWY_INLINE void write(const Packed& packed, std::size_t n, std::size_t count, bool contiguous, V values,
                        std::span<double> column) {
    const D d;
    if (column.empty()) return;
    if (contiguous) {
      hn::StoreU(values, d, column.data() + pointOf(packed, n));
      return;
    }
    alignas(64) double each[kMostLanes];
    hn::Store(values, d, each);
    for (std::size_t k = 0; k < count; ++k) column[pointOf(packed, n + k)] = each[k];
  }

  const BatchTask& task_;
  const EdgeGrid& grid_;
  const FieldBatch& b_;
  Chunk chunk_;
};

void batchWide(const BatchTask& task, std::size_t begin, std::size_t end) { Batch(task).run(begin, end); }

}  // namespace

BatchLoop wideBatchLoop() { return batchWide; }

}  // namespace HWY_NAMESPACE
}  // namespace froude::detail
HWY_AFTER_NAMESPACE();
#endif

#if HWY_ONCE
namespace froude::detail {

BatchLoop batchLoop(SimdTarget target) {
  switch (target) {
#if (HWY_TARGETS & HWY_AVX3)
    case SimdTarget::Avx3:
      return N_AVX3::wideBatchLoop();
#endif
#if (HWY_TARGETS & HWY_AVX2)
    case SimdTarget::Avx2:
      return N_AVX2::wideBatchLoop();
#endif
#if (HWY_TARGETS & HWY_SSE4)
    case SimdTarget::Sse4:
      return N_SSE4::wideBatchLoop();
#endif
    default:
      return batchScalar;
  }
}

}  // namespace froude::detail
#endif
