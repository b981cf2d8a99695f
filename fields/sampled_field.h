// SampledField: distances to one polygon at the nodes of a grid, interpolated between them: faster than the exact field
// where many points are asked for, and wrong by a known amount.
#pragma once

#include <vector>

#include <froude/base/api.h>
#include <froude/base/simd.h>
#include <froude/fields/batch.h>
#include <froude/fields/distance_field.h>

namespace froude {

/// What a sampled field says at a point, in the polygon's frame.
struct SampledValue {
  double distance = kInfinity;  ///< signed [m]; beyond the band, ± the band: right in sign, not above in magnitude
  Vec2 normal{0.0, 0.0};        ///< gradient of the interpolation, made unit; zero beyond the band
  bool inBand = false;
};

/// Bilinear between exact distances at the nodes of a square grid, in single precision. Straight parts of the outline
/// are met exactly; at corners and at the medial axis, where the distance has a kink, the error is a part of a cell
/// whatever the order of the interpolation (docs/decisions/fields-sampled.md). Features thinner than a cell keep their
/// distance at nodes only. Immutable.
class FROUDE_API SampledField {
 public:
  /// From an exact field, in its frame and band. `cellSize` [m]: 0 takes the exact field's. Throws Error if it is
  /// negative, not finite, or gives more than 16 million nodes. Cost: O(nodes) look-ups, and for the bound of the error
  /// some tens of them for each cell of the band.
  explicit SampledField(const DistanceField& field, double cellSize = 0.0);

  SampledValue sample(const Vec2& local) const;

  /// No point within the band of the outline has a distance that differs by more from the exact one [m]. Found by
  /// bisection of the cells: it is at most 5 % above the largest error there is.
  double errorBound() const { return errorBound_; }
  double band() const { return band_; }
  double cellSize() const { return cell_; }
  double inverseCellSize() const { return inverseCell_; }
  std::size_t memoryBytes() const { return sizeof *this + nodes_.capacity() * sizeof(float); }

  /// The table, raw: node (i, j) at origin + (i, j) · cellSize is number i + j · (nx + 1). Nodes that no point of the
  /// band needs hold ± kBeyond.
  static constexpr float kBeyond = 1e30F;
  const Vec2& origin() const { return box_.min; }
  int nx() const { return nx_; }
  int ny() const { return ny_; }
  const Box& box() const { return box_; }
  const std::vector<float>& nodes() const { return nodes_; }

 private:
  void fill(const DistanceField& field);
  void boundError(const DistanceField& field);

  Box box_;
  double band_;
  double cell_ = 0.0;
  double inverseCell_ = 0.0;
  int nx_ = 0;
  int ny_ = 0;
  double errorBound_ = 0.0;
  std::vector<float> nodes_;
};

/// As for DistanceField in batch.h; `edge` is −1 and `feature` None throughout, closest points are as good as the
/// distance.
FROUDE_API void sampleBatch(const SampledField& field, const Transform& pose, const FieldBatch& batch,
                            SimdTarget target = bestSimdTarget());

}  // namespace froude
