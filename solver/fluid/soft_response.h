// Soft walls inside the pressure iterations: how far a fluid's pressures move their nodes, and what that changes for
// the fluid's densities.
#pragma once

#include <span>
#include <vector>

#include <froude/solver/coupling/soft_walls.h>
#include <froude/solver/fluid/wall_layer.h>

namespace froude {

/// As BodyResponse, node by node: m q = Σ 2κ w G − what was expected, w the node's share of a particle's wall. Lengths
/// in units of the solve, masses in particles' masses.
class SoftResponse {
 public:
  /// length [m], mass [kg/m]: of a particle; impulse: mass·length/dt [kg/s].
  void begin(SoftWalls* walls, double length, double mass, double impulse);
  /// The links of `layer` to them, of particles at x, y [m].
  void link(const WallLayer& layer, std::span<const double> x, std::span<const double> y);
  bool any() const { return !links_.empty(); }

  /// Adds what the walls' own motion does to λ in a time [s].
  void addGain(double time, float* gain) const;
  void holdBack(const float* diagonal);
  /// What linked particles see while no node has moved.
  void restore(const float* field, float* answered) const;
  /// One step towards where the pressures κ, times `share`, bring the nodes; `past`: as in BodyResponse::follow. Takes
  /// what that changes off what the particles see.
  void follow(const float* kappa, double share, double past, float* answered);
  /// The impulse [kg/s] of the n-th link of a soft owner.
  void give(std::size_t n, const Vec2& impulse);

 private:
  struct Link {
    std::uint32_t particle, node;
    double weight, x, y;  // of the wall's gradient that stands on the node
  };
  struct Node {
    double inverseMass = 0.0;
    Vec2 expected{0, 0}, moved{0, 0}, sum{0, 0};
    double hold[3] = {0.0, 0.0, 0.0};  // xx, xy, yy
  };
  SoftWalls* walls_ = nullptr;
  double length_ = 1.0;
  std::vector<Node> nodes_;
  std::vector<Link> links_;         // by particle
  std::vector<std::size_t> first_;  // of each link of the layer, and the end
  std::vector<SoftWalls::Share> shares_;
};

}  // namespace froude
