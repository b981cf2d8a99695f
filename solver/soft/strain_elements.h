// Elastic energy of a body in pieces over which the strain is averaged: what their loops read, and how it is compiled.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <froude/base/aligned.h>
#include <froude/base/simd.h>
#include <froude/fields/triangle_mesh.h>

namespace froude {

enum class StrainModel : std::uint8_t { NeoHookean, StVenantKirchhoff };

/// Lamé's constants of plane strain [N/m²].
struct Lame {
  double mu = 0.0, lambda = 0.0;
  /// Precondition: 0 ≤ poisson < 0.5.
  static Lame of(double young, double poisson) {
    return {young / (2.0 * (1.0 + poisson)), young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson))};
  }
  double waveModulus() const { return lambda + 2.0 * mu; }
};

/// Elements at whose multiple a colour begins; the widest lanes.
inline constexpr std::size_t kElementLanes = 8;

/// Elements of up to four nodes with the deformation gradient F = Σ_{k=1..3} (x_k − x_0) b_kᵀ, constant in each. By
/// colour: elements of one colour share no node. Colours begin at multiples of kElementLanes and are filled up with
/// elements of no area at the dummy node, which stands behind the body's last.
struct StrainElements {
  AlignedArray<std::uint32_t> node[4];
  AlignedArray<double> b[6];          // b_1x, b_1y, b_2x, … [1/m]
  AlignedArray<double> inertia[3];    // Σ w_k b_k b_kᵀ: xx, xy, yy [1/(kg·m)], w the inverse mass
  AlignedArray<double> area;          // [m²]; 0: torn
  AlignedArray<double> given[3];      // compliance times multiplier of each constraint, scratch
  std::vector<std::uint32_t> ofEdge;  // by triangle and its three sides: the element there
  std::vector<std::size_t> colors;    // begin of each, and the end
  /// No angular frequency² of the body is above this times waveModulus/density: that of the stiffest element alone, as
  /// its share of the nodes' masses lets it move (Irons' theorem) [1/m²].
  double stiffest = 0.0;
  std::size_t size() const { return area.size(); }
};

/// One triangle a piece, or the strain averaged over the two triangles at each edge, a third of each (edge-based
/// smoothing, Liu, Nguyen-Thoi & Lam 2009), which bends right with few points across.
enum class StrainPieces : std::uint8_t { Triangles, Edges };

/// `inverseMass` [m/kg] by node; 0: held.
StrainElements compileStrain(const TriangleMesh& mesh, StrainPieces pieces, std::span<const double> inverseMass);

/// Largest principal stretch of an element.
double stretchOf(const StrainElements& elements, std::size_t e, const double* x, const double* y);

/// Nodes in the body's own columns, one dummy behind the last.
struct NodeColumns {
  double* x = nullptr;  // [m]
  double* y = nullptr;
  double* fx = nullptr;  // [N/m]
  double* fy = nullptr;
  const double* inverseMass = nullptr;  // [m/kg]
};

/// The loops over elements [begin, end) of one colour.
struct StrainLoops {
  /// Adds the elastic forces to fx, fy, and remembers in `given` the multipliers that make them.
  void (*force)(const Lame& lame, StrainElements& elements, const NodeColumns& nodes, std::size_t begin,
                std::size_t end);
  /// One XPBD projection: brings x to where the element's force is that of its strain there. `dtSquared` [s²].
  void (*project)(const Lame& lame, double dtSquared, StrainElements& elements, const NodeColumns& nodes,
                  std::size_t begin, std::size_t end);
};
/// Plain C++: the oracle of the wide versions. Neo-Hookean: Macklin & Müller 2021, in two dimensions with the volume
/// stiffness λ + μ and the rest offset μ/(λ + μ). St Venant-Kirchhoff: Green's strain as a block of three constraints
/// (Macklin, Müller & Chentanez 2016, section 5).
StrainLoops strainLoopsScalar(StrainModel model);
/// The loops of a target; those of Scalar are `strainLoopsScalar`.
StrainLoops strainLoops(StrainModel model, SimdTarget target);

/// Elastic energy of all elements [J/m], in their order.
double strainEnergy(StrainModel model, const Lame& lame, const StrainElements& elements, const double* x,
                    const double* y);

}  // namespace froude
