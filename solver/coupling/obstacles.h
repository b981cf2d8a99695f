// All that particles meet: the baked field of the walls and fixed polygons, and the moving polygons found by a coarse
// grid.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include <froude/base/aligned.h>
#include <froude/fields/distance_field.h>
#include <froude/fields/world_field.h>
#include <froude/solver/fluid/wall_integral.h>
#include <froude/solver/rigid/body_set.h>

namespace froude {

/// Where and what a moving disc touches first.
struct ObstacleHit {
  bool hit = false;
  double time = 1.0;           // fraction of the step
  Vec2 center{0, 0};           // of the disc at that time [m]
  Vec2 normal{0, 0};           // outward from the obstacle
  Vec2 surfaceVelocity{0, 0};  // of the obstacle's material there, conveyor motion included [m/s]
  int body = -1;               // −1: a wall of the domain
  double friction = 0.0;       // of the body; a wall of the domain has none
  double restitution = 0.0;
  bool startedInside = false;
};

/// Obstacles of a world. `beginStep` once a sub-step, then any number of queries from any threads.
class Obstacles {
 public:
  /// reach [m]: distances are exact at least this far; not below the support radius and the largest particle radius.
  Obstacles(const DomainDef& domain, const BodySet& bodies, double reach);

  /// Poses at the start of the sub-step and their motion during dt [s]. `reach` [m]: no query of this sub-step looks
  /// farther than this beyond a moving body. Cost: moving bodies × cells that they sweep; nothing if none moves.
  void beginStep(const BodySet& bodies, double dt, double reach);

  /// No solid is nearer to x than this at any time of the sub-step [m]; ≤ 0 says nothing. Cost: one or two look-ups.
  double clearance(const Vec2& x) const;

  /// As `clearance`, but exact within the band for fixed obstacles (for moving ones: their swept boxes). Cost: one
  /// distance query.
  double freeDistance(const Vec2& x, const CollisionFilter& filter) const;

  /// First touch of a disc going straight from → to in the share [t0, 1] of the sub-step. `filter` as for bodies.
  ObstacleHit sweep(const Vec2& from, const Vec2& to, double t0, double radius, const CollisionFilter& filter) const;

  /// Edges within `radius` of x with the moving bodies at the end of the sub-step, relative to x and divided by `unit`
  /// [m]. At most kMaxWallEdges, the first found; returns how many.
  std::size_t edgesNear(const Vec2& x, double radius, double unit, const CollisionFilter& filter,
                        std::span<WallEdge> edges) const;

  /// Signed distance with moving bodies at the end of the sub-step (start of the next) [m]; exact within the band.
  struct Distance {
    double distance = kInfinity;
    Vec2 normal{0, 0};
    int body = -1;
  };
  Distance distance(const Vec2& x, const CollisionFilter& filter) const;

  /// Velocity of a body's material (its belt left out) at x during the sub-step; 0 for the domain (−1) [m/s].
  Vec2 velocityAt(int body, const Vec2& x) const;

  bool anyMoving() const { return !moving_.empty(); }

  /// What a map of free space is made of (free_map.h). Tiles are squares over the domain; a moving body that is not
  /// listed in a tile stays farther than `reach` from all of its points during the sub-step.
  struct Tiles {
    Vec2 origin{0, 0};  // [m]
    double size = 1.0;  // [m]
    int nx = 1, ny = 1;
  };
  Tiles tiles() const { return {coarseOrigin_, coarseCell_, coarseNx_, coarseNy_}; }
  std::span<const std::uint32_t> movingIn(int tileX, int tileY) const {
    const auto c = static_cast<std::size_t>(tileY * coarseNx_ + tileX);
    return {coarseBodies_.data() + coarseStart_[c], coarseStart_[c + 1] - coarseStart_[c]};
  }
  double reach() const { return reach_; }
  /// Never above the distance of x to fixed obstacles that the filter accepts, images across periodic sides left out;
  /// not positive inside [m].
  double fixedBound(const Vec2& x, const CollisionFilter& filter) const { return fixed_->sample(x, filter).distance; }
  /// The same for moving body `k` of `movingIn` at every time of the sub-step.
  double movingBound(std::uint32_t k, const Vec2& x, const CollisionFilter& filter) const;
  /// Largest coordinate in play [m].
  double scale() const { return domain_.box.min.cwiseAbs().cwiseMax(domain_.box.max.cwiseAbs()).maxCoeff(); }

  const DomainDef& domain() const { return domain_; }
  std::size_t memoryBytes() const;

 private:
  struct Moving {
    int body;
    std::unique_ptr<DistanceField> field;
    RigidMotion motion;
    Transform end;
    Box swept;           // the body's box over the sub-step [m]
    Transform middle;    // pose at half of the sub-step
    double stray = 0.0;  // no point of the body is ever farther than this from where it is at half of it [m]
    std::uint32_t group, collidesWith;
  };
  std::span<const std::uint32_t> movingNear(const Vec2& x) const;
  double movingClearance(const Vec2& x) const;
  void sweepMoving(const Vec2& from, const Vec2& to, double t0, double radius, const CollisionFilter& filter,
                   ObstacleHit& best) const;
  bool acceptsBody(int body, const CollisionFilter& filter) const {
    const auto b = static_cast<std::size_t>(body);
    return filter.accepts(surfaces_[b].filter.group, surfaces_[b].filter.collidesWith);
  }
  template <typename Visit>
  void forEachImage(const Vec2& x, double margin, Visit&& visit) const;

  DomainDef domain_;
  std::unique_ptr<WorldField> fixed_;
  struct Surface {
    double velocity, friction, restitution;
    int moving;  // index into moving_, −1 for a fixed body
    CollisionFilter filter;
  };
  void touch(ObstacleHit& hit, int body) const;

  std::vector<Surface> surfaces_;  // by body index
  std::vector<Moving> moving_;
  double dt_ = 0.0;
  double reach_ = 0.0;
  // Coarse cells over the domain; each lists the moving bodies whose swept box, grown by the reach, touches it.
  Vec2 coarseOrigin_{0, 0};
  double coarseCell_ = 1.0;
  int coarseNx_ = 1, coarseNy_ = 1;
  AlignedArray<std::uint32_t> coarseStart_, coarseBodies_;
};

}  // namespace froude
