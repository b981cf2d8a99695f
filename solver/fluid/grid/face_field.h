// Velocities on the faces of the fluid's tiles: what particles give, what the step makes of it, what particles take.
#pragma once

#include <array>
#include <vector>

#include <froude/base/aligned.h>
#include <froude/solver/fluid/grid/front_loops.h>
#include <froude/solver/fluid/grid/particle_tiles.h>
#include <froude/solver/fluid/grid/transfer.h>

namespace froude {

/// One component of the velocity, a value at each face [m/s].
struct FaceComponent {
  AlignedArray<float> weight;  // of particles; 1 is a quarter of a full cell's at four a cell
  AlignedArray<float> value;
  AlignedArray<float> change;  // by pressure, where `solved`
  AlignedArray<float> shift;   // velocity that evens the particles out, on top of `value`
  AlignedArray<float> open;    // share of the face that is not solid
  AlignedArray<float> solved;  // 1: pressure acts here, 0: not
  AlignedArray<float> known;   // 1: the value means something, 0: not
};

/// The velocity field of one sub-step. Work per tile, in parallel; the same bits on any number of threads.
class FaceField {
 public:
  /// Weighted means of what the particles carry; where none reaches, 0 and not known.
  void collect(const ParticleTiles& particles, const GridParticles& columns, SimdTarget simd);
  /// Adds (x, y) [m/s] to all that is known.
  void add(float x, float y);
  /// Goes outwards from the known faces by `layers` cells: means of the known neighbours.
  void extrapolate(int layers);
  /// The same of what stands at the solved faces of a field, which is 0 at all others.
  void spread(AlignedArray<float> FaceComponent::*field, int layers);
  /// The window around tile t of a field u at left faces and v at bottom ones.
  void fillWindow(std::size_t t, const AlignedArray<float>& u, const AlignedArray<float>& v, TileWindow& window) const;

  const TileGrid& tiles() const { return *tiles_; }
  FaceComponent x, y;
  AlignedArray<float> node;  // weight of particles at lower left corners

  std::size_t memoryBytes() const;

 private:
  // One component on its way outwards.
  struct Front {
    AlignedArray<std::uint16_t> known;  // by row
    AlignedArray<std::uint16_t> fresh;
    AlignedArray<std::uint8_t> extent;  // by tile: how much is known
    AlignedArray<std::uint8_t> moves;   // by tile: has fresh cells
    AlignedArray<float> next;
    float* values = nullptr;
    float* reached = nullptr;  // becomes 1 where the front gets; null: nobody asks
  };
  void start(Front& front, AlignedArray<float>& values, const AlignedArray<float>& known, float* reached);
  void goOn(int layers);
  void findLayer(Front& front, std::size_t t) const;
  void takeLayer(Front& front, std::size_t t) const;

  const TileGrid* tiles_ = nullptr;
  AlignedArray<TileSums> sums_;
  std::vector<std::uint32_t> sumsOf_;  // by tile; 0: the zeros
  SimdTarget simd_{};
  AlignedArray<TileLinks> links_;
  std::array<Front, 2> fronts_;
};

}  // namespace froude
