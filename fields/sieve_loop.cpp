// Compiled once for each target. No fused multiply-adds, so that all targets keep the same edges.
#include <froude/fields/sieve_loop.h>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "froude/fields/sieve_loop.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace froude::detail {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using D = hn::CappedTag<double, 4>;
using V = hn::Vec<D>;

/// A number for each corner of a box, counter-clockwise from the lowest: one, two or four vectors.
struct Corners {
  alignas(32) double at[4];
};

HWY_INLINE void squaresOf(const GridEdge& e, double armX, double armY, const Corners& x, const Corners& y,
                          double* squares) {
  const D d;
  const double dx = e.direction.x(), dy = e.direction.y();
  const V dirX = hn::Set(d, dx), dirY = hn::Set(d, dy), length = hn::Set(d, e.length);
  const V along0 = hn::Set(d, dx * armX + dy * armY), left0 = hn::Set(d, dx * armY - dy * armX);
  for (std::size_t k = 0; k < 4; k += hn::Lanes(d)) {
    const V cx = hn::Load(d, x.at + k), cy = hn::Load(d, y.at + k);
    const V along = hn::Add(hn::Add(hn::Mul(cx, dirX), hn::Mul(cy, dirY)), along0);
    const V left = hn::Add(hn::Sub(hn::Mul(cy, dirX), hn::Mul(cx, dirY)), left0);
    const V past = hn::Max(hn::Max(hn::Neg(along), hn::Sub(along, length)), hn::Zero(d));
    hn::Store(hn::Add(hn::Mul(left, left), hn::Mul(past, past)), d, squares + k);
  }
}

SieveResult sieve(const SieveTask& task, double* squares, std::uint32_t* kept) {
  const D d;
  constexpr std::size_t kLanes = HWY_LANES(double) < 4 ? HWY_LANES(double) : 4;
  const Box& box = task.box;
  const double w = box.max.x() - box.min.x(), h = box.max.y() - box.min.y();
  const Corners x{{0.0, w, w, 0.0}}, y{{0.0, 0.0, h, h}};

  // The edges that win at each corner and at the centre; their places in the list are kept as numbers, one a lane.
  Corners best{{kInfinity, kInfinity, kInfinity, kInfinity}}, winners{{0.0, 0.0, 0.0, 0.0}};
  double bestCenter = kInfinity;
  std::size_t centerWinner = 0;
  for (std::size_t i = 0; i < task.count; ++i) {
    const GridEdge& e = task.edges[task.candidates[i]];
    const double armX = box.min.x() - e.a.x(), armY = box.min.y() - e.a.y();
    double* mine = squares + 4 * i;
    squaresOf(e, armX, armY, x, y, mine);
    for (std::size_t k = 0; k < 4; k += kLanes) {
      const V here = hn::Load(d, mine + k), there = hn::Load(d, best.at + k);
      const V place = hn::Set(d, static_cast<double>(i));
      hn::Store(hn::IfThenElse(hn::Lt(here, there), place, hn::Load(d, winners.at + k)), d, winners.at + k);
      hn::Store(hn::Min(here, there), d, best.at + k);
    }
    const double cx = armX + 0.5 * w, cy = armY + 0.5 * h;
    const double along = e.direction.x() * cx + e.direction.y() * cy;
    const double left = e.direction.x() * cy - e.direction.y() * cx;
    const double past = std::max(std::max(-along, along - e.length), 0.0);
    const double center = left * left + past * past;
    centerWinner = center < bestCenter ? i : centerWinner;
    bestCenter = std::min(bestCenter, center);
  }
  const double halfDiagonal = 0.5 * std::sqrt(w * w + h * h);
  if (task.count == 1) {
    kept[0] = task.candidates[0];
    const double most = std::max(std::max(best.at[0], best.at[1]), std::max(best.at[2], best.at[3]));
    const double least = task.exact ? std::sqrt(squaredDistance(task.edges[kept[0]], box, task.rounding))
                                    : std::max(0.0, std::sqrt(bestCenter) - halfDiagonal);
    return {1, least, std::sqrt(most)};
  }

  // Squared distances of the points q to the corners, and a little.
  Corners limits[5];
  const double little = task.rounding * task.rounding / kSieveSlack;
  double most = kInfinity;
  for (std::size_t c = 0; c < 5; ++c) {
    const std::size_t winner = c < 4 ? static_cast<std::size_t>(winners.at[c]) : centerWinner;
    const GridEdge& e = task.edges[task.candidates[winner]];
    const double lowX = box.min.x() - e.a.x(), lowY = box.min.y() - e.a.y();
    const double armX = lowX + (c < 4 ? x.at[c] : 0.5 * w), armY = lowY + (c < 4 ? y.at[c] : 0.5 * h);
    const double along = std::clamp(e.direction.x() * armX + e.direction.y() * armY, 0.0, e.length);
    const V qx = hn::Set(d, lowX - along * e.direction.x()), qy = hn::Set(d, lowY - along * e.direction.y());
    for (std::size_t k = 0; k < 4; k += kLanes) {
      const V px = hn::Add(hn::Load(d, x.at + k), qx), py = hn::Add(hn::Load(d, y.at + k), qy);
      const V square = hn::Add(hn::Mul(px, px), hn::Mul(py, py));
      hn::Store(hn::Add(hn::Mul(square, hn::Set(d, 1.0 + kSieveSlack)), hn::Set(d, little)), d, limits[c].at + k);
    }
    most = std::min(most,
                    std::max(std::max(limits[c].at[0], limits[c].at[1]), std::max(limits[c].at[2], limits[c].at[3])));
  }

  SieveResult result{0, 0.0, std::sqrt(most)};
  double least = kInfinity;
  for (std::size_t i = 0; i < task.count; ++i) {
    bool beaten = false;
    for (std::size_t c = 0; c < 5 && !beaten; ++c) {
      beaten = true;
      for (std::size_t k = 0; k < 4; k += kLanes) {
        beaten = beaten && hn::AllTrue(d, hn::Gt(hn::Load(d, squares + 4 * i + k), hn::Load(d, limits[c].at + k)));
      }
    }
    if (beaten) continue;
    const std::uint32_t edge = task.candidates[i];
    kept[result.kept++] = edge;
    if (task.exact) least = std::min(least, squaredDistance(task.edges[edge], box, task.rounding));
  }
  result.least = task.exact ? std::sqrt(least) : std::max(0.0, std::sqrt(bestCenter) - halfDiagonal);
  return result;
}

}  // namespace

