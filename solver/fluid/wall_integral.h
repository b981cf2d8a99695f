// The share of a particle's kernel that walls fill, exact for polygons: no boundary particles, no sampled map.
//
// From a point x outside all solids, every direction θ first meets a wall at some radius r₁(θ) or none. What lies
// behind is solid or hidden by it, so that the two sides of a thin plate do not feel each other. Then
//     λ(x)  = ∫_behind W  = Σ_edges ∫ (1/2π − G(r)) dθ,   G(r) = ∫₀^r W s ds
//     g(x)  = ∫_behind ∇ₓW = −∮_∂behind W n ds            (walls seen, and the shadow lines behind their ends)
// Each visible piece of an edge gives one wedge with a closed form (polynomials and one arc tangent an end).
// Semi-analytical walls: Ferrand et al., Int. J. Numer. Methods Fluids 71 (2013); volume maps: Bender et al., SIGGRAPH
// MIG 2019.
#pragma once

#include <span>

#include <froude/base/types.h>
#include <froude/solver/fluid/kernel.h>

namespace froude {

/// A wall edge relative to the particle, in spacings; the solid lies left of a → b, as on a polygon's outline.
struct WallEdge {
  Vec2 a, b;
  int owner = -1;  // of whom the force is: body index, −1 for the domain
};

/// λ and g of the part of the walls that belongs to one owner; λ has no unit, g is in 1/dx.
struct WallShare {
  int owner = -1;
  double lambda = 0.0;
  Vec2 gradient{0.0, 0.0};
};

/// Largest number of edges that may lie within the support radius of one particle; more are an overflow that the caller
/// reports (it raises no error: the nearest ones are kept).
inline constexpr std::size_t kMaxWallEdges = 64;

/// Integrates the walls seen from the origin. `edges` are all edges within the support radius, front- or back-facing,
/// at most kMaxWallEdges. Writes one share per owner, in order of first appearance, to `shares` (room for edges.size())
/// and returns their number. Cost: O(k) for k front-facing edges that do not hide one another, O(k²) otherwise.
/// Accuracy: closed forms in double, 1e-13 of λ.
std::size_t integrateWalls(std::span<const WallEdge> edges, std::span<WallShare> shares,
                           kernel::Kind kind = kernel::Kind::Blend);

/// The same of the solids alone: what they hide is not counted. All edges within the support radius, faces that look
/// away too; where solids overlap, both count. Cost: O(k). Accuracy as above.
std::size_t integrateSolids(std::span<const WallEdge> edges, std::span<WallShare> shares,
                            kernel::Kind kind = kernel::Kind::Blend);

/// Is there a solid so thin that the fluid behind it must be hidden? Edges as above. Thin is a solid whose opposite
/// faces are nearer than the support radius, or a corner sharper than 40 degrees; also solids of two owners that cross.
bool anyThin(std::span<const WallEdge> edges);

/// Does the segment from the origin to `p` go through a thin solid: in at one face and out at one that looks the other
/// way, but for 40 degrees? From either of its ends the answer is the same.
bool hiddenByThin(std::span<const WallEdge> edges, const Vec2& p);

/// λ and −dλ/dd of a half-plane at signed distance d spacings from its edge (d > 0 outside), from a table of cubic
/// interpolation; error below 1e-9 (tested). Outside |d| < 2: 0 or 1. Of the kernel Blend.
struct HalfPlane {
  double lambda;
  double slope;  // −dλ/dd ≥ 0
};
HalfPlane halfPlane(double distance);
/// λ of the same by the closed form, of either kernel.
double halfPlaneShare(double distance, kernel::Kind kind);

/// True if the segment from the origin to `p` crosses the edge (touching an end counts as crossing).
inline bool hidesPoint(const WallEdge& e, const Vec2& p) {
  const Vec2 along = e.b - e.a;
  const double sideOfOrigin = cross(along, -e.a);
  const double sideOfPoint = cross(along, p - e.a);
  if ((sideOfOrigin > 0.0) == (sideOfPoint > 0.0)) return false;
  const double ca = cross(p, e.a);
  const double cb = cross(p, e.b);
  return (ca >= 0.0 && cb <= 0.0) || (ca <= 0.0 && cb >= 0.0);
}

}  // namespace froude
