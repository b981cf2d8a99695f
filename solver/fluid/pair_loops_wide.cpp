// The pair loops over SIMD lanes, compiled once for each target. The formulas are those of pair_loops_scalar.cpp.

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "froude/solver/fluid/pair_loops_wide.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep
#include <hwy/highway.h>

#include <froude/solver/fluid/pair_sweep-inl.h>

#if HWY_TARGET != HWY_SCALAR  // scalar is pair_loops_scalar.cpp
HWY_BEFORE_NAMESPACE();
namespace froude {
namespace HWY_NAMESPACE {
namespace {

// The change of κ for a gain of density, whose share of the excess goes to `excess`.
HWY_INLINE void changePressure(const PressureUpdate& update, std::uint32_t i, std::uint32_t count, VF gain, VF diagonal,
                               VF& excess) {
  const F f;
  const VF least = update.least != nullptr ? loadSome(update.least + i, count) : hn::Zero(f);
  VF step = hn::Div(hn::Mul(hn::Set(f, update.relaxation), gain), hn::Max(diagonal, hn::Set(f, kSmallestDiagonal)));
  if (update.momentum > 0.0f) {
    step = hn::MulAdd(hn::Set(f, update.momentum), loadSome(update.change + i, count), step);
  }
  storeSome(hn::Max(hn::Sub(least, loadSome(update.kappa + i, count)), step), update.change + i, count);
  const VF lack = hn::IfThenElseZero(hn::Lt(least, hn::Zero(f)), hn::Neg(gain));
  excess = hn::Add(excess, hn::IfThenElseZero(hn::FirstN(f, count), hn::Max(gain, lack)));
}

HWY_INLINE void updatePressure(const PressureUpdate& update, std::uint32_t i, std::uint32_t count, VF density,
                               VF diagonal, VF& excess) {
  const F f;
  VF target = loadSome(update.target + i, count);
  const auto fresh = hn::Eq(target, hn::Zero(f));
  if (HWY_UNLIKELY(!hn::AllFalse(f, fresh))) {
    target = hn::IfThenElse(fresh, hn::Max(density, hn::Set(f, 1.0f)), target);
    storeSome(target, update.target + i, count);
  }
  changePressure(update, i, count, hn::Sub(density, target), diagonal, excess);
}

struct Wall {
  VF lambda, x, y;
};

HWY_INLINE Wall wallOf(const DensityLoop& loop, std::uint32_t i, std::uint32_t count) {
  const VF gx = loadSome(loop.wallX + i, count), gy = loadSome(loop.wallY + i, count);
  const VF shifted = hn::MulAdd(gx, loadSome(loop.shiftX + i, count), hn::Mul(gy, loadSome(loop.shiftY + i, count)));
  return {hn::Add(loadSome(loop.lambda + i, count), shifted), gx, gy};
}

double densityOnly(const PairFrame& frame, const DensityLoop& loop, std::size_t begin, std::size_t end) {
  const F f;
  VF excess = hn::Zero(f);
  sweepCells<1, 0>(
      frame, begin, end, nullptr,
      [&](VF m, VF, VF, const VF*, const VF*, VF* sums) FROUDE_INLINE {
        const VF m2 = hn::Mul(m, m), m4 = hn::Mul(m2, m2);
        sums[0] = hn::MulAdd(m4, hn::MulAdd(hn::Mul(m4, m2), hn::Set(f, kTail), hn::Set(f, 1.0f)), sums[0]);
      },
      [&](std::uint32_t i, std::uint32_t count, const VF* sums) FROUDE_INLINE {
        VF density = hn::Mul(hn::Set(f, kNorm), sums[0]);
        if (loop.lambda != nullptr) density = hn::Add(density, wallOf(loop, i, count).lambda);
        storeSome(density, loop.density + i, count);
        if (loop.update.target == nullptr) return;
        updatePressure(loop.update, i, count, density, loadSome(loop.update.diagonal + i, count), excess);
      });
  return static_cast<double>(hn::GetLane(hn::SumOfLanes(f, excess)));
}

// To sums: W, ∇W = (px, py) and |∇W|², without their factors.
template <typename Kernel>
HWY_INLINE void addNeighbour(VF m, VF dx, VF dy, VF& px, VF& py, VF* sums) {
  sums[0] = hn::Add(sums[0], Kernel::shape(m));
  const VF slope = Kernel::slope(m);
  px = hn::Mul(slope, dx);
  py = hn::Mul(slope, dy);
  sums[1] = hn::Add(sums[1], px);
  sums[2] = hn::Add(sums[2], py);
  sums[3] = hn::MulAdd(px, px, hn::MulAdd(py, py, sums[3]));
}

double densityAndDiagonal(const PairFrame& frame, const DensityLoop& loop, std::size_t begin, std::size_t end) {
  const F f;
  VF excess = hn::Zero(f);
  sweepCells<4, 0>(
      frame, begin, end, nullptr,
      [&](VF m, VF dx, VF dy, const VF*, const VF*, VF* sums) FROUDE_INLINE {
        VF px, py;
        addNeighbour<Blend>(m, dx, dy, px, py, sums);
      },
      [&](std::uint32_t i, std::uint32_t count, const VF* sums) FROUDE_INLINE {
        VF density = hn::Mul(hn::Set(f, kNorm), sums[0]);
        Wall wall{hn::Zero(f), hn::Zero(f), hn::Zero(f)};
        if (loop.lambda != nullptr) wall = wallOf(loop, i, count);
        density = hn::Add(density, wall.lambda);
        storeSome(density, loop.density + i, count);
        const VF scale = hn::Set(f, -4.0f * kNorm), two = hn::Set(f, 2.0f);
        const VF px = hn::Mul(scale, sums[1]), py = hn::Mul(scale, sums[2]);
        const VF skewX = hn::Add(px, wall.x), skewY = hn::Add(py, wall.y);
        VF diagonal = hn::Mul(hn::Mul(scale, scale), sums[3]);
        diagonal = hn::MulAdd(skewX, hn::MulAdd(two, wall.x, px), diagonal);
        diagonal = hn::MulAdd(skewY, hn::MulAdd(two, wall.y, py), diagonal);
        storeSome(diagonal, loop.diagonal + i, count);
        if (loop.update.target != nullptr) updatePressure(loop.update, i, count, density, diagonal, excess);
      });
  return static_cast<double>(hn::GetLane(hn::SumOfLanes(f, excess)));
}

double density(const PairFrame& frame, const DensityLoop& loop, std::size_t begin, std::size_t end) {
  return loop.diagonal != nullptr ? densityAndDiagonal(frame, loop, begin, end) : densityOnly(frame, loop, begin, end);
}

double divergence(const PairFrame& frame, const DivergenceLoop& loop, std::size_t begin, std::size_t end) {
  const F f;
  VF excess = hn::Zero(f);
  const Matrices<const float>& b = loop.correction;
  const float* const values[5] = {loop.ux, loop.uy, b.xx, b.xy, b.yy};
  sweepCells<1, 2, 3>(
      frame, begin, end, values,
      [&](VF m, VF dx, VF dy, const VF* own, const VF* other, VF* sums) FROUDE_INLINE {
        const VF px = hn::MulAdd(own[2], dx, hn::Mul(own[3], dy)), py = hn::MulAdd(own[3], dx, hn::Mul(own[4], dy));
        const VF away = hn::MulAdd(hn::Sub(own[0], other[0]), px, hn::Mul(hn::Sub(own[1], other[1]), py));
        sums[0] = hn::MulAdd(slopeOf(hn::Mul(m, hn::Mul(m, m))), away, sums[0]);
      },
      [&](std::uint32_t i, std::uint32_t count, const VF* sums) FROUDE_INLINE {
        VF gain = hn::Mul(hn::Set(f, -4.0f * kNorm), sums[0]);
        if (loop.wallX != nullptr) {
          gain = hn::MulAdd(loadSome(loop.wallX + i, count), loadSome(loop.ux + i, count), gain);
          gain = hn::MulAdd(loadSome(loop.wallY + i, count), loadSome(loop.uy + i, count), gain);
          gain = hn::Add(gain, loadSome(loop.wallGain + i, count));
        }
        gain = hn::Sub(gain, loadSome(loop.update.target + i, count));
        changePressure(loop.update, i, count, gain, loadSome(loop.update.diagonal + i, count), excess);
      });
  return static_cast<double>(hn::GetLane(hn::SumOfLanes(f, excess)));
}

template <typename Kernel>
void momentsOf(const PairFrame& frame, const MomentLoop& loop, std::size_t begin, std::size_t end) {
  const F f;
  sweepNear<By::RowsAndItself, 7, 0>(
      frame, begin, end, nullptr,
      [&](VF m, VF dx, VF dy, const VF*, const VF*, VF* sums) FROUDE_INLINE {
        VF px, py;
        addNeighbour<Kernel>(m, dx, dy, px, py, sums);
        sums[4] = hn::MulAdd(px, dx, sums[4]);
        sums[5] = hn::MulAdd(px, dy, sums[5]);
        sums[6] = hn::MulAdd(py, dy, sums[6]);
      },
      [&](std::uint32_t i, std::uint32_t count, const VF* sums) FROUDE_INLINE {
        VF density = hn::Mul(hn::Set(f, Kernel::kShape), sums[0]);
        if (loop.lambda != nullptr) density = hn::Add(density, loadSome(loop.lambda + i, count));
        storeSome(density, loop.density + i, count);
        const VF scale = hn::Set(f, -2.0f * Kernel::kSlope), second = hn::Set(f, 4.0f * Kernel::kSlope);
        storeSome(hn::Mul(scale, sums[1]), loop.skewX + i, count);
        storeSome(hn::Mul(scale, sums[2]), loop.skewY + i, count);
        storeSome(hn::Mul(hn::Mul(scale, scale), sums[3]), loop.squares + i, count);
        storeSome(hn::Mul(second, sums[4]), loop.moment.xx + i, count);
        storeSome(hn::Mul(second, sums[5]), loop.moment.xy + i, count);
        storeSome(hn::Mul(second, sums[6]), loop.moment.yy + i, count);
      },
      NoFold(), hn::IfThenElseZero(hn::FirstN(f, 1), Kernel::shape(hn::Set(f, 1.0f))));
}

void moments(const PairFrame& frame, const MomentLoop& loop, std::size_t begin, std::size_t end) {
  frame.kernel == kernel::Kind::Blend ? momentsOf<Blend>(frame, loop, begin, end)
                                      : momentsOf<WendlandC2>(frame, loop, begin, end);
}

// Adds what a wall does to a move, and the pressure to those before it.
template <typename Loop>
HWY_INLINE void takeMove(const Loop& loop, std::uint32_t i, std::uint32_t count, VF& moveX, VF& moveY) {
  const VF own = loadSome(loop.pressure + i, count);
  if (loop.wallX != nullptr) {
    const VF gx = loadSome(loop.wallX + i, count), gy = loadSome(loop.wallY + i, count);
    const VF tangent = loadSome(loop.tangent + i, count);
    const VF along = hn::Mul(tangent, hn::Sub(hn::Mul(gx, moveY), hn::Mul(gy, moveX)));
    const VF twice = hn::Add(own, own);
    moveX = hn::Sub(moveX, hn::MulAdd(twice, gx, hn::Mul(along, gy)));
    moveY = hn::Sub(moveY, hn::Sub(hn::Mul(twice, gy), hn::Mul(along, gx)));
  }
  if (loop.kappa != nullptr) storeSome(hn::Add(loadSome(loop.kappa + i, count), own), loop.kappa + i, count);
}

void push(const PairFrame& frame, const PushLoop& loop, std::size_t begin, std::size_t end) {
  const F f;
  const float* const values[3] = {loop.scaled.xx, loop.scaled.xy, loop.scaled.yy};
  sweepCells<2, 3>(
      frame, begin, end, values,
      [&](VF m, VF dx, VF dy, const VF*, const VF* other, VF* sums) FROUDE_INLINE {
        const VF slope = slopeOf(hn::Mul(m, hn::Mul(m, m)));
        const VF px = hn::Mul(slope, dx), py = hn::Mul(slope, dy);
        sums[0] = hn::MulAdd(other[0], px, hn::MulAdd(other[1], py, sums[0]));
        sums[1] = hn::MulAdd(other[1], px, hn::MulAdd(other[2], py, sums[1]));
      },
      [&](std::uint32_t i, std::uint32_t count, const VF* sums) FROUDE_INLINE {
        const VF qx = loadSome(loop.skewX + i, count), qy = loadSome(loop.skewY + i, count);
        const VF xx = loadSome(loop.scaled.xx + i, count), xy = loadSome(loop.scaled.xy + i, count);
        const VF yy = loadSome(loop.scaled.yy + i, count), scale = hn::Set(f, 4.0f * kNorm);
        VF moveX = hn::NegMulAdd(xx, qx, hn::NegMulAdd(xy, qy, hn::Mul(scale, sums[0])));
        VF moveY = hn::NegMulAdd(xy, qx, hn::NegMulAdd(yy, qy, hn::Mul(scale, sums[1])));
        takeMove(loop, i, count, moveX, moveY);
        storeSome(hn::Add(loadSome(loop.shiftX + i, count), moveX), loop.shiftX + i, count);
        storeSome(hn::Add(loadSome(loop.shiftY + i, count), moveY), loop.shiftY + i, count);
        storeSome(hn::Add(loadSome(loop.totalX + i, count), moveX), loop.totalX + i, count);
        storeSome(hn::Add(loadSome(loop.totalY + i, count), moveY), loop.totalY + i, count);
      });
}

void displace(const PairFrame& frame, const DisplacementLoop& loop, std::size_t begin, std::size_t end) {
  const F f;
  sweepCells<2, 1>(
      frame, begin, end, &loop.pressure,
      [&](VF m, VF dx, VF dy, const VF* own, const VF* other, VF* sums) FROUDE_INLINE {
        const VF both = hn::Add(own[0], other[0]);
        const VF weight = hn::Mul(both, slopeOf(hn::Mul(m, hn::Mul(m, m))));
        sums[0] = hn::MulAdd(weight, dx, sums[0]);
        sums[1] = hn::MulAdd(weight, dy, sums[1]);
      },
      [&](std::uint32_t i, std::uint32_t count, const VF* sums) FROUDE_INLINE {
        VF moveX = hn::Mul(hn::Set(f, 4.0f * kNorm), sums[0]), moveY = hn::Mul(hn::Set(f, 4.0f * kNorm), sums[1]);
        takeMove(loop, i, count, moveX, moveY);
        storeSome(hn::Add(loadSome(loop.shiftX + i, count), moveX), loop.shiftX + i, count);
        storeSome(hn::Add(loadSome(loop.shiftY + i, count), moveY), loop.shiftY + i, count);
        storeMoved(frame.x + i, moveX, loop.newX + i, count);
        storeMoved(frame.y + i, moveY, loop.newY + i, count);
      });
}

template <typename Kernel>
void viscosityOf(const PairFrame& frame, const ViscosityLoop& loop, std::size_t begin, std::size_t end) {
  const F f;
  const VF a = hn::Set(f, loop.a), b = hn::Set(f, loop.b * (Kernel::kSlope / Kernel::kShape));
  const float* const values[2] = {loop.vx, loop.vy};
  sweepNear<By::Rows, 2, 2>(
      frame, begin, end, values,
      [&](VF m, VF, VF, const VF* own, const VF* other, VF* sums) FROUDE_INLINE {
        const VF weight = hn::MulAdd(a, Kernel::shape(m), hn::Mul(b, Kernel::slope(m)));
        sums[0] = hn::MulAdd(weight, hn::Sub(other[0], own[0]), sums[0]);
        sums[1] = hn::MulAdd(weight, hn::Sub(other[1], own[1]), sums[1]);
      },
      [&](std::uint32_t i, std::uint32_t count, const VF* sums) FROUDE_INLINE {
        storeSome(hn::Mul(hn::Set(f, Kernel::kShape), sums[0]), loop.changeX + i, count);
        storeSome(hn::Mul(hn::Set(f, Kernel::kShape), sums[1]), loop.changeY + i, count);
      });
}

void viscosity(const PairFrame& frame, const ViscosityLoop& loop, std::size_t begin, std::size_t end) {
  frame.kernel == kernel::Kind::Blend ? viscosityOf<Blend>(frame, loop, begin, end)
                                      : viscosityOf<WendlandC2>(frame, loop, begin, end);
}

std::array<double, 2> force(const PairFrame& frame, const ForceLoop& loop, std::size_t begin, std::size_t end) {
  const F f;
  VF totalX = hn::Zero(f), totalY = hn::Zero(f);
  const float* const values[4] = {loop.scaled.xx, loop.scaled.xy, loop.scaled.yy, loop.sign};
  sweepNear<By::Rows, 2, 3, 1>(
      frame, begin, end, values,
      [&](VF m, VF dx, VF dy, const VF* own, const VF* other, VF* sums) FROUDE_INLINE {
        const VF slope = WendlandC2::slope(m);
        const VF px = hn::Mul(slope, dx), py = hn::Mul(slope, dy);
        const VF xx = hn::MulAdd(own[3], own[0], other[0]), xy = hn::MulAdd(own[3], own[1], other[1]);
        const VF yy = hn::MulAdd(own[3], own[2], other[2]);
        sums[0] = hn::MulAdd(xx, px, hn::MulAdd(xy, py, sums[0]));
        sums[1] = hn::MulAdd(xy, px, hn::MulAdd(yy, py, sums[1]));
      },
      [&](std::uint32_t i, std::uint32_t count, const VF* sums) FROUDE_INLINE {
        VF moveX = hn::Mul(hn::Set(f, 2.0f * WendlandC2::kSlope), sums[0]),
           moveY = hn::Mul(hn::Set(f, 2.0f * WendlandC2::kSlope), sums[1]);
        const auto these = hn::FirstN(f, count);
        totalX = hn::Add(totalX, hn::IfThenElseZero(these, moveX));
        totalY = hn::Add(totalY, hn::IfThenElseZero(these, moveY));
        takeMove(loop, i, count, moveX, moveY);
        storeSome(moveX, loop.shiftX + i, count);
        storeSome(moveY, loop.shiftY + i, count);
        VF ux = hn::Add(loadSome(loop.ux + i, count), moveX), uy = hn::Add(loadSome(loop.uy + i, count), moveY);
        if (loop.fallX != nullptr) {
          ux = hn::Add(ux, loadSome(loop.fallX + i, count));
          uy = hn::Add(uy, loadSome(loop.fallY + i, count));
        }
        storeSome(ux, loop.ux + i, count);
        storeSome(uy, loop.uy + i, count);
        if (loop.totalX == nullptr) return;
        storeSome(hn::Add(loadSome(loop.totalX + i, count), moveX), loop.totalX + i, count);
        storeSome(hn::Add(loadSome(loop.totalY + i, count), moveY), loop.totalY + i, count);
      });
  return {static_cast<double>(hn::GetLane(hn::SumOfLanes(f, totalX))),
          static_cast<double>(hn::GetLane(hn::SumOfLanes(f, totalY)))};
}

// Returns the excess that the pressure belongs to.
HWY_INLINE VF takeState(const StateEquation& state, const Matrices<const float>& b, float volume, std::uint32_t i,
                        std::uint32_t count, VF before, VF excess) {
  if (state.pressure == nullptr) return excess;
  const F f;
  excess = hn::Max(loadSome(state.least + i, count), excess);
  VF kappa = excess;
  if (state.tait) {
    const VF one = hn::Set(f, 1.0f), r = hn::Add(one, kappa), r3 = hn::Mul(r, hn::Mul(r, r));
    kappa = hn::Mul(hn::Set(f, 1.0f / 7.0f), hn::MulSub(hn::Mul(r3, r3), r, one));
  }
  kappa = hn::MulAdd(hn::Set(f, state.damping), hn::Sub(excess, before), kappa);
  kappa = hn::Mul(hn::Set(f, state.stiffness), hn::Add(kappa, hn::Set(f, state.background)));
  storeSome(kappa, state.pressure + i, count);
  const VF scale = hn::Mul(hn::Set(f, volume), kappa);
  storeSome(hn::Mul(scale, loadSome(b.xx + i, count)), state.scaled.xx + i, count);
  storeSome(hn::Mul(scale, loadSome(b.xy + i, count)), state.scaled.xy + i, count);
  storeSome(hn::Mul(scale, loadSome(b.yy + i, count)), state.scaled.yy + i, count);
  return excess;
}

// Where all particles of a cell have one B, (uᵢ − uⱼ)·B∇W − diffusion·slope (aᵢ + aⱼ)·∇W is (vᵢ − wⱼ)·∇W with v = Bu −
// diffusion·slope a and w = Bu + diffusion·slope a, found once a candidate and not once a pair.
struct RateFold {
  static constexpr bool kFolds = true;
  const RateLoop& loop;