SieveLoop wideSieveLoop() { return sieve; }

}  // namespace HWY_NAMESPACE
}  // namespace froude::detail
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace froude::detail {
namespace {

double square(double x) { return x * x; }

double squaredGap(const Box& box, const Vec2& p) {
  return square(std::max(std::max(box.min.x() - p.x(), p.x() - box.max.x()), 0.0)) +
         square(std::max(std::max(box.min.y() - p.y(), p.y() - box.max.y()), 0.0));
}

}  // namespace

/// The nearest point of a box to a segment is a corner, unless an end of the segment is as near or it passes through:
/// then neither the axes nor its own line part the two.
double squaredDistance(const GridEdge& e, const Box& box, double rounding) {
  const double gap = std::min(squaredGap(box, e.a), squaredGap(box, e.b));
  if (gap == 0.0) return 0.0;
  const double lowX = box.min.x() - e.a.x(), lowY = box.min.y() - e.a.y();
  const double highX = box.max.x() - e.a.x(), highY = box.max.y() - e.a.y();
  const double dx = e.direction.x(), dy = e.direction.y();
  const double lefts[4] = {dx * lowY - dy * lowX, dx * lowY - dy * highX, dx * highY - dy * highX,
                           dx * highY - dy * lowX};
  if (std::min(std::min(lefts[0], lefts[1]), std::min(lefts[2], lefts[3])) <= rounding &&
      std::max(std::max(lefts[0], lefts[1]), std::max(lefts[2], lefts[3])) >= -rounding &&
      std::min(e.a.x(), e.b.x()) <= box.max.x() && std::max(e.a.x(), e.b.x()) >= box.min.x() &&
      std::min(e.a.y(), e.b.y()) <= box.max.y() && std::max(e.a.y(), e.b.y()) >= box.min.y()) {
    return 0.0;
  }
  const double alongs[4] = {dx * lowX + dy * lowY, dx * highX + dy * lowY, dx * highX + dy * highY,
                            dx * lowX + dy * highY};
  double least = gap;
  for (std::size_t k = 0; k < 4; ++k) {
    least = std::min(least, square(lefts[k]) + square(std::max(std::max(-alongs[k], alongs[k] - e.length), 0.0)));
  }
  return least;
}

SieveLoop sieveLoop(SimdTarget target) {
  switch (target) {
#if (HWY_TARGETS & HWY_AVX3)
    case SimdTarget::Avx3:
      return N_AVX3::wideSieveLoop();
#endif
#if (HWY_TARGETS & HWY_AVX2)
    case SimdTarget::Avx2:
      return N_AVX2::wideSieveLoop();
#endif
#if (HWY_TARGETS & HWY_SSE4)
    case SimdTarget::Sse4:
      return N_SSE4::wideSieveLoop();
#endif
    default:
      return HWY_STATIC_DISPATCH(wideSieveLoop)();
  }
}

}  // namespace froude::detail
#endif
