// The flight over SIMD lanes, compiled once for each target. The formulas are those of flight_scalar.cpp, without fused
// multiply-adds, so that all targets agree to the bit.
#include <froude/solver/bullet/flight.h>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "froude/solver/bullet/flight_wide.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace froude {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using D = hn::ScalableTag<double>;
using I = hn::Rebind<std::int32_t, D>;
using V = hn::Vec<D>;

struct Lookup {
  V originX, originY, cell, inverse, quantum, nx, ny;
  const std::uint8_t* cells;

  explicit HWY_INLINE Lookup(const FreeMap::View& map)
      : originX(hn::Set(D(), map.originX)),
        originY(hn::Set(D(), map.originY)),
        cell(hn::Set(D(), map.cell)),
        inverse(hn::Set(D(), map.inverse)),
        quantum(hn::Set(D(), map.quantum)),
        nx(hn::Set(D(), static_cast<double>(map.nx))),
        ny(hn::Set(D(), static_cast<double>(map.ny))),
        cells(map.cells) {}

  HWY_INLINE V freeTravel(V x, V y) const {
    const D d;
    const I n;
    const V zero = hn::Zero(d), half = hn::Set(d, 0.5);
    const V cx = hn::Mul(hn::Sub(x, originX), inverse), cy = hn::Mul(hn::Sub(y, originY), inverse);
    const auto in = hn::And(hn::And(hn::Ge(cx, zero), hn::Ge(cy, zero)), hn::And(hn::Lt(cx, nx), hn::Lt(cy, ny)));
    // Whole numbers below 2³¹ as doubles are exact, and so is the number of the cell.
    const V ix = hn::Floor(cx), iy = hn::Floor(cy);
    const V number = hn::IfThenElseZero(in, hn::Add(hn::Mul(iy, nx), ix));
    const auto bytes = hn::GatherOffset(n, reinterpret_cast<const std::int32_t*>(cells), hn::DemoteTo(n, number));
    const V steps = hn::PromoteTo(d, hn::And(bytes, hn::Set(n, 255)));
    const V offX = hn::Sub(cx, hn::Add(ix, half)), offY = hn::Sub(cy, hn::Add(iy, half));
    const V off = hn::Sqrt(hn::Add(hn::Mul(offX, offX), hn::Mul(offY, offY)));
    return hn::IfThenElseZero(in, hn::Sub(hn::Mul(quantum, steps), hn::Mul(cell, off)));
  }
};

FlightResult fly(const Flight& f, std::size_t begin, std::size_t end, std::uint32_t* near) {
  const D d;
  const std::size_t lanes = hn::Lanes(d);
  const Lookup map(f.map);
  const V dt = hn::Set(d, f.dt), kickX = hn::Set(d, f.halfKick.x()), kickY = hn::Set(d, f.halfKick.y());
  const V minX = hn::Set(d, f.domain.min.x()), minY = hn::Set(d, f.domain.min.y());
  const V maxX = hn::Set(d, f.domain.max.x()), maxY = hn::Set(d, f.domain.max.y());
  auto left = hn::FirstN(d, 0);
  std::size_t nearCount = 0;
  for (std::size_t i = begin; i < end; i += lanes) {
    const V x = hn::LoadU(d, f.x + i), y = hn::LoadU(d, f.y + i);
    const V oldVx = hn::LoadU(d, f.vx + i), oldVy = hn::LoadU(d, f.vy + i);
    const V wx = hn::Add(oldVx, kickX), wy = hn::Add(oldVy, kickY);
    const V travelX = hn::Mul(dt, wx), travelY = hn::Mul(dt, wy);
    const V length = hn::Sqrt(hn::Add(hn::Mul(travelX, travelX), hn::Mul(travelY, travelY)));
    const auto ours = hn::FirstN(d, end - i);
    V done = map.freeTravel(x, y);
    auto free = hn::Gt(done, length);
    auto open = hn::AndNot(free, hn::And(ours, hn::And(hn::Le(done, length), hn::Gt(done, hn::Zero(d)))));
    if (!hn::AllFalse(d, open)) {
      const V alongX = hn::Div(travelX, length), alongY = hn::Div(travelY, length);
      for (int k = 1; k < kFlightSteps && !hn::AllFalse(d, open); ++k) {
        const V step = map.freeTravel(hn::Add(x, hn::Mul(done, alongX)), hn::Add(y, hn::Mul(done, alongY)));
        done = hn::IfThenElse(open, hn::Add(done, step), done);
        free = hn::Or(free, hn::And(open, hn::Gt(done, length)));
        open = hn::AndNot(free, hn::And(open, hn::Gt(step, hn::Zero(d))));
      }
    }
    free = hn::And(free, ours);
    const V newX = hn::Add(x, travelX), newY = hn::Add(y, travelY);
    hn::StoreU(hn::IfThenElse(free, newX, x), d, f.x + i);
    hn::StoreU(hn::IfThenElse(free, newY, y), d, f.y + i);
    hn::StoreU(hn::IfThenElse(free, hn::Add(wx, kickX), oldVx), d, f.vx + i);
    hn::StoreU(hn::IfThenElse(free, hn::Add(wy, kickY), oldVy), d, f.vy + i);
    const auto outX = hn::Or(hn::Lt(newX, minX), hn::Ge(newX, maxX));
    const auto outY = hn::Or(hn::Lt(newY, minY), hn::Ge(newY, maxY));
    left = hn::Or(left, hn::And(free, hn::Or(outX, outY)));
    std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(d, hn::AndNot(free, ours), bytes);
    for (unsigned bits = bytes[0]; bits != 0; bits &= bits - 1) {
      near[nearCount++] = static_cast<std::uint32_t>(i) + static_cast<std::uint32_t>(__builtin_ctz(bits));
    }
  }
  return {nearCount, !hn::AllFalse(d, left)};
}

}  // namespace

FlyLoop wideFlyLoop() { return fly; }

}  // namespace HWY_NAMESPACE
}  // namespace froude
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace froude {

FlyLoop flyLoop(SimdTarget target) {
  switch (target) {
#if (HWY_TARGETS & HWY_AVX3)
    case SimdTarget::Avx3:
      return N_AVX3::wideFlyLoop();
#endif
#if (HWY_TARGETS & HWY_AVX2)
    case SimdTarget::Avx2:
      return N_AVX2::wideFlyLoop();
#endif
#if (HWY_TARGETS & HWY_SSE4)
    case SimdTarget::Sse4:
      return N_SSE4::wideFlyLoop();
#endif
    default:
      return flyScalar;
  }
}

}  // namespace froude
#endif
