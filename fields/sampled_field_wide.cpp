// Batches of a SampledField over SIMD lanes, compiled once for each target; the formulas are those of
// SampledField::sample, without fused multiply-adds, so that all targets agree to the bit.
#include <froude/base/parallel.h>
#include <froude/fields/batch_loop.h>
#include <froude/fields/sampled_field.h>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "froude/fields/sampled_field_wide.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep
#include <hwy/highway.h>

#ifndef FROUDE_SAMPLED_TASK
#define FROUDE_SAMPLED_TASK
namespace froude::detail {

struct SampledTask {
  const SampledField* field;
  const FieldBatch* batch;
  Transform pose;
};
using SampledLoop = void (*)(const SampledTask& task, std::size_t begin, std::size_t end);

}  // namespace froude::detail
#endif

HWY_BEFORE_NAMESPACE();
namespace froude::detail {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using D = hn::CappedTag<double, 8>;
using F = hn::Rebind<float, D>;
using I = hn::Rebind<std::int32_t, D>;
using V = hn::Vec<D>;

/// One vector of points from i on.
HWY_INLINE void sampleVector(const SampledTask& task, std::size_t i) {
  const D d;
  const I n;
  const SampledField& f = *task.field;
  const FieldBatch& b = *task.batch;
  const V zero = hn::Zero(d);
  const V c = hn::Set(d, task.pose.rotation.c), s = hn::Set(d, task.pose.rotation.s);
  const V worldX = hn::LoadU(d, b.x.data() + i), worldY = hn::LoadU(d, b.y.data() + i);
  const V armX = hn::Sub(worldX, hn::Set(d, task.pose.position.x()));
  const V armY = hn::Sub(worldY, hn::Set(d, task.pose.position.y()));
  const V px = hn::Add(hn::Mul(c, armX), hn::Mul(s, armY)), py = hn::Sub(hn::Mul(c, armY), hn::Mul(s, armX));
  const Box& box = f.box();
  const auto in = hn::And(hn::And(hn::Ge(px, hn::Set(d, box.min.x())), hn::Le(px, hn::Set(d, box.max.x()))),
                          hn::And(hn::Ge(py, hn::Set(d, box.min.y())), hn::Le(py, hn::Set(d, box.max.y()))));
  const V inverse = hn::Set(d, f.inverseCellSize());
  const V x = hn::IfThenElseZero(in, hn::Mul(hn::Sub(px, hn::Set(d, box.min.x())), inverse));
  const V y = hn::IfThenElseZero(in, hn::Mul(hn::Sub(py, hn::Set(d, box.min.y())), inverse));
  const V column = hn::Min(hn::Floor(x), hn::Set(d, f.nx() - 1.0));
  const V row = hn::Min(hn::Floor(y), hn::Set(d, f.ny() - 1.0));
  const auto low = hn::DemoteTo(n, hn::Add(hn::Mul(row, hn::Set(d, f.nx() + 1.0)), column));
  const auto high = hn::Add(low, hn::Set(n, f.nx() + 1));
  const auto one = hn::Set(n, 1);
  const float* nodes = f.nodes().data();
  const V a = hn::PromoteTo(d, hn::GatherIndex(F(), nodes, low));
  const V bb = hn::PromoteTo(d, hn::GatherIndex(F(), nodes, hn::Add(low, one)));
  const V cc = hn::PromoteTo(d, hn::GatherIndex(F(), nodes, high));
  const V dd = hn::PromoteTo(d, hn::GatherIndex(F(), nodes, hn::Add(high, one)));
  const V fx = hn::Sub(x, column), fy = hn::Sub(y, row);
  const V right = hn::Sub(bb, a), rightHigh = hn::Sub(dd, cc);
  const V bottom = hn::Add(a, hn::Mul(fx, right)), top = hn::Add(cc, hn::Mul(fx, rightHigh));
  const V up = hn::Sub(top, bottom);
  const V band = hn::Set(d, f.band());
  const V between = hn::Add(bottom, hn::Mul(fy, up));
  const auto known = hn::And(in, hn::Le(hn::Abs(between), band));
  const V distance = hn::IfThenElse(known, between, hn::IfThenElse(in, hn::CopySign(band, between), band));
  if (!b.distance.empty()) hn::StoreU(distance, d, b.distance.data() + i);
  if (!b.normalX.empty() || !b.closestX.empty()) {
    const V gx = hn::Add(right, hn::Mul(fy, hn::Sub(rightHigh, right)));
    const V length = hn::Sqrt(hn::Add(hn::Mul(gx, gx), hn::Mul(up, up)));
    const V scale = hn::IfThenElseZero(hn::And(known, hn::Gt(length, zero)), hn::Div(hn::Set(d, 1.0), length));
    const V nx = hn::Mul(gx, scale), ny = hn::Mul(up, scale);
    const V normalX = hn::Sub(hn::Mul(c, nx), hn::Mul(s, ny)), normalY = hn::Add(hn::Mul(s, nx), hn::Mul(c, ny));
    if (!b.normalX.empty()) {
      hn::StoreU(normalX, d, b.normalX.data() + i);
      hn::StoreU(normalY, d, b.normalY.data() + i);
    }
    if (!b.closestX.empty()) {
      hn::StoreU(hn::Sub(worldX, hn::Mul(distance, normalX)), d, b.closestX.data() + i);
      hn::StoreU(hn::Sub(worldY, hn::Mul(distance, normalY)), d, b.closestY.data() + i);
    }
  }
}

void sampleRange(const SampledTask& task, std::size_t begin, std::size_t end) {
  const std::size_t lanes = hn::Lanes(D());
  const std::size_t whole = begin + (end - begin) / lanes * lanes;
  for (std::size_t i = begin; i < whole; i += lanes) sampleVector(task, i);
  if (whole == end) return;
  // What is left of the columns goes through a vector of its own.
  const std::size_t rest = end - whole;
  const FieldBatch& b = *task.batch;
  alignas(64) double columns[7][8] = {};
  std::copy_n(b.x.data() + whole, rest, columns[0]);
  std::copy_n(b.y.data() + whole, rest, columns[1]);
  FieldBatch tail{{columns[0], lanes}, {columns[1], lanes}};
  const auto into = [&](std::size_t k, std::span<double> column) {
    return column.empty() ? std::span<double>() : std::span<double>(columns[k], lanes);
  };
  tail.distance = into(2, b.distance);
  tail.normalX = into(3, b.normalX);
  tail.normalY = into(4, b.normalY);
  tail.closestX = into(5, b.closestX);
  tail.closestY = into(6, b.closestY);
  sampleVector({task.field, &tail, task.pose}, 0);
  const auto back = [&](std::span<double> from, std::span<double> to) {
    if (!to.empty()) std::copy_n(from.data(), rest, to.data() + whole);
  };
  back(tail.distance, b.distance);
  back(tail.normalX, b.normalX);
  back(tail.normalY, b.normalY);
  back(tail.closestX, b.closestX);
  back(tail.closestY, b.closestY);
}

}  // namespace

