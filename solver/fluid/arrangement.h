// How the particles of a sub-step lie: who is inside, who at a wall or a free surface, and what that makes of
// gradients.
#pragma once

#include <cstdint>

#include <froude/base/aligned.h>
#include <froude/solver/fluid/gradient_correction.h>
#include <froude/solver/fluid/pair_loops.h>
#include <froude/solver/fluid/wall_layer.h>

namespace froude {

/// Memory is reused from step to step.
class Arrangement {
 public:
  using Place = GradientCorrection::Place;

  /// Room for n particles.
  void resize(std::size_t n);
  /// Where the loop over moments writes; density and squares are the caller's.
  MomentLoop moments(const WallLayer& walls, float* density, float* squares);
  /// After that loop: judges places and averages moments. volume: of a particle in kernel units² (1 where the unit is
  /// the spacing); density, S and M are multiplied by it. Same bits on any number of threads.
  void judge(const CellGrid& grid, std::span<const std::uint32_t> occupied, const WallLayer& walls, double volume,
             float* density);

  Place place(std::size_t i) const { return place_[i]; }
  bool atSurface(std::size_t i) const { return place_[i] == Place::AtSurface; }
  bool inside(std::size_t i) const { return place_[i] == Place::Inside; }
  bool deep(std::size_t i) const { return correction_.deep(i); }
  bool closed(std::size_t i) const { return correction_.closed(i); }
  /// Is there a free surface? Only that gives pressures their zero, and so tension a meaning.
  bool hasSurface() const;
  /// Particles at a free surface, over the root of the number of all.
  double surfaceRows() const;
  /// B by particle.
  Matrices<const float> correction() const { return correction_.matrices(); }
  /// Mean share of a Laplacian that −F finds inside, half the trace of M; 1 where nothing is inside.
  double laplacianMoment() const { return laplacianMoment_; }
  /// S = Σ∇W.
  AlignedArray<float> skewX, skewY;
  /// M until `judge`, then free for use.
  AlignedArray<float> xx, xy, yy;
  std::size_t memoryBytes() const;

 private:
  GradientCorrection correction_;
  AlignedArray<Place> place_;
  double laplacianMoment_ = 1.0;
};

}  // namespace froude