  HWY_INLINE bool operator()(const CellRuns& cell, UsualCell<5>& c, std::uint32_t vectors, Owners& owners) const {
    const Matrices<const float>& b = loop.correction;
    if (!sameInCell(b.xx, cell) || !sameInCell(b.xy, cell) || !sameInCell(b.yy, cell)) return false;
    const F f;
    const VF xx = hn::Set(f, b.xx[cell.first]), xy = hn::Set(f, b.xy[cell.first]), yy = hn::Set(f, b.yy[cell.first]);
    const VF diffusion = hn::Set(f, 0.5f * loop.diffusion), slope = hn::Set(f, 0.5f * loop.diffusion * loop.slope);
    HWY_UNROLL(16)
    for (std::uint32_t v = 0; v < vectors; ++v) {
      const VF ux = c.value[0][v], uy = c.value[1][v];
      c.value[0][v] = hn::MulAdd(slope, c.value[3][v], hn::MulAdd(xx, ux, hn::Mul(xy, uy)));
      c.value[1][v] = hn::MulAdd(slope, c.value[4][v], hn::MulAdd(xy, ux, hn::Mul(yy, uy)));
      c.value[2][v] = hn::Mul(diffusion, c.value[2][v]);
    }
    for (std::uint32_t k = 0; k < cell.last - cell.first; k += kLanes) {
      const std::uint32_t i = cell.first + k;
      const VF ux = hn::LoadU(f, loop.ux + i), uy = hn::LoadU(f, loop.uy + i);
      const VF ax = hn::LoadU(f, loop.ax + i), ay = hn::LoadU(f, loop.ay + i);
      hn::Store(hn::NegMulAdd(slope, ax, hn::MulAdd(xx, ux, hn::Mul(xy, uy))), f, owners.value[0] + k);
      hn::Store(hn::NegMulAdd(slope, ay, hn::MulAdd(xy, ux, hn::Mul(yy, uy))), f, owners.value[1] + k);
      hn::Store(hn::Mul(diffusion, hn::LoadU(f, loop.excess + i)), f, owners.value[2] + k);
    }
    return true;
  }

