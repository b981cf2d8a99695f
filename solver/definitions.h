// What a world is made of: plain structs that go in. SI units; in two dimensions density is kg/m², pressure N/m.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <froude/base/simd.h>
#include <froude/base/types.h>
#include <froude/fields/polygon.h>
#include <froude/fields/triangle_mesh.h>
#include <froude/particles/emitter.h>

namespace froude {

/// A vector that may vary in space and time. Called from several threads at once; must be pure.
using VectorField = std::function<Vec2(const Vec2& x /* m */, double t /* s */)>;
/// A number that may vary in time. Called from one thread.
using TimeFunction = std::function<double(double t /* s */)>;

enum class Species { Fluid, Bullet, Soft };

/// What a force callback is told about a particle. `index` is its place in the pool's columns while the callback runs:
/// columns are read there through a const World.
struct ForcePoint {
  Species species;
  std::uint32_t index;
  Vec2 x;    // [m]
  Vec2 v;    // [m/s]
  double t;  // [s]
};
/// An acceleration [m/s²] that is added to gravity. Called from several threads at once, in no order; must be pure and
/// must not throw.
using ForceCallback = std::function<Vec2(const ForcePoint&)>;

/// Names one life of one body, whatever is created and destroyed beside it. {0, 0} is null.
struct BodyId {
  std::uint32_t slot = 0;
  std::uint32_t generation = 0;
  bool isNull() const { return generation == 0; }
  friend bool operator==(const BodyId&, const BodyId&) = default;
};

enum class Slip { Free, NoSlip };
enum class Motion { Fixed, Scripted, Free };

/// The box of the simulation. What leaves it is retired and counted.
struct DomainDef {
  Box box;                                             // [m]
  std::array<bool, 4> closed{true, true, true, true};  // left, right, bottom, top: a wall stands there
  bool periodicX = false, periodicY = false;           // such a pair of sides has no wall
  Slip slip = Slip::Free;
};

/// One stretch of a scripted motion, up to `until` [s, simulated time since the start].
struct ScriptPiece {
  double until = 0.0;
  TimeFunction velocityX, velocityY;  // of the body's origin [m/s]; empty: 0
  TimeFunction spin;                  // [rad/s]; empty: 0
};

/// Turns a hinged body towards a speed.
struct MotorDef {
  double speed = 0.0;   // [rad/s]
  double torque = 0.0;  // at most [N]
};

/// Holds a point of a free body where it is in the world.
struct HingeDef {
  Vec2 at{0, 0};  // at the start [m]
  std::optional<MotorDef> motor;
};

struct BodyDef {
  std::string name;
  std::shared_ptr<const Polygon> shape;  // in the body's own frame [m]
  Vec2 position{0, 0};                   // of the body's origin [m]
  double angle = 0.0;                    // [rad]
  Motion motion = Motion::Fixed;
  double density = 1000.0;  // [kg/m²]
  Vec2 velocity{0, 0};      // of the origin (scripted) or the centre of mass (free) [m/s]
  double spin = 0.0;        // [rad/s]
  double friction = 0.3;
  double restitution = 0.1;
  std::optional<Slip> slip;      // default: the domain's
  double surfaceVelocity = 0.0;  // along the edge, counter-clockwise [m/s]
  std::uint32_t group = 1, collidesWith = ~0u;
  std::vector<ScriptPiece> script;  // in order; a scripted body without script keeps velocity and spin
  std::optional<HingeDef> hinge;    // free bodies only
};

/// How particle methods take the laminar viscosity: Auto solves for it where the explicit term would bind the sub-step.
enum class ViscositySolver : std::uint8_t { Auto, Explicit, Implicit };

/// Pressure over the density ratio r = ρ/ρ0: Linear c²(r − 1), Tait c²(r⁷ − 1)/7 (times ρ0).
enum class EquationOfState : std::uint8_t { Linear, Tait };

/// Keys of the weakly compressible model alone.
struct CompressibleDef {
  double support = 3.0;              // radius of a kernel, in spacings, 2 to 6
  double soundSpeed = 0.0;           // c [m/s]; 0: ten times the largest speed that is to be expected
  double densityDiffusion = 0.2;     // δ
  double artificialViscosity = 0.0;  // α (Monaghan): a kinematic viscosity of α·c·(support radius)/16
  double backgroundPressure = 0.0;   // [Pa·m]: on top of all pressures, where there is no free surface
  EquationOfState equation = EquationOfState::Linear;
};

/// The model's keys. Left-out values are each model's documented defaults.
struct FluidDef {
  std::string model = "pbf";
  double spacing = 0.01;          // dx [m]; a particle's mass is density·dx²
  double density = 1000.0;        // rest density [kg/m²]
  double viscosity = 1.0e-6;      // kinematic [m²/s]
  double surfaceTension = 0.0;    // [N]
  double contactAngle = kPi / 2;  // [rad]
  int sweeps = 0;                 // pressure sweeps a sub-step; 0: the model's default
  double courant = 0.0;           // largest v·dt/support radius; 0: the model's default
  double flip = 0.0;              // apic: share that a particle keeps of what its velocity differs from the grid's by
  ViscositySolver viscositySolver = ViscositySolver::Auto;
  CompressibleDef compressible;
  std::uint32_t group = 1, collidesWith = ~0u;
};

struct BulletDef {
  double radius = 0.002;    // [m]
  double density = 1000.0;  // [kg/m²]; mass = density·π·radius²
  double friction = 0.0;
  double restitution = 0.5;
  std::uint32_t group = 1, collidesWith = ~0u;
};

/// NeoHookean, StVenantKirchhoff: elastic triangles. ShapeMatching: drawn to the best fit of the rest shape. Springs:
/// edges, angles and area. Rope: a chain of points that resists stretching and bending.
enum class SoftModel : std::uint8_t { NeoHookean, StVenantKirchhoff, ShapeMatching, Springs, Rope };

/// A deformable body. Its particles are the mesh's points, in that order.
struct SoftDef {
  std::string name;
  SoftModel model = SoftModel::NeoHookean;
  std::shared_ptr<const TriangleMesh> mesh;  // at rest, in the own frame; a rope: points along it, no triangles
  Vec2 position{0, 0};                       // world = position + R(angle)·p [m]
  double angle = 0.0;                        // [rad]
  Vec2 velocity{0, 0};                       // [m/s]
  double spin = 0.0;                         // about the centre of mass [rad/s]
  double spacing = 0.02;                     // mean distance of neighbours [m]
  double thickness = 0.0;                    // of a rope [m], > 0
  double density = 1000.0;                   // [kg/m²]; a rope's mass per length is density·thickness
  double young = 1.0e5;                      // E [N/m²], plane strain
  double poisson = 0.45;                     // ν, 0 ≤ ν < 0.5
  double damping = 0.0;                      // rate at which strain rates decay [1/s]
  double friction = 0.3;                     // with a body's: the geometric mean
  double strainLimit = 0.0;                  // a triangle or link that is stretched by more tears; 0: never
  double pressure = 0.0;                     // of an inflated body's inside [N/m]
  std::vector<std::uint32_t> pinned;         // points that stay where they are
  std::uint32_t group = 1, collidesWith = ~0u;
};

/// How soft bodies are advanced within a sub-step of the world.
struct SoftSettings {
  int substeps = 0;        // per 1/60 s, at least; more where the fastest wave asks for them
  double tolerance = 0.0;  // each is swept until its multipliers change by less of themselves; 0: one sweep
};

struct SinkDef {
  std::shared_ptr<const Polygon> shape;  // world coordinates [m]
};

/// Limits that stop a run as unstable, and how hard it is tried before (design of the step: undo and halve).
struct StabilityLimits {
  double compression = 0.30;  // largest density/rest density − 1
  double displacement = 1.0;  // largest travel in a sub-step, in support radii
  double energyGain = 0.20;   // of the scene's energy scale
  int halvings = 8;
};

/// Everything that `World` is built from.
struct WorldDef {
  DomainDef domain;
  Vec2 gravity{0.0, -9.81};  // [m/s²], used where `gravityField` is empty
  VectorField gravityField;
  ForceCallback force;  // [m/s²], on top of gravity; empty: none
  std::uint64_t seed = 1;
  std::optional<double> timeStep;  // the literal sub-step [s]; empty: adaptive
  std::optional<FluidDef> fluid;
  std::optional<BulletDef> bullet;
  std::vector<SoftDef> soft;
  SoftSettings softSettings;
  std::vector<BodyDef> bodies;
  std::vector<EmitterDef> emitters;
  std::vector<SinkDef> sinks;
  SimdTarget simd = bestSimdTarget();
  StabilityLimits limits;
};

}  // namespace froude
