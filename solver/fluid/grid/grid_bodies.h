// Free bodies in the pressure system of the grid: what pressure makes of their motion is part of the solve.
#pragma once

#include <span>
#include <vector>

#include <froude/fields/cut_cells.h>
#include <froude/solver/coupling/free_bodies.h>
#include <froude/solver/fluid/grid/pressure_system.h>

namespace froude {

/// The rigid solver has moved the bodies with the pressure of the sub-step before; here that is taken back, and what
/// the pressure is now put in its place. A hinged body has one freedom, its turn.
class GridBodies {
 public:
  /// Null: there are none. density [kg/m²], size of a cell [m], dt [s].
  void begin(FreeBodies* bodies, double density, double size, double dt);
  bool isFree(int owner) const { return bodies_ != nullptr && bodies_->isFree(owner); }
  /// A wall of the cell at `place`. Returns what the body's motion without any pressure pushes into the cell [of a
  /// cell's size · m/s]. Precondition: its body is free.
  double add(const CutWall& wall, std::uint32_t place);
  /// For the system; good until the next `begin`.
  std::span<const PressureBody> system();
  /// Tells the bodies what pressure did and moves them; those too that the fluid has left.
  void settle(const float* kappa);

 private:
  struct Body {
    int owner;
    Vec2 velocity;  // of the centre of mass without pressure [m/s]
    double spin;    // [rad/s]
    bool hinged;
    Vec2 arm;              // from the hinge to the centre of mass [m]
    double mass, inertia;  // [kg/m], [kg·m]; of a hinged body about its hinge
    std::vector<PressureBody::Entry> entries;
    std::vector<std::array<double, 3>> walls;  // normal and moment about the centre of mass, by entry
  };

  FreeBodies* bodies_ = nullptr;
  double density_ = 0.0, size_ = 0.0, dt_ = 0.0;
  std::vector<Body> moving_;
  std::size_t count_ = 0;
  std::vector<std::int32_t> indexOf_;
  std::vector<PressureBody> system_;
};

}  // namespace froude
