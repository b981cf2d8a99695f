// The loops over pairs of fluid particles: the inner loops of the program. All lengths in spacings dx.
//
// Particles are sorted by cell; the candidates of a particle are three contiguous runs, which stream through the lanes
// without a gather. A sum is written by the one particle it belongs to, so that threads change no bit.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include <froude/base/aligned.h>
#include <froude/base/simd.h>
#include <froude/particles/cell_grid.h>
#include <froude/solver/fluid/kernel.h>

namespace froude {

/// Pairs whose connecting segment crosses a wall: bit k of a run's words is set where candidate k is visible.
struct HiddenPairs {
  const std::int32_t* offset =
      nullptr;  // per particle: first word, −1 where all candidates are visible; null: no walls
  const std::uint64_t* words = nullptr;  // per run ceil(length/64) words
};

/// The least diagonal: a particle without neighbours has none.
inline constexpr float kSmallestDiagonal = 0.05f;

/// An occupied cell: its particles and where their candidates are. Usual is a cell with at most three runs of at most
/// 16 candidates, none of them beyond a seam or hidden by a wall; Long is one whose runs have up to 16 more between
/// them. The runs of any other cell are looked up in each loop.
struct CellRuns {
  static constexpr std::uint32_t kUsual = 16;
  enum class Kind : std::uint16_t { Usual, Long, Other };
  std::uint32_t first = 0, last = 0;
  std::uint32_t begin[3] = {0, 0, 0};
  std::uint16_t count[3] = {0, 0, 0};
  Kind kind = Kind::Other;
};

/// What all loops of a sub-step share.
struct PairFrame {
  const CellGrid* grid = nullptr;
  std::span<const std::uint32_t> cells;  // those that hold particles
  const CellRuns* runs = nullptr;        // one for each of `cells`
  const std::int32_t* x = nullptr;       // lattice coordinates
  const std::int32_t* y = nullptr;
  std::int32_t periodX = 0, periodY = 0;  // lattice units
  HiddenPairs hidden;
  kernel::Kind kernel = kernel::Kind::Blend;  // of `moments` and `viscosity`
  const std::uint8_t* near = nullptr;         // by `PairLoops::near`; null: all candidates are looked at
};

/// Of a particle in a cell that is Usual or Long: which of its cell's candidates are neighbours, in a row of so many.
inline constexpr std::size_t kNearRow = 16;
/// Largest distance of such a neighbour, in support radii: what comes nearer within a sub-step weighs next to nothing.
inline constexpr float kNearReach = 1.05f;

/// One Jacobi sweep in the wake of the densities: change = max(least − κ, relaxation·(density − target)/diagonal), the
/// paper's λ (eq. 11) as a correction of what is there already. A target of 0 marks a particle that is new: what it
/// finds, at least the rest density, is what it may keep. An over-dense start is thus no push.
struct PressureUpdate {
  float* target = nullptr;          // null: no update
  const float* diagonal = nullptr;  // null: the one computed in the same loop
  const float* kappa = nullptr;
  float* change = nullptr;
  float relaxation = 0.0f;
  const float* least = nullptr;  // κ may not fall below; null: 0
  float momentum = 0.0f;         // of the last change that goes into this one (heavy ball, Polyak 1964)
};

/// Density at the present coordinates: density = Σ W + λ + g·s, s the displacement since the walls were integrated.
/// With `diagonal` also the diagonal of the pressure system, (S+g)·(S+2g) + Σ|∇W|², S = Σ∇W.
struct DensityLoop {
  const float* lambda = nullptr;  // null: no walls near any particle
  const float* wallX = nullptr;   // g [1/dx]
  const float* wallY = nullptr;
  const float* shiftX = nullptr;  // s
  const float* shiftY = nullptr;
  float* density = nullptr;
  float* diagonal = nullptr;  // may be null
  PressureUpdate update{};
};

/// A symmetric matrix for each particle, by components.
template <typename T>
struct Matrices {
  T* xx = nullptr;
  T* xy = nullptr;
  T* yy = nullptr;
};

/// Density as above without displacement, and what the arrangement makes of gradients: moment = −Σ r ⊗ ∇W (the unit
/// matrix in a continuum), S = Σ∇W and Σ|∇W|².
struct MomentLoop {
  const float* lambda = nullptr;  // null: no walls near any particle
  float* density = nullptr;
  float* skewX = nullptr;  // S
  float* skewY = nullptr;
  float* squares = nullptr;
  Matrices<float> moment;
};

/// What displacements u add to the densities, to first order: Σ (uᵢ − uⱼ)·Bᵢ∇W + u·g + λ', λ' what the walls' own
/// motion adds to λ. The excess of a particle whose κ may be negative counts either way.
struct DivergenceLoop {
  const float* ux = nullptr;  // [dx]
  const float* uy = nullptr;
  Matrices<const float> correction;  // B
  const float* wallX = nullptr;      // null: no walls near any particle
  const float* wallY = nullptr;
  const float* wallGain = nullptr;  // λ'
  PressureUpdate update{};
};

/// Pressures of weakly compressible fluids by their densities: κ = stiffness·(ρ' + background + damping·(ρ' − ρ'ₒ)),
/// ρ'ₒ before the acoustic step, with Tait's equation ((1 + ρ')⁷ − 1)/7 for the first ρ'; and κB times the particles'
/// volume. ρ' is first raised to the least that it may be. Damping: the acoustic damper of Sun et al., J. Comput. Phys.
/// 483 (2023).
struct StateEquation {
  const float* least = nullptr;  // by particle
  float stiffness = 0.0f, background = 0.0f;
  bool tait = false;
  float damping = 0.0f;
  float* pressure = nullptr;  // null: nothing of this
  Matrices<float> scaled;
};

/// With Wendland's kernel: what displacements u make of densities in an acoustic step, with diffusion: next = ρ' +
/// share·(Σ (uᵢ − uⱼ)·Bᵢ∇W + 2(u·g + λ') + diffusion Σ (−F)·((ρ'ⱼ − ρ'ᵢ) + ½(Gᵢ + Gⱼ)·(xᵢ − xⱼ))), ρ' = ρ/ρ0 − 1 and G
/// its gradient, taken from the acceleration by pressures: G = slope·a. The last term is zero where ρ' is linear
/// (Antuono et al. 2010, eq. 9). Behind a wall the fluid is its mirror image, as in `force`, whose adjoint this is: no
/// pressure can feed itself.
struct RateLoop {
  const float* ux = nullptr;  // [dx]
  const float* uy = nullptr;
  const float* excess = nullptr;  // ρ'
  const float* ax = nullptr;      // displacement by the pressures [dx]
  const float* ay = nullptr;
  Matrices<const float> correction;  // B
  float volume = 1.0f;               // of a particle, in front of the sums
  float slope = 0.0f;
  float diffusion = 0.0f;
  const float* wallX = nullptr;  // null: no walls near any particle
  const float* wallY = nullptr;
  const float* wallGain = nullptr;  // λ' of the sub-step
  float wallShare = 1.0f;           // of it in this step
  const float* share = nullptr;     // by particle, of all these gains
  float* next = nullptr;
  StateEquation state{};         // of `next`
  std::int32_t* newX = nullptr;  // where not null: PairFrame::x plus u
  std::int32_t* newY = nullptr;
};

/// Displacement by a pressure: s −= Σ (κᵢ + κⱼ)∇W + 2κᵢ g, and the coordinates that follow from it. Behind the wall the
/// pressure rises along it as in front: of the component along the wall the share λ is missing and is made up for.
struct DisplacementLoop {
  const float* pressure = nullptr;  // κ = p·dt²/(ρ dx²), no unit
  const float* wallX = nullptr;     // null: no walls
  const float* wallY = nullptr;
  const float* tangent = nullptr;  // λ/((1 − λ)·|g|²)
  float* shiftX = nullptr;         // in and out
  float* shiftY = nullptr;
  std::int32_t* newX = nullptr;  // written: PairFrame::x plus the new displacement
  std::int32_t* newY = nullptr;
  float* kappa = nullptr;  // where not null, `pressure` is added to it
};

/// Relative velocity smoothing and laminar viscosity: change = Σ weight(q)·(vⱼ − vᵢ), weight = a·W + b·(−F),
/// F = (dW/dq)/q. a: XSPH; b: Morris' laminar term, 2ν dt/dx².
struct ViscosityLoop {
  const float* vx = nullptr;  // [m/s]
  const float* vy = nullptr;
  float a = 0.0f, b = 0.0f;
  float* changeX = nullptr;
  float* changeY = nullptr;
};

/// Displacement by a pressure with corrected gradients: s −= Σ (κᵢBᵢ + κⱼBⱼ)∇W + 2κᵢ g; the adjoint of the divergence
/// but for the walls, as above.
struct PushLoop {
  const float* pressure = nullptr;  // κ
  Matrices<const float> scaled;     // κB
  const float* skewX = nullptr;     // S
  const float* skewY = nullptr;
  const float* wallX = nullptr;  // null: no walls
  const float* wallY = nullptr;
  const float* tangent = nullptr;
  float* shiftX = nullptr;  // in and out
  float* shiftY = nullptr;
  float* totalX = nullptr;  // in and out, as shift
  float* totalY = nullptr;
  float* kappa = nullptr;  // where not null, `pressure` is added to it
};

/// With Wendland's kernel, as `rate`: displacement by a pressure at present coordinates: shift = −Σ (σᵢκᵢBᵢ + κⱼBⱼ)∇W −
/// 2κᵢ g, also added to u. σ is 1, or −1 for a particle that feels differences of pressure (Sun et al., Comput. Phys.
/// Commun. 224 (2018)).
struct ForceLoop {
  const float* pressure = nullptr;  // κ
  const float* sign = nullptr;      // σ
  Matrices<const float> scaled;     // κB, times the particles' volume
  const float* wallX = nullptr;     // null: no walls
  const float* wallY = nullptr;
  const float* tangent = nullptr;
  float* shiftX = nullptr;
  float* shiftY = nullptr;
  float* ux = nullptr;  // in and out
  float* uy = nullptr;
  float* kappa = nullptr;        // where not null, `pressure` is added to it
  const float* fallX = nullptr;  // where not null, added to u
  const float* fallY = nullptr;
  float* totalX = nullptr;  // where not null, the shifts are added to it
  float* totalY = nullptr;
};

/// Fills `runs`, one for each of `cells`. Reuses the memory.
void findCellRuns(const CellGrid& grid, std::span<const std::uint32_t> cells, const HiddenPairs& hidden,
                  AlignedArray<CellRuns>& runs);

/// The loops of one instruction set; each handles cells [begin, end) of PairFrame::cells.
struct PairLoops {
  /// Returns Σ max(0, density − target) where pressures are updated.
  double (*density)(const PairFrame&, const DensityLoop&, std::size_t begin, std::size_t end);
  /// As `density`.
  double (*divergence)(const PairFrame&, const DivergenceLoop&, std::size_t begin, std::size_t end);
  void (*moments)(const PairFrame&, const MomentLoop&, std::size_t begin, std::size_t end);
  void (*push)(const PairFrame&, const PushLoop&, std::size_t begin, std::size_t end);
  void (*displace)(const PairFrame&, const DisplacementLoop&, std::size_t begin, std::size_t end);
  void (*viscosity)(const PairFrame&, const ViscosityLoop&, std::size_t begin, std::size_t end);
  /// Returns the sums over the particles of what pairs make of their shifts: momentum, but for rounding 0 where all σ
  /// = 1.
  std::array<double, 2> (*force)(const PairFrame&, const ForceLoop&, std::size_t begin, std::size_t end);
  void (*rate)(const PairFrame&, const RateLoop&, std::size_t begin, std::size_t end);
  /// Fills rows of kNearRow for the particles of cells that are Usual or Long, for PairFrame::near of later loops. Null
  /// where it would not pay: candidates of a cell must fit into the registers that a look-up takes.
  void (*near)(const PairFrame&, std::uint8_t* rows, std::size_t begin, std::size_t end);
};

/// Plain C++ in the order of the formulas: the oracle of the wide versions.
const PairLoops& scalarPairLoops();
/// The loops of a target; those of Scalar are `scalarPairLoops`.
const PairLoops& pairLoops(SimdTarget target);

}  // namespace froude