  static HWY_INLINE void add3(VF m, VF dx, VF dy, const VF* own, const VF* other, VF* sums) {
    const VF jump = hn::Sub(own[2], other[2]);
    const VF change = hn::MulAdd(hn::Sub(own[0], other[0]), dx, hn::MulAdd(hn::Sub(own[1], other[1]), dy, jump));
    sums[0] = hn::MulAdd(WendlandC2::slope(m), change, sums[0]);
  }
};

void rate(const PairFrame& frame, const RateLoop& loop, std::size_t begin, std::size_t end) {
  const F f;
  const Matrices<const float>& b = loop.correction;
  const float* const values[8] = {loop.ux, loop.uy, loop.excess, loop.ax, loop.ay, b.xx, b.xy, b.yy};
  const VF slope = hn::Set(f, loop.slope), diffusion = hn::Set(f, 0.5f * loop.diffusion);
  sweepNear<By::Rows, 1, 5, 3>(
      frame, begin, end, values,
      [&](VF m, VF dx, VF dy, const VF* own, const VF* other, VF* sums) FROUDE_INLINE {
        const VF px = hn::MulAdd(own[5], dx, hn::Mul(own[6], dy)), py = hn::MulAdd(own[6], dx, hn::Mul(own[7], dy));
        const VF away = hn::MulAdd(hn::Sub(own[0], other[0]), px, hn::Mul(hn::Sub(own[1], other[1]), py));
        const VF along = hn::MulAdd(hn::Add(own[3], other[3]), dx, hn::Mul(hn::Add(own[4], other[4]), dy));
        const VF jump = hn::MulAdd(slope, along, hn::Sub(other[2], own[2]));
        const VF change = hn::NegMulAdd(diffusion, jump, away);
        sums[0] = hn::MulAdd(WendlandC2::slope(m), change, sums[0]);
      },
      [&](std::uint32_t i, std::uint32_t count, const VF* sums) FROUDE_INLINE {
        VF gain = hn::Mul(hn::Set(f, -2.0f * WendlandC2::kSlope * loop.volume), sums[0]);
        if (loop.wallX != nullptr) {
          VF wall = hn::Mul(loadSome(loop.wallX + i, count), loadSome(loop.ux + i, count));
          wall = hn::MulAdd(loadSome(loop.wallY + i, count), loadSome(loop.uy + i, count), wall);
          wall = hn::MulAdd(hn::Set(f, loop.wallShare), loadSome(loop.wallGain + i, count), wall);
          gain = hn::MulAdd(hn::Set(f, 2.0f), wall, gain);
        }
        const VF before = loadSome(loop.excess + i, count);
        const VF next = hn::MulAdd(loadSome(loop.share + i, count), gain, before);
        storeSome(takeState(loop.state, b, loop.volume, i, count, before, next), loop.next + i, count);
        if (loop.newX == nullptr) return;
        storeMoved(frame.x + i, loadSome(loop.ux + i, count), loop.newX + i, count);
        storeMoved(frame.y + i, loadSome(loop.uy + i, count), loop.newY + i, count);
      },
      RateFold{loop});
}

void near(const PairFrame& frame, std::uint8_t* rows, std::size_t begin, std::size_t end) {
  for (std::size_t k = begin; k < end; ++k) {
    const CellRuns& cell = frame.runs[k];
    if (cell.kind == CellRuns::Kind::Other) continue;
    UsualCell<0> c;
    loadUsual<0>(frame, cell, nullptr, c);
    if (cell.kind == CellRuns::Kind::Long) loadBeyond<0>(frame, cell, nullptr, c);
    const std::uint32_t vectors = cell.kind == CellRuns::Kind::Long ? kVectors + kPerRun : kVectors;
    for (std::uint32_t i = cell.first; i < cell.last; ++i) findNear(frame, cell, c, vectors, i, rows + kNearRow * i);
  }
}

}  // namespace

const PairLoops& widePairLoops() {
  static constexpr PairLoops kLoops{
      density, divergence, moments, push, displace, viscosity, force, rate, kNearPays ? near : nullptr};
  return kLoops;
}

}  // namespace HWY_NAMESPACE
}  // namespace froude
HWY_AFTER_NAMESPACE();
#endif

#if HWY_ONCE
namespace froude {

const PairLoops& pairLoops(SimdTarget target) {
  switch (target) {
#if (HWY_TARGETS & HWY_AVX3)
    case SimdTarget::Avx3:
      return N_AVX3::widePairLoops();
#endif
#if (HWY_TARGETS & HWY_AVX2)
    case SimdTarget::Avx2:
      return N_AVX2::widePairLoops();
#endif
#if (HWY_TARGETS & HWY_SSE4)
    case SimdTarget::Sse4:
      return N_SSE4::widePairLoops();
#endif
    default:
      return scalarPairLoops();
  }
}

}  // namespace froude
#endif
