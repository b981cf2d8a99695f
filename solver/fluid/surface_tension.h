// Surface tension of particle fluids, the same for every method: the perimeter of discs around the particles pulls
// itself together, and where it meets a wall, the wall pulls along itself.
#pragma once

#include <cmath>
#include <vector>

#include <froude/base/aligned.h>
#include <froude/solver/definitions.h>
#include <froude/solver/fluid/pair_loops.h>
#include <froude/solver/fluid/wall_layer.h>
#include <froude/solver/step_context.h>

namespace froude {

/// The energy is σ times the perimeter of the union of discs whose radius is the kernel's unit (half the support, so
/// that discs meet where particles are neighbours; dx but for wcsph). Its gradient are forces between the two particles
/// at each vertex of the outline, along the line between them: momentum and moment of momentum are exact. At a wall,
/// which hides what is behind it, the wetted length has the energy −σ cos θ, by Young's law for the contact angle θ.
/// All of it in units of σ; lengths in kernel units.
class SurfaceTension {
 public:
  /// unit: half the support radius of the kernel of the pair loops [m]; volume: of a particle [unit²], which multiplies
  /// their sums.
  SurfaceTension(const FluidDef& def, double unit, double volume, kernel::Kind kernel);

  /// False where σ is 0: then nothing else is to be called.
  bool any() const { return tension_ > 0.0; }
  /// Largest sub-step [s]: a share of √(ρ dx³/σ), the time of the shortest capillary waves.
  double longestStep() const;
  /// √(σ/(ρ dx)) [m/s]: the speed of the shortest capillary waves.
  double fastestWave() const { return std::sqrt(tension_ / (density_ * spacing_)); }
  /// The least kinematic viscosity at which an outline is calm [m²/s]; 0 where σ is 0.
  double viscosity() const;
  /// Acceleration by a pull of 1 [m/s²]: σ/(ρ dx²).
  double unit() const { return tension_ / (density_ * spacing_ * spacing_); }

  /// What the outline does to two particles: the second gets the opposite.
  struct Pull {
    std::uint32_t first, second;
    Vec2 pull;
  };
  /// What a wall does to a particle where the outline meets it.
  struct WallPull {
    std::uint32_t particle;
    std::int32_t owner;  // body index, −1: the domain
    Vec2 pull;
    Vec2 at;  // from the particle
  };
  /// Finds all pulls, at the coordinates of the frame and at x, y [m]. Cost: one loop over pairs, and for particles at
  /// a surface a test of each of their outline's vertices against their neighbours.
  void find(const StepContext& context, const PairFrame& frame, const WallLayer& walls, std::span<const double> x,
            std::span<const double> y);
  /// visit(const Pull&) in an order that does not depend on threads; a particle may come several times.
  template <typename Visit>
  void forEachPull(Visit&& visit) const {
    for (const Block& b : blocks_) {
      for (const Pull& p : b.pulls) visit(p);
    }
  }
  template <typename Visit>
  void forEachWallPull(Visit&& visit) const {
    for (const Block& b : blocks_) {
      for (const WallPull& p : b.walls) visit(p);
    }
  }
  std::size_t memoryBytes() const;

 private:
  struct Neighbour {
    std::uint32_t particle;
    Vec2 at;  // from the particle that asks
  };
  struct Block {
    std::vector<Pull> pulls;
    std::vector<WallPull> walls;
    std::vector<Neighbour> near;
  };
  void findSurface(const StepContext& context, const PairFrame& frame, const WallLayer& walls);
  bool atSurface(const WallLayer& walls, std::uint32_t i) const;
  static void gather(const PairFrame& frame, std::uint32_t cell, std::uint32_t i, std::vector<Neighbour>& near);
  static bool covered(const Vec2& at, std::span<const Neighbour> near, std::uint32_t but,
                      std::span<const WallEdge> edges, const WallEdge* own);
  void pullPairs(std::uint32_t i, std::span<const WallEdge> edges, Block& block) const;
  void pullWalls(std::uint32_t i, std::span<const WallEdge> edges, Block& block) const;

  double tension_, density_, spacing_, wetting_;  // [N], [kg/m²], [m], cos θ
  double unit_;                                   // of the kernel [m]
  double share_;                                  // of what the energy gives a length
  float volume_;                                  // of a particle [unit²]
  CollisionFilter filter_;
  AlignedArray<float> filled_, skewX_, skewY_, squares_, xx_, xy_, yy_;
  std::vector<Block> blocks_;
};

}  // namespace froude
