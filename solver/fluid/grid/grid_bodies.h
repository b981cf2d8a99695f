// Free bodies in the pressure system of the grid: what pressure makes of their motion is part of the solve.
#pragma once

#include <span>
#include <vector>

#include <froude/fields/cut_cells.h>
#include <froude/solver/coupling/free_bodies.h>
#include <froude/solver/fluid/grid/pressure_system.h>

namespace froude {

/// What a wall feels of the κ of cells: Σ normal·κ pushes it and Σ moment·κ turns it, units as those of CutWall.
struct WallPressure {
  struct Share {
    std::uint32_t place = 0;
    Vec2 normal{0, 0};
    double moment = 0.0;
  };
  std::array<Share, 5> share;
  std::size_t count = 0;

  void add(std::size_t place, const Vec2& normal, double moment) {
    share[count++] = {static_cast<std::uint32_t>(place), normal, moment};
  }
  std::span<const Share> shares() const { return {share.data(), count}; }
};

/// The rigid solver has moved the bodies with the pressure of the sub-step before; here that is taken back, and what
/// the pressure is now put in its place. A hinged body has one freedom, its turn.
class GridBodies {
 public:
  /// Null: there are none. density [kg/m²], size of a cell [m], dt [s]; `drag` acts on them besides, by owner, or is
  /// empty.
  void begin(FreeBodies* bodies, double density, double size, double dt, std::span<const Wrench> drag = {});
  bool isFree(int owner) const { return bodies_ != nullptr && bodies_->isFree(owner); }
  /// A wall of a cell. Returns what the body's motion without any pressure pushes into the cell of a share [of a
  /// cell's size · m/s]. Precondition: its body is free.
  double add(int owner, const WallPressure::Share& share);
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
