// LevelSet: OpenVDB's narrow-band level set of polygons, read in their plane. The independent check of DistanceField.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include <froude/base/api.h>
#include <froude/fields/polygon.h>

namespace froude::vdb {

/// Version of OpenVDB at run time, for example "10.0.1".
FROUDE_API std::string version();

/// The union of polygons as OpenVDB sees it. Each polygon becomes a closed prism along z whose caps lie beyond the band
/// of the middle plane z = 0; OpenVDB alone then decides distance and side (tools::meshToVolume, exact at the nodes,
/// without its renormalisation), and values between nodes are interpolated trilinearly (tools::BoxSampler). Nothing of
/// it goes through Froude's own distance code. Immutable; may be asked from any number of threads.
class FROUDE_API LevelSet {
 public:
  /// `voxelSize` [m]; `halfBand` [voxels]: how far from the boundary, on both sides, values are distances; ≥ 1. Throws
  /// Error for a voxel size that is not positive and finite, for more than 8192 voxels along a side, for a half band
  /// out of 1 … 100, and for no polygon at all. What is thinner than about a voxel may be lost; where polygons overlap,
  /// inner walls may show as small values. Cost: (perimeter/voxelSize · halfBand² + area/voxelSize² · halfBand) voxels,
  /// 4 bytes each, three times that while it is built.
  LevelSet(const Polygon& polygon, double voxelSize, double halfBand = 3.0);
  LevelSet(std::span<const Polygon> polygons, double voxelSize, double halfBand = 3.0);
  LevelSet(LevelSet&&) noexcept;
  LevelSet& operator=(LevelSet&&) noexcept;
  ~LevelSet();

  /// Signed distance [m] at `p` [m], negative inside; ±halfBand · voxelSize beyond the band.
  double distance(const Vec2& p) const;
  /// Unit vector in which the distance grows: the interpolant's central difference over one voxel. Zero beyond the
  /// band.
  Vec2 normal(const Vec2& p) const;
  /// `distance` for many points, with one accessor kept. Precondition: as many distances [m] as points [m].
  void sample(std::span<const Vec2> points, std::span<double> distances) const;
  /// `normal` for many points. Precondition: as many normals as points.
  void normals(std::span<const Vec2> points, std::span<Vec2> normals) const;

  /// [m]
  double voxelSize() const;
  /// [m]
  double halfBand() const;
  std::size_t activeVoxels() const;
  std::size_t memoryBytes() const;

 private:
  friend struct GridFile;  // writes it to a file and reads it back
  struct Impl;
  explicit LevelSet(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace froude::vdb
