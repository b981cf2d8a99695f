// Frames as .vdb files: a grid of points and level sets, written and read back.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include <froude/fields/openvdb/level_set.h>

namespace froude::vdb {

/// Columns of particles, all of one length.
struct Points {
  std::vector<Vec2> position;             ///< [m]
  std::vector<Vec2> velocity;             ///< [m/s], kept as floats
  std::vector<float> pressure;            ///< [N/m]
  std::vector<float> density;             ///< [kg/m²]
  std::vector<float> radius;              ///< [m], the attribute `pscale`
  std::vector<std::int32_t> species, id;  ///< 0 fluid, 1 bullet; number of creation
  std::size_t size() const { return position.size(); }
  void resize(std::size_t count);
};

/// What a file holds beside its grids; kept with the file and with each of its grids as `time` [s], `frame`, `unit`.
struct FrameLabel {
  double time = 0.0;  ///< [s]
  std::int32_t frame = 0;
  std::string unit = "m";
};

/// What a frame shows.
struct FrameContents {
  FrameLabel label;
  Points points;
  double fogVoxel = 0.0;      ///< [m] of the fog volume; 0: none
  double particleArea = 0.0;  ///< [m²] that a particle of fluid fills in the fog
  std::map<std::string, const LevelSet*> levelSets;
};

/// Writes a file with
///   - the grid of points `particles` (openvdb::points) in the plane z = 0, with the attributes P, v, pressure,
///   density,
///     pscale, species and id. Positions are floats relative to the centre of a voxel that holds some 16 points: right
///     to 2⁻²⁵ of that voxel, wherever the domain lies. No lossy codec anywhere.
///   - the fog volume `density`: the part of each voxel that fluid fills, shared bilinearly among the four voxels
///   around a
///     particle; its integral over the plane is the fluid's area.
///   - the level sets, by their names.
/// Compressed without loss. The file is written in place: whoever wants it whole or not at all writes beside and
/// renames. Throws Error with the reason. Precondition: all columns as long as `position`. Cost: a sort of the points.
FROUDE_API void writeFrame(const std::string& file, const FrameContents& contents);

/// A file read back. Points come in the order of the file.
struct FrameRead {
  FrameLabel label;
  Points points;
  double pointVoxel = 0.0;  ///< [m], of the grid of points; 0 without one
  double fogArea = 0.0;     ///< [m²], the integral of the fog; 0 without one
  std::map<std::string, LevelSet> levelSets;
};
/// Throws Error for a file that is not one of `writeFrame`.
FROUDE_API FrameRead readFrame(const std::string& file);

}  // namespace froude::vdb
