// Frames as .vdb files for Houdini, Blender and other tools of the trade; empty hands in a build without OpenVDB.
#pragma once

#include <memory>
#include <string>

#include <froude/solver/world.h>

namespace froude::exporting {

/// Whether this build has OpenVDB (CMake option FROUDE_OPENVDB).
inline constexpr bool kHasOpenVdb = FROUDE_HAS_OPENVDB != 0;
/// Version of OpenVDB, or an empty string in a build without it.
std::string openVdbVersion();

/// Writes one .vdb file a frame, whole or not at all, with the grids
///   particles  points in the plane z = 0: P, v (m/s), pressure (N/m), density (kg/m²), pscale (half the spacing, or a
///              bullet's radius; m), species (0 fluid, 1 bullet), id (number of creation within its species, modulo
///              2^31)
///   density    fog: the part of each voxel that fluid fills; voxels as large as the spacing. Where the scene has a
///   fluid obstacles  level set of all fixed polygons, extruded a few voxels to both sides of the plane bodies     the
///   same of all that move, where they are
/// and the metadata time [s], frame and unit ("m"), of the file and of each grid. Every file holds all of it, so that a
/// sequence can be opened as one. Polygons thinner than a voxel may be missing from the level sets.
class VdbFrames {
 public:
  /// The level set of the fixed polygons is made here, once. Precondition: kHasOpenVdb.
  explicit VdbFrames(const World& world);
  ~VdbFrames();
  /// Throws OutputError. Cost: a sort of the particles, and a level set of the bodies that move.
  void write(const std::string& file, const World& world, int index) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace froude::exporting
