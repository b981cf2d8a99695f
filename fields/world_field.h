// WorldField: all fixed polygons of a scene and the walls of its domain in one grid: one look-up, however many there
// are.
#pragma once

#include <array>
#include <span>
#include <vector>

#include <froude/base/api.h>
#include <froude/base/parallel.h>
#include <froude/fields/edge_grid.h>
#include <froude/fields/field_sample.h>
#include <froude/fields/polygon.h>
#include <froude/fields/sweep.h>

namespace froude {

/// A fixed polygon in the world.
struct PlacedPolygon {
  const Polygon* polygon = nullptr;  ///< read while the field is built, not kept
  Transform transform;
  std::int32_t body = 0;             ///< caller's number, handed back by queries; ≥ 0
  std::uint32_t group = 1;           ///< filter bits of this polygon
  std::uint32_t collidesWith = ~0u;  ///< groups that it stops
};

/// The domain. A closed side is solid beyond the box; an open or periodic side has no wall there.
struct DomainWalls {
  Box box;                                                 ///< [m]; empty: no domain, the polygons alone
  std::array<bool, 4> closed{false, false, false, false};  ///< left, right, bottom, top
};

/// Filter bits of what moves: it meets a polygon if each one's group is in the other's mask. Walls of the domain stop
/// all.
struct CollisionFilter {
  std::uint32_t group = 1;
  std::uint32_t collidesWith = ~0u;

  bool accepts(std::uint32_t otherGroup, std::uint32_t otherCollidesWith) const {
    return (group & otherCollidesWith) != 0 && (otherGroup & collidesWith) != 0;
  }
};

/// One edge in world coordinates; the solid is on the left of a → b.
struct FieldEdge {
  Vec2 a, b;            ///< [m]
  Vec2 normal;          ///< outward, unit
  std::int32_t body;    ///< −1: wall of the domain
  std::uint32_t index;  ///< in WorldField::edges()
};

struct WorldSample : FieldSample {
  std::int32_t body = -1;  ///< of the closest edge; −1 for a wall of the domain (or if not exact)
};

/// The union of the placed polygons and of what lies beyond closed walls. All points are in world coordinates [m].
/// Immutable; queries allocate nothing and may run on any number of threads.
class FROUDE_API WorldField {
 public:
  /// `band` [m] as in DistanceField; `cellSize` [m]: 0 chooses it, at most 4 million cells. The grid covers the domain
  /// grown by the band (without a domain: all polygons grown by the band). Throws Error unless band > 0 and finite.
  WorldField(std::span<const PlacedPolygon> polygons, const DomainWalls& walls, double band, double cellSize = 0.0);

  /// Exact for |distance| ≤ band: outside, distance to the union; inside, depth in the polygon in which p lies deepest
  /// (inside overlapping polygons that is less than the depth in their union). Outside the grid: exact, at O(edges).
  WorldSample sample(const Vec2& p) const;
  /// Exact everywhere. Cost far from every boundary: a search over rings of cells.
  WorldSample sampleExact(const Vec2& p) const;
  /// Only what `filter` accepts counts; exact for |distance| ≤ band.
  WorldSample sample(const Vec2& p, const CollisionFilter& filter) const;
  /// Never exceeds the signed distance of an outside point; not positive at inside points. Cost: one look-up.
  double lowerBound(const Vec2& p) const { return grid_.lowerBound(p); }
  /// Every edge within `radius` ≤ band of p, once, in increasing index. Precondition: p inside the grid.
  void forEachEdgeNear(const Vec2& p, double radius, FunctionRef<void(const FieldEdge&)> visit) const;
  /// Earliest hit of a disc (0 ≤ radius ≤ band) over all that the filter accepts, as `sweepDisc` in sweep.h. What lies
  /// outside the grid is not hit.
  SweepHit sweepDisc(const Vec2& from, const Vec2& to, double radius, const CollisionFilter& filter = {}) const;
  /// Number in `edges()` of an edge through which the straight piece from → to enters what the filter accepts, as
  /// `enteredEdge` in crossing.h; −1: none. Independent of `sweepDisc`.
  std::int32_t enteredEdge(const Vec2& from, const Vec2& to, const CollisionFilter& filter = {}) const;

  /// All edges: the walls' first, then polygon by polygon in the order given.
  std::span<const FieldEdge> edges() const { return edges_; }
  double band() const { return band_; }
  std::size_t memoryBytes() const;

  /// The cells, raw: cell (i, j) covers origin + [i, i+1] × [j, j+1] · cellSize and is number i + j · nx.
  const Vec2& gridOrigin() const { return grid_.origin(); }
  double cellSize() const { return grid_.cellSize(); }
  int nx() const { return grid_.nx(); }
  int ny() const { return grid_.ny(); }
  /// Per cell: no point of the cell is closer to a solid than this [m]. 0 where a boundary passes, negative deep
  /// inside. Nothing solid is within r of any point of a cell whose value exceeds r.
  std::span<const float> clearance() const { return grid_.clearance(); }
  /// The cells, for swept and batch queries.
  const detail::EdgeGrid& grid() const { return grid_; }

 private:
  struct Source {
    std::int32_t body;
    std::uint32_t group;
    std::uint32_t collidesWith;
  };
  bool accepts(const CollisionFilter& filter, std::uint32_t source) const;
  bool acceptsAll(const CollisionFilter& filter) const;
  WorldSample withBody(const FieldSample& sample) const;

  std::vector<FieldEdge> edges_;
  std::vector<Source> sources_;           // one a polygon, after the walls (source 0)
  std::vector<CollisionFilter> filters_;  // the different pairs of bits among the polygons
  double band_;
  detail::EdgeGrid grid_;
};

}  // namespace froude
