// One deformable body as its solver sees it: the definition, compiled.
#pragma once

#include <memory>
#include <vector>

#include <froude/solver/definitions.h>
#include <froude/solver/soft/links.h>
#include <froude/solver/soft/shape_clusters.h>
#include <froude/solver/soft/strain_elements.h>

namespace froude {

/// What of a body never changes, and what of it tears.
struct SoftBody {
  /// Throws Error for a definition that cannot work.
  explicit SoftBody(SoftDef definition);

  /// Is a triangle inside out, or does the mesh overlap itself around a point? No energy leads out of the latter. x, y:
  /// of the body's points. Cost: the triangles; angles where one is far from its shape.
  bool isTangled(const double* x, const double* y) const;
  /// Edges of the triangle whose piece of strain gave way.
  int tornEdges(std::size_t triangle) const;
  std::size_t tornTriangles() const;
  std::size_t points() const { return def.mesh->points.size(); }
  bool isStrain() const { return def.model == SoftModel::NeoHookean || def.model == SoftModel::StVenantKirchhoff; }
  StrainModel strainModel() const {
    return def.model == SoftModel::NeoHookean ? StrainModel::NeoHookean : StrainModel::StVenantKirchhoff;
  }

  SoftDef def;
  Lame lame;
  std::vector<double> mass, inverseMass;  // by point [kg/m], [m/kg]; inverse 0: pinned
  double totalMass = 0.0;                 // [kg/m]
  StrainElements elements;                // of the elastic models
  AlignedArray<double> before[3];         // their multipliers before a sweep, scratch
  Links links;                            // of springs and ropes
  ShapeClusters clusters;                 // of shape matching
  double matching = 0.0;                  // angular frequency² of its springs to the goals [1/s²]
  /// Edges on which the inner pressure presses, to their right: those of holes if there are any, else all.
  std::vector<std::array<std::uint32_t, 2>> inflated;
  double frequencySquared = 0.0;  // no angular frequency² of the body is above it [1/s²]
  bool anyPinned = false;
  bool tangled = false;  // at the start of the sub-step: see isTangled

 private:
  void compile();
  mutable std::vector<double> around_;  // work space of isTangled
};

}  // namespace froude
