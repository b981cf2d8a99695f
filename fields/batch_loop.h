// The loop behind sampleBatch: a block of points against one grid. Internal.
#pragma once

#include <froude/fields/batch.h>
#include <froude/fields/edge_grid.h>

namespace froude::detail {

/// Throws Error if a column has another length than the points.
void checkColumns(const FieldBatch& batch);

/// Points [begin, end) of the batch; the pose has been judged to be the identity or not.
struct BatchTask {
  const EdgeGrid* grid;
  const FieldBatch* batch;
  Transform pose;
  bool placed;  // false: the pose is the identity
};

using BatchLoop = void (*)(const BatchTask& task, std::size_t begin, std::size_t end);

/// Point by point: the oracle of the wide loops, and what they ask where lanes do not serve.
void batchScalar(const BatchTask& task, std::size_t begin, std::size_t end);
/// The loop of a target; that of Scalar is `batchScalar`.
BatchLoop batchLoop(SimdTarget target);

/// Writes the answer to one point, given in the grid's frame.
void writeSample(const BatchTask& task, std::size_t i, const Vec2& local);

}  // namespace froude::detail