SampledLoop wideSampledLoop() { return sampleRange; }

}  // namespace HWY_NAMESPACE
}  // namespace froude::detail
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace froude {
namespace {

constexpr std::size_t kSampledBlock = 4096;

detail::SampledLoop loopOf(SimdTarget target) {
  switch (target) {
#if (HWY_TARGETS & HWY_AVX3)
    case SimdTarget::Avx3:
      return detail::N_AVX3::wideSampledLoop();
#endif
#if (HWY_TARGETS & HWY_AVX2)
    case SimdTarget::Avx2:
      return detail::N_AVX2::wideSampledLoop();
#endif
#if (HWY_TARGETS & HWY_SSE4)
    case SimdTarget::Sse4:
      return detail::N_SSE4::wideSampledLoop();
#endif
    default:
      return detail::HWY_STATIC_DISPATCH(wideSampledLoop)();
  }
}

}  // namespace

void sampleBatch(const SampledField& field, const Transform& pose, const FieldBatch& batch, SimdTarget target) {
  detail::checkColumns(batch);
  const detail::SampledTask task{&field, &batch, pose};
  const detail::SampledLoop loop = loopOf(target);
  parallelFor(batch.x.size(), kSampledBlock, [&](std::size_t begin, std::size_t end) { loop(task, begin, end); });
  std::fill(batch.edge.begin(), batch.edge.end(), -1);
  std::fill(batch.feature.begin(), batch.feature.end(), FeatureKind::None);
}

}  // namespace froude
#endif
