// What the arrangement of the particles does to gradients, taken out over a few spacings.
//
// Pair forces (pᵢ + pⱼ)∇W make particles in rows an elastic solid: sheared, they push back with up to a third of their
// pressure, and a vortex turns round like a spring. With B = M⁻¹, M = −Σ r ⊗ ∇W, in (pᵢBᵢ + pⱼBⱼ)∇W the stress of a
// sheared row is the pressure alone, and momentum is still kept (Bonet & Lok, Comput. Methods Appl. Mech. Eng. 180
// (1999)). But with a B of its own for each particle there is no arrangement at which a fluid could rest: it simmers at
// 2 % of √(gH). So M is averaged over 5 × 5 cells, about 110 particles: sheared rows are the same there, noise is not.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <froude/base/aligned.h>
#include <froude/particles/cell_grid.h>
#include <froude/solver/fluid/pair_loops.h>

namespace froude {

/// Memory is reused from step to step. Same bits on any number of threads.
class GradientCorrection {
 public:
  /// Where a particle is, as far as its gradients go.
  enum class Place : std::uint8_t { Inside, AtWall, AtSurface };

  /// Particles sorted by `grid`; moments M as the pair loops give them, place by particle. Cost: O(particles + cells).
  void build(const CellGrid& grid, std::span<const std::uint32_t> occupied, const Matrices<const float>& moment,
             const Place* place, float usual = kUsual);
  /// B where M is not used: the inverse of its mean over a fluid at rest, where the unit is the spacing.
  static constexpr float kUsual = 1.05f;

  /// B by particle: the inverse of the mean M inside, a multiple of the unit matrix elsewhere.
  Matrices<const float> matrices() const { return {xx_.data(), xy_.data(), yy_.data()}; }
  /// Is the particle so far inside that neither a surface nor a wall is in the cells around it?
  bool deep(std::size_t i) const { return deep_[i] != 0; }
  /// Is no free surface in the cells around it? A stray particle there is none.
  bool closed(std::size_t i) const { return closed_[i] != 0; }
  std::size_t memoryBytes() const;

 private:
  struct alignas(32) Sum {  // one or two registers
    float xx = 0.0f, xy = 0.0f, yy = 0.0f;
    float count = 0.0f;    // of particles inside
    float surface = 1.0f;  // of others; 1 more where there are none inside: a surface, or the other side of a wall
    float open = 0.0f;     // of these at a free surface
    float none[2] = {0.0f, 0.0f};
  };
  Sum around(const GridFrame& frame, std::uint32_t cell) const;

  AlignedArray<Sum> cells_;
  AlignedArray<float> xx_, xy_, yy_;
  AlignedArray<std::uint8_t> deep_, closed_;
};

}  // namespace froude
