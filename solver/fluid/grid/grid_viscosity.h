// Friction of the grid model: between the fluid and itself, and with the walls that it sticks to.
#pragma once

#include <vector>

#include <froude/solver/coupling/free_bodies.h>
#include <froude/solver/fluid/grid/face_field.h>
#include <froude/solver/fluid/grid/grid_pressure.h>
#include <froude/solver/fluid/grid/viscosity_system.h>
#include <froude/solver/step_context.h>

namespace froude {

/// Changes the faces' velocities by a sub-step of friction (viscosity_system.h), which free bodies are part of, and
/// says what walls got.
class GridViscosity {
 public:
  /// Of faces that are free of divergence. `pressure` after GridPressure::begin; density [kg/m²], viscosity [m²/s].
  /// Returns the iterations. Cost: about ten passes over the tiles and two an iteration; iterations as √(ν dt)/h.
  int smooth(const StepContext& context, const CutGrid& grid, double density, double viscosity,
             const GridPressure& pressure, FaceField& faces);
  /// What bodies got by it, by owner, a moment about the centre of mass; empty: no free body is held.
  std::span<const Wrench> drag() const { return drag_; }
  /// What walls got by it, to the books, and from `rest`.
  void book(ImpulseLedger& impulses, Vec2& rest) const;

  std::size_t memoryBytes() const { return coefficients_.memoryBytes() + system_.memoryBytes(); }

 private:
  struct Hold {
    HeldFace face;
    int owner;
    Vec2 at, surface, impulse;  // [m], velocity of the surface [m/s], on the wall [kg/s]
  };
  struct Body {
    int owner;
    Eigen::Matrix3d mass;  // S, in masses of a full cell
    std::vector<ViscousBody::Entry> entries;
  };
  struct Closed {
    float* value;
    float before;
  };
  void holdClosed(const StepContext& context, const CutGrid& grid, const GridPressure& pressure, FaceField& faces);
  void findHolds(const StepContext& context, const CutGrid& grid, const GridPressure& pressure, const TileGrid& tiles);
  void findBodies(const StepContext& context, double cellMass, double k);
  void findImpulses(const StepContext& context, double strength, const FaceField& faces);

  ViscosityCoefficients coefficients_;
  ViscositySystem system_;
  std::vector<Hold> holds_;
  std::vector<Body> bodies_;
  std::size_t bodyCount_ = 0;
  std::vector<std::int32_t> bodyOf_;  // by owner
  std::vector<ViscousBody> viscous_;
  std::vector<Wrench> drag_;
  std::vector<Eigen::Vector3d> gained_;
  std::vector<std::size_t> next_;
  std::vector<Closed> closed_;
};

}  // namespace froude
