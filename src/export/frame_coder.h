// Frames for the page of a run: quantised, coded against the frame before, compressed.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <froude/solver/world.h>
#include "scene/scene.h"

namespace froude::exporting {

/// What one byte of a particle's speed or pressure, or of a triangle's strain, stands for: 0 … 255 over a range that is
/// the same for the whole run. Values outside are clamped.
struct ByteRange {
  double low = 0.0, high = 1.0;
  std::uint8_t code(double value) const;
};
struct FrameRanges {
  ByteRange speed, pressure, strain;  // [m/s, N/m, 1]
};
/// As the pictures of the run have them, or would have them.
FrameRanges frameRanges(const scene::Scene& scene);

/// A frame as the page shows it. Particles of a species are sorted by their number of creation.
struct CoarseFrame {
  struct Particles {
    std::vector<std::uint32_t> id;           // number of creation, modulo 2^32
    std::vector<std::uint16_t> x, y;         // 0 … 65535 over the domain's box
    std::vector<std::uint8_t> speed, value;  // value: pressure; empty but for fluids
  };
  int index = 0;
  double time = 0.0;                   // [s]
  std::array<Particles, 3> species;    // fluid, bullets, soft
  std::vector<float> bodies;           // x, y [m], angle [rad] of all that move, in the order of the scene
  std::vector<std::uint32_t> corners;  // of the triangles of soft bodies, three each
  std::vector<std::uint32_t> ends;     // of the links of ropes, two each
  std::vector<std::uint8_t> strain;    // of the triangles, then of the links
  std::size_t particles() const { return species[0].id.size() + species[1].id.size() + species[2].id.size(); }
};

/// Copies the present state, unsorted. Cost: a pass over the columns, 10 bytes a particle.
CoarseFrame takeFrame(const World& world, const FrameRanges& ranges, int index);

/// Turns frames into records, one after the other. A record is a header and a payload of zlib:
///   "FRPG"  index (u32)  time (f64)  key (u32: 1 where the frame stands alone)  bytes of the payload unpacked, packed
///   (u32 each)  particles (u32)
/// All numbers are little-endian. The payload holds, for fluid, bullets and soft points in turn:
///   count, gone, new (u32 each), flags (u32: 1 predict by the last step, 2 against the particle before, 4 has values),
///   gaps between the places of those that are gone in the frame before, and between the ids of the new ones (varints),
///   then by planes the low and high bytes of the coded x and y, speeds and values;
/// then the bodies' count of numbers (u32) and their four byte planes, exclusive-or of the frame before; then triangles
/// and links (two u32) and whether they are those of the frame before (u32), else their corners and ends (varints,
/// zigzag of differences); then strains against those of the frame before.
/// A coordinate is coded as zigzag(q − prediction) modulo 2^16, the prediction being the frame before or its linear
/// continuation, optionally less the residual of the particle before in the list; whatever takes fewest bits.
class FrameCoder {
 public:
  static constexpr int kKeyEvery = 20;  // frames
  static constexpr std::size_t kHeaderBytes = 32;

  /// Sorts the frame and takes it over. Cost: a sort, three passes, and zlib at about 100 MB/s.
  std::string encode(CoarseFrame frame);

 private:
  struct Track {
    std::vector<std::uint32_t> id;
    std::vector<std::uint16_t> x, y, dx, dy;  // with the last step, modulo 2^16
    std::vector<std::uint8_t> speed, value;
  };
  void encodeSpecies(CoarseFrame::Particles& now, Track& track, std::string& out);
  void encodeBodies(const CoarseFrame& frame, std::string& out);
  void encodeSurface(const CoarseFrame& frame, std::string& out);

  int count_ = 0;
  std::array<Track, 3> tracks_;
  std::vector<std::uint32_t> bodies_;  // bits
  std::vector<std::uint32_t> corners_, ends_;
  std::vector<std::uint8_t> strain_;
};

/// Header of a record.
struct FrameRecord {
  int index = 0;
  double time = 0.0;
  bool key = false;
  std::uint32_t unpacked = 0, packed = 0, particles = 0;
};
/// False where the bytes are not the header of a record.
bool readRecord(const char* bytes, FrameRecord& record);

}  // namespace froude::exporting
