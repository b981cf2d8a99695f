// Frames as HDF5: segments that hold some frames each, and the index over all of them (frames.h5, frames.xdmf).
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <froude/solver/world.h>
#include "export/hdf5_memory.h"

namespace froude::exporting {

/// One frame in a closed or open segment.
struct FrameEntry {
  int index = 0, segment = 0;
  double time = 0.0;  // [s]
  std::size_t particles = 0;
  std::size_t triangles = 0, links = 0;  // of soft bodies
  int positionBytes = 4;                 // of one coordinate
  std::size_t vertices = 0;              // numbers in its closed segment's `vertices`
};

/// "frame_00012", the name of a frame's group and picture; "frames/0003.h5", a segment's file in the run's folder.
std::string frameName(int index);
std::string segmentFile(int segment);

/// Bytes of a coordinate that keep positions to a thousandth of the smallest length of the scene (spacing or bullet
/// radius): 4, or 8 where the domain lies so far from the origin that a float would not.
int positionBytes(const WorldDef& def);

/// A segment being filled. Each frame is a group with the attributes `index` and `time` [s] and
///   position [N, 2] (m), velocity [N, 2] (m/s), pressure [N] (N/m), density [N] (kg/m²),
///   species [N] (0 fluid, 1 bullet, 2 soft), id [N] (number of creation within its species, modulo 2^32),
///   bodies [B, 6] (x, y, angle in radians, vx, vy, spin), in the order of the scene;
/// with soft bodies also
///   triangles [T, 3] and links [L, 2] of ropes (numbers of particles), strain [T] and link_strain [L] (largest
///   |stretch − 1|).
/// Fluid comes first, then bullets, then the points of soft bodies, body by body. Fluid and bullets are in cell order,
/// which changes between frames; `id` stays. Bullets and soft points have pressure 0 and the density of their
/// material. Cost: 29 bytes a particle (37 with 8-byte positions) and about 8 kB a frame.
class Segment {
 public:
  explicit Segment(int number);
  void add(const World& world, int index);
  /// Takes over a frame of a closed segment as it is.
  void copy(const std::string& file, const FrameEntry& frame);
  /// With `vertices` [most particles of a frame]: 0, 1, 2 …, by which XDMF numbers the points of each frame.
  void save(const std::string& folder);
  int number() const { return number_; }
  std::size_t bytes() const { return file_.bytes(); }
  const std::vector<FrameEntry>& frames() const { return frames_; }

 private:
  int number_;
  Hdf5Memory file_;
  std::vector<FrameEntry> frames_;
};

/// Frames of a closed segment, by index. Throws OutputError for a file that is not one.
std::vector<FrameEntry> readSegment(const std::string& folder, int segment);

/// Rewrites frames.h5 (an external link for each frame) and frames.xdmf (a temporal collection of Polyvertex grids,
/// and where there are soft bodies collections of their triangles and of ropes' links; frames without particles are
/// left out, readers stumble over empty ones), each whole. Throws OutputError.
void writeIndex(const std::string& folder, const std::vector<FrameEntry>& frames);

}  // namespace froude::exporting
