// Questions about many particles at once: the same answers as point by point, over SIMD lanes and all threads.
#pragma once

#include <span>

#include <froude/base/api.h>
#include <froude/base/simd.h>
#include <froude/base/transform.h>
#include <froude/fields/field_sample.h>

namespace froude {

class DistanceField;
class WorldField;

/// Points and the columns their answers go to; each as long as `x`, or empty if it is not wanted. Columns must not
/// overlap. World frame; lengths [m].
struct FieldBatch {
  std::span<const double> x{}, y{};
  std::span<double> distance{};              ///< as FieldSample::distance
  std::span<double> normalX{}, normalY{};    ///< outward, unit; zero where the answer is a bound. Both or none
  std::span<double> closestX{}, closestY{};  ///< on the boundary; the point itself where it is a bound. Both or none
  std::span<std::int32_t> edge{};            ///< number of the closest edge; −1 where the answer is a bound
  std::span<FeatureKind> feature{};          ///< None where the answer is a bound
};

/// Asks `field`, placed by `pose`, for all points: each gets what `sample` says at `pose.toLocal(point)`, turned back
/// to the world, bit for bit. Points in any order; in the order of space they are faster, since neighbours share what
/// the caches hold. A point that is not finite gets what `sample` says of it. Throws Error if a column has another
/// length. No allocation. Cost: see docs/performance.md.
FROUDE_API void sampleBatch(const DistanceField& field, const Transform& pose, const FieldBatch& batch,
                            SimdTarget target = bestSimdTarget());
/// The same for a field in its own frame: the world's.
FROUDE_API void sampleBatch(const WorldField& field, const FieldBatch& batch, SimdTarget target = bestSimdTarget());

}  // namespace froude
