// Springs between few points: lengths, angles and areas, as XPBD constraints with a stiffness of their own.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <froude/fields/triangle_mesh.h>
#include <froude/solver/soft/strain_elements.h>

namespace froude {

/// Constraints of one body, projected one after the other in their order (Gauss-Seidel); for bodies that are chains or
/// small. The energy of each is stiffness/2 · C². Stiffness 0: torn.
class Links {
 public:
  /// A chain through all points in order: axial stiffness young·thickness, bending stiffness E I = young·thickness³/12.
  /// Between two held points (inverse mass 0) nothing bends: the second is the clamp.
  static Links rope(const TriangleMesh& mesh, double young, double thickness, double density,
                    std::span<const double> inverseMass);
  /// Springs along the edges and an area term in each triangle. On equilateral triangles the small-strain constants are
  /// μ, and λ where it is at least μ (ν ≥ 1/4); springs alone have λ = μ. Source: the triangular lattice,
  /// k = (8/3)·μ·√3/2 a spring, Ostoja-Starzewski 2002.
  static Links springs(const TriangleMesh& mesh, const Lame& lame, double density);

  /// Adds the forces, and remembers the multipliers that make them.
  void force(const NodeColumns& nodes);
  /// One sweep; `dtSquared` [s²].
  void project(double dtSquared, const NodeColumns& nodes);
  double energy(const double* x, const double* y) const;  // [J/m]
  /// Tears lengths that are stretched by more than the limit, with the angles and areas on them. Returns how many.
  std::size_t tear(double limit, const double* x, const double* y);

  /// No angular frequency² of the body is above this [1/s²].
  double frequencySquared() const { return frequencySquared_; }
  bool empty() const { return lengths_.empty(); }
  std::size_t torn() const;
  /// |stretch − 1| of each length.
  void strain(const double* x, const double* y, std::vector<double>& values) const;
  /// What tearing changes.
  void archive(class Archive& a);

 private:
  struct Length {
    std::uint32_t a, b;
    double rest, stiffness, given;
  };
  struct Angle {
    std::uint32_t a, b, c;
    double rest, stiffness, given;
  };
  struct Area {
    std::uint32_t a, b, c;
    double rest, stiffness, given;
  };
  std::vector<Length> lengths_;
  std::vector<Angle> angles_;
  std::vector<Area> areas_;
  double frequencySquared_ = 0.0;
  std::vector<double> flat_;
};

}  // namespace froude
