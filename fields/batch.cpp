#include <froude/fields/batch.h>

#include <froude/base/parallel.h>
#include <froude/fields/batch_loop.h>
#include <froude/fields/distance_field.h>
#include <froude/fields/world_field.h>

namespace froude {
namespace detail {

void writeSample(const BatchTask& task, std::size_t i, const Vec2& local) {
  const FieldBatch& b = *task.batch;
  const FieldSample s = task.grid->sample(local);
  const auto turned = [&](const Vec2& v) { return task.placed ? task.pose.rotation.apply(v) : v; };
  if (!b.distance.empty()) b.distance[i] = s.distance;
  if (!b.normalX.empty()) {
    const Vec2 normal = turned(s.normal);
    b.normalX[i] = normal.x();
    b.normalY[i] = normal.y();
  }
  if (!b.closestX.empty()) {
    // A bound's closest point is the point itself, which the way to the grid and back would round.
    const Vec2 closest = !s.exact ? Vec2(b.x[i], b.y[i]) : (task.placed ? task.pose.toWorld(s.closest) : s.closest);
    b.closestX[i] = closest.x();
    b.closestY[i] = closest.y();
  }
  if (!b.edge.empty()) b.edge[i] = s.edge;
  if (!b.feature.empty()) b.feature[i] = s.feature;
}

void batchScalar(const BatchTask& task, std::size_t begin, std::size_t end) {
  for (std::size_t i = begin; i < end; ++i) {
    const Vec2 point(task.batch->x[i], task.batch->y[i]);
    writeSample(task, i, task.placed ? task.pose.toLocal(point) : point);
  }
}

}  // namespace detail

namespace {

/// Points a task works on.
constexpr std::size_t kBatchBlock = 4096;

template <typename T>
bool fits(std::span<T> column, std::size_t count) {
  return column.empty() || column.size() == count;
}

}  // namespace

void detail::checkColumns(const FieldBatch& b) {
  const std::size_t count = b.x.size();
  if (b.y.size() != count || !fits(b.distance, count) || !fits(b.normalX, count) || !fits(b.closestX, count) ||
      !fits(b.edge, count) || !fits(b.feature, count)) {
    throw Error("a column of a batch has another length than its points");
  }
  if (b.normalX.size() != b.normalY.size() || b.closestX.size() != b.closestY.size()) {
    throw Error("a batch wants x and y of normals and closest points, or neither");
  }
}

namespace {

void run(const detail::EdgeGrid& grid, const Transform& pose, const FieldBatch& b, SimdTarget target) {
  detail::checkColumns(b);
  const bool placed = pose.position != Vec2(0.0, 0.0) || pose.rotation.c != 1.0 || pose.rotation.s != 0.0;
  const detail::BatchTask task{&grid, &b, pose, placed};
  const detail::BatchLoop loop = detail::batchLoop(target);
  parallelFor(b.x.size(), kBatchBlock, [&](std::size_t begin, std::size_t end) { loop(task, begin, end); });
}

}  // namespace

void sampleBatch(const DistanceField& field, const Transform& pose, const FieldBatch& batch, SimdTarget target) {
  run(field.grid(), pose, batch, target);
}

void sampleBatch(const WorldField& field, const FieldBatch& batch, SimdTarget target) {
  run(field.grid(), Transform(), batch, target);
}

}  // namespace froude
