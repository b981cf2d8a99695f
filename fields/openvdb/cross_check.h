// A polygon's distance field against OpenVDB's level set of it, at several voxel sizes.
#pragma once

#include <vector>

#include <froude/base/api.h>
#include <froude/fields/polygon.h>

namespace froude::vdb {

struct CrossCheckOptions {
  std::vector<int> divisions{64, 128, 256};  ///< voxels along the longer side of the polygon's box, rising
  double halfBand = 3.0;                     ///< [voxels] points are taken so near to the boundary, on both sides
  std::size_t points = 20000;                ///< for each voxel size
};

/// Largest and root mean square of an error over `count` points; zero where there is none.
struct ErrorNorm {
  std::size_t count = 0;
  double max = 0.0, rms = 0.0;
};

/// One voxel size. "Clear" points are those where the same edge's interior stays closest all over a disc of two voxels:
/// every node that the interpolant looks at then lies on one side of one straight line, where a trilinear interpolant
/// of exact values is exact. Elsewhere (near corners, and between edges that are equally close) it rounds a kink off.
struct CrossCheckRow {
  double voxelSize = 0.0;      ///< [m]
  ErrorNorm distance;          ///< [voxels] at all points
  ErrorNorm clearDistance;     ///< [voxels] at clear points
  ErrorNorm clearNormal;       ///< angle between the normals [rad] at clear points
  std::size_t wrongSides = 0;  ///< points where the two differ in sign
  double deepestWrong = 0.0;   ///< [voxels] largest true distance among them
  double rounding = 0.0;       ///< [voxels] what single precision alone can do
  std::size_t activeVoxels = 0;
  std::size_t memoryBytes = 0;  ///< of the level set
};

/// Slopes are those of log(error in metres) over log(voxel size), least squares: 1 is an error in proportion to the
/// voxel.
struct FROUDE_API CrossCheck {
  std::vector<CrossCheckRow> rows;
  double slopeMax = 0.0;  ///< of the largest error over all points; NaN with fewer than two sizes
  double slopeRms = 0.0;  ///< of the root mean square
  /// True if at all clear points of all sizes the two agree to rounding.
  bool clearAgrees() const;
  /// Largest error over all points and sizes [voxels].
  double worst() const;
};

/// No exact value is farther off than this at any point [voxels]: the interpolant is a weighted mean of the values at
/// the corners of a square, distance changes by no more than the way, and the weighted mean of the ways is largest in
/// the square's middle, √2/2.
inline constexpr double kLipschitzBound = 0.70710678118654752;

/// Builds both and asks both at the same points: along the edges in proportion to their lengths and around the
/// vertices, within the half band, from counter-based random numbers, so that every call gives the same. The true value
/// is DistanceField's. What cannot agree is counted, not hidden: features thinner than about a voxel are lost by
/// OpenVDB and turn up in `wrongSides`. Throws Error for no division, one below 8, or a half band out of 1 … 50. Cost:
/// that of the largest LevelSet, 0.1 s to 1 s with 256 voxels.
FROUDE_API CrossCheck crossCheck(const Polygon& polygon, const CrossCheckOptions& options = {});

}  // namespace froude::vdb
