// The pressure of an incompressible fluid on a tile grid: one global solve a step. Conjugate gradients, preconditioned
// by a multigrid cycle (McAdams, Sifakis & Teran, SCA 2010), matrix-free. Knows no particles and no polygons.
//
// The unknown is κ = p·dt²/(ρh²), without a unit. A κ = b states for every cell that the fluxes through its faces,
// after u −= (h/dt)(κ_cell − κ_left) at each open face, add up to nothing: Σ a (κ_cell − κ_neighbour) + ground·κ_cell =
// b, with b = −dt/h · (net outward flux through the open faces, moving walls included): the share of the cell that the
// step would lose too much, or gain too little. The residual has the same unit: divergence × step.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>

#include <froude/base/aligned.h>
#include <froude/base/simd.h>
#include <froude/fields/tile_grid.h>

namespace froude {

/// What a cell holds. Air is where the pressure is zero; it comes first so that the null tile is air.
enum class GridCell : std::uint8_t { Air = 0, Solid = 1, Fluid = 2 };

/// A coupling of two unknowns that are not neighbours on the grid, or not through their common face alone.
struct PressureEdge {
  std::uint32_t a = 0, b = 0;  // places
  float coefficient = 0.0f;
};

/// The matrix. Unknowns have places: of a cell that in the fields of the grid, of the extra unknown e (a second part of
/// a cell that a wall splits) grid.values() + e. An unknown without any coupling takes no part: its κ is 0.
struct PressureCoefficients {
  AlignedArray<float> ax;      // by cell: of its left face; 0 unless both sides are unknowns
  AlignedArray<float> ay;      // of its bottom face
  AlignedArray<float> ground;  // by place: sum of the coefficients towards κ = 0
  AlignedArray<PressureEdge> edges;

  /// From open fractions wx, wy of faces in [0, 1] and kinds: a = w between two cells of fluid, and w to the ground for
  /// each face between fluid and air. Overwrites all; extra unknowns are without couplings yet, and there are no edges.
  /// Precondition: the tiles to the right of, and above, cells of fluid exist, or those faces are closed.
  void fromWeights(const TileGrid& grid, const GridCell* kind, const float* wx, const float* wy, std::size_t extra = 0);
  void addEdge(std::size_t a, std::size_t b, double coefficient) {
    edges.push_back({static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b), static_cast<float>(coefficient)});
  }
  void addGround(std::size_t place, double coefficient) { ground[place] += static_cast<float>(coefficient); }
};

/// A free body in the pressure system: A gains Jᵀ·mobility·J, where J gives force and torque that κ exerts on it.
struct PressureBody {
  struct Entry {
    std::uint32_t place = 0;
    std::array<float, 3> j{0, 0, 0};  // per κ: x, y, turn
  };
  std::array<float, 3> mobility{0, 0, 0};  // in the unit that makes J'·mobility·J κ a share of a cell
  std::span<const Entry> entries;
};

struct PressureReport {
  int iterations = 0;
  float residual = 0.0f;      // largest |b − Aκ| over the unknowns
  bool converged = false;     // residual ≤ tolerance, or ≤ 1e-6 of the largest κ: single precision's end
  bool fallback = false;      // the multigrid's iterations stalled and another method was used
  int closedRegions = 0;      // connected unknowns without ground
  float closedSource = 0.0f;  // largest mean of b over such a region: cannot be met, and was spread over it
};

/// Memory is reused; no allocation in a steady state. Same bits on any number of threads.
class PressureSystem {
 public:
  explicit PressureSystem(SimdTarget target = bestSimdTarget());
  ~PressureSystem();
  PressureSystem(PressureSystem&&) noexcept;
  PressureSystem& operator=(PressureSystem&&) noexcept;

  /// Makes the levels. `grid` and `coefficients` must live, unchanged, as long as `solve` is called; bodies' entries
  /// likewise. Cost: about that of two iterations.
  void prepare(const TileGrid& grid, const PressureCoefficients& coefficients,
               std::span<const PressureBody> bodies = {});

  struct Limits {
    float tolerance = 1e-3f;  // of |b − Aκ|
    int iterations = 60;
  };
  /// Solves A κ = b, from what κ holds on (0 or the last step's). b and κ are by place, grid.values() + extra of them;
  /// κ is 0 where there is no unknown, and of mean 0 over each closed region. Precondition: finite.
  PressureReport solve(const float* b, float* kappa, const Limits& limits);

  std::size_t memoryBytes() const;

 private:
  struct Data;
  std::unique_ptr<Data> data_;
};

}  // namespace froude
