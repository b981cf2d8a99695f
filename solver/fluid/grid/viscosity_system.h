// Viscosity on a staggered tile grid, implicit and variational: C. Batty & R. Bridson, "Accurate viscous free surfaces
// for buckling, coiling, and rotating liquids", SCA 2008. Of all velocities u the one that minimises
//   ½ Σ m (u − u*)² + k Σ_cells A (e_xx² + e_yy²) + ½ k Σ_nodes A (∂u/∂y + ∂v/∂x)² + ½ k Σ_walls g (u − w)²,
// k = ν dt/h², differences in cells. No stress acts on a free surface, and what turns as a whole goes on turning.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include <froude/base/aligned.h>
#include <froude/base/types.h>
#include <froude/fields/tile_grid.h>
#include <froude/solver/fluid/grid/pressure_system.h>

namespace froude {

/// A straight wall within a cell, to which fluid sticks.
struct StickingWall {
  std::size_t place = 0;  // of the cell
  double length = 0.0;    // [cells]
  Vec2 normal{0, 0};      // unit
  Vec2 point{0, 0};       // any on its line, from the cell's lower left corner [cells]
  Vec2 velocity{0, 0};    // [m/s]
};

/// How firmly a face is held by a wall: g of component 0 (x) or 1 (y) of the face at a place.
struct HeldFace {
  std::size_t component = 0, place = 0;
  double g = 0.0;
};
struct HeldFaces {
  std::array<HeldFace, 4> face;
  std::size_t count = 0;
  const HeldFace* begin() const { return face.data(); }
  const HeldFace* end() const { return face.data() + count; }
};

/// A free body that fluid sticks to changes its motion q (along x, along y, turn) by S q = k Σ g Jᵀ(u − w), S = M + k
/// Σ g JᵀJ, over the faces that it holds: w what its surface moves at before, J q what q is at a face.
struct ViscousBody {
  struct Entry {
    std::size_t component = 0, place = 0;
    double g = 0.0, w = 0.0;
    Eigen::Vector3d j{0.0, 0.0, 0.0};
  };
  Eigen::Matrix3d mobility = Eigen::Matrix3d::Zero();  // k S⁻¹, M in masses of a full cell
  std::span<const Entry> entries;

  /// What the velocities u, v of all faces less w (times `own`) make of its motion.
  Eigen::Vector3d gained(const float* u, const float* v, double own) const;
};

/// What the sums go over, by place. A face without mass is no unknown: it keeps its velocity, which its cells feel.
struct ViscosityCoefficients {
  AlignedArray<float> cell;              // A of a cell: its share of fluid
  AlignedArray<float> node;              // A around a cell's lower left corner
  AlignedArray<float> massX, massY;      // m of its left and bottom face
  AlignedArray<float> groundX, groundY;  // Σ g
  AlignedArray<float> wallX, wallY;      // Σ g·w [m/s]

  /// From kinds of cells, their open areas and the open shares of faces, without walls: those slip. Overwrites all.
  void fromCells(const TileGrid& grid, const GridCell* kind, const float* area, const float* openX, const float* openY);
  /// g = length·(share of the wall along the component)/(distance of the face's centre), on the faces of the wall's
  /// cell, which it returns.
  HeldFaces addWall(const TileGrid& grid, const StickingWall& wall);
  std::size_t memoryBytes() const { return 8 * cell.capacity() * sizeof(float); }
};

struct ViscosityReport {
  int iterations = 0;
  float residual = 0.0f;  // largest, as a velocity [m/s]
  bool converged = false;
};

/// Conjugate gradients with the diagonal as preconditioner, matrix-free: iterations grow as √k. Memory is reused; the
/// same bits on any number of threads.
class ViscositySystem {
 public:
  /// Replaces u and v [m/s, by face] by the minimiser for k = ν dt/h², from themselves on, until no residual is above
  /// `tolerance` [m/s]. Free bodies give way: what they hold is in `coefficients` as if they did not. Precondition:
  /// finite, k ≥ 0.
  ViscosityReport solve(const TileGrid& grid, const ViscosityCoefficients& coefficients, double k, float* u, float* v,
                        float tolerance, int mostIterations = 500, std::span<const ViscousBody> bodies = {});

  std::size_t memoryBytes() const;

 private:
  struct Component {
    AlignedArray<float> r, p, q, inverse;
  };
  void apply(const float* u, const float* v, float* outU, float* outV);
  void applyTile(std::size_t t, const std::array<const float*, 2>& in, const std::array<float*, 2>& out);
  void addBodies(const float* u, const float* v, double own, float sign, float* outU, float* outV) const;
  void begin(float* u, float* v);
  template <typename Body>
  std::array<double, 2> overFaces(Body&& body);

  const TileGrid* grid_ = nullptr;
  const ViscosityCoefficients* coefficients_ = nullptr;
  std::span<const ViscousBody> bodies_;
  float k_ = 0.0f;
  std::array<Component, 2> parts_;
  AlignedArray<std::array<double, 2>> sums_;  // by tile
};

}  // namespace froude
