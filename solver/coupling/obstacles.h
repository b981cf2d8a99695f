// All that particles meet: the baked field of the walls and fixed polygons, and the moving polygons found by a coarse
// grid.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include <froude/base/aligned.h>
#include <froude/fields/cut_cells.h>
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

/// A straight piece of a particle's path through a sub-step.
struct PathPiece {
  Vec2 from{0, 0}, to{0, 0};      // [m]
  double begin = 0.0, end = 1.0;  // shares of the sub-step
  int carrier = -1;  // the body that carries the particle, in whose frame the piece is straight; −1: none
};

/// Obstacles of a world. `beginStep` once a sub-step, then any number of queries from any threads.
class Obstacles {
 public:
  /// reach [m]: distances are exact at least this far; not below the support radius and the largest particle radius.
  Obstacles(const DomainDef& domain, const BodySet& bodies, double reach);
  /// For bodies that came, went or were put elsewhere: as constructed anew, but fields that are the same are kept.
  /// Cost: that of the constructor for what is new, a comparison for the rest.
  void rebuild(const BodySet& bodies);
  /// Rises whenever the fixed obstacles have changed: what is kept of them elsewhere is to be made anew.
  std::uint64_t fixedVersion() const { return fixedVersion_; }

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

  /// The first boundary on the straight line from → to, with moving bodies at the end of the sub-step. Along periodic
  /// axes the copies of a body one period away are met too.
  struct RayHit {
    bool hit = false;
    double share = 1.0;  // of the line
    Vec2 point{0, 0};    // [m]
    Vec2 normal{0, 0};
    int body = -1;
    bool startedInside = false;
  };
  RayHit ray(const Vec2& from, const Vec2& to, const CollisionFilter& filter) const;

  /// Does a particle's centre enter an obstacle on this piece, seen in the obstacle's frame? By exact orientation, with
  /// no use of `sweep`; see leak_check.h. Cost: a look-up for a piece that the clearance of its start proves free.
  struct Entry {
    bool entered = false;
    int body = -1;  // −1: a wall of the domain
  };
  Entry entry(const PathPiece& piece, const CollisionFilter& filter) const;
  /// Is x inside of what the filter accepts, with moving bodies at the end of the sub-step? Exact; the boundary is not
  /// inside. Cost: a look-up for most places, else a distance query.
  bool inside(const Vec2& x, const CollisionFilter& filter) const;

  /// Velocity of a body's material (its belt left out) at x during the sub-step; 0 for the domain (−1) [m/s].
  Vec2 velocityAt(int body, const Vec2& x) const;

  /// What the body's belt adds to the velocity of its material where `normal` points out of it [m/s].
  Vec2 beltVelocity(int body, const Vec2& normal) const {
    return body < 0 ? Vec2(0.0, 0.0) : Vec2(surfaces_[static_cast<std::size_t>(body)].velocity * leftNormal(normal));
  }
  /// Where a point that moves with the body's material from x on, at the share t0 of the sub-step, is at its end [m].
  Vec2 carriedFrom(int body, const Vec2& x, double t0) const;
  /// Velocity of the surface that a particle at x feels, `normal` pointing from the surface to it: the material's and
  /// the belt's [m/s].
  Vec2 surfaceVelocityAt(int body, const Vec2& x, const Vec2& normal) const;
  /// Do fluids stick to the body's surface (−1: to the domain's walls)?
  bool sticks(int body) const {
    return body < 0 ? domain_.slip == Slip::NoSlip : surfaces_[static_cast<std::size_t>(body)].slip == Slip::NoSlip;
  }
  /// Is there any surface to which fluids stick?
  bool anySticks() const { return anySticks_; }

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
  /// Adds to `outlines` the fixed bodies that the filter accepts, or (`moving`) the moving ones as they stand at the
  /// start of the sub-step. Moments are about the body's origin, that of a free body about its centre of mass.
  void outlines(bool moving, const CollisionFilter& filter, std::vector<CutOutline>& outlines) const;
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
    std::shared_ptr<const Polygon> shape;
    std::shared_ptr<const DistanceField> field;
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

  // What a fixed body is baked from; equal ones make an equal field.
  struct Baked {
    std::shared_ptr<const Polygon> shape;
    Vec2 position;
    double angle;
    std::int32_t body;
    std::uint32_t group, collidesWith;
    bool operator==(const Baked&) const = default;
  };
  void bake(const std::vector<Baked>& fixed);

  DomainDef domain_;
  double band_;
  std::unique_ptr<WorldField> fixed_;
  std::vector<Baked> baked_;
  std::uint64_t fixedVersion_ = 0;
  struct Surface {
    double velocity, friction, restitution;
    int moving;  // index into moving_, −1 for a fixed body
    CollisionFilter filter;
    Slip slip;
  };
  void touch(ObstacleHit& hit, int body) const;

  std::vector<Surface> surfaces_;  // by body index
  std::vector<Moving> moving_;
  bool anySticks_ = false;
  double dt_ = 0.0;
  double reach_ = 0.0;
  // Coarse cells over the domain; each lists the moving bodies whose swept box, grown by the reach, touches it.
  Vec2 coarseOrigin_{0, 0};
  double coarseCell_ = 1.0;
  int coarseNx_ = 1, coarseNy_ = 1;
  AlignedArray<std::uint32_t> coarseStart_, coarseBodies_;
};

// x itself, and its images across the periodic sides that are nearer than the margin.
template <typename Visit>
void Obstacles::forEachImage(const Vec2& x, double margin, Visit&& visit) const {
  visit(Vec2(0.0, 0.0));
  const Vec2 period = domain_.box.size();
  auto shifts = [&](bool periodic, double at, double low, double high, double length) {
    if (!periodic) return 0.0;
    if (at - low < margin) return length;
    if (high - at < margin) return -length;
    return 0.0;
  };
  const double sx = shifts(domain_.periodicX, x.x(), domain_.box.min.x(), domain_.box.max.x(), period.x());
  const double sy = shifts(domain_.periodicY, x.y(), domain_.box.min.y(), domain_.box.max.y(), period.y());
  if (sx != 0.0) visit(Vec2(sx, 0.0));
  if (sy != 0.0) visit(Vec2(0.0, sy));
  if (sx != 0.0 && sy != 0.0) visit(Vec2(sx, sy));
}

/// visit(i) for every position i of [begin, end) to which a solid may be as near as reach(i) [m] during the sub-step.
/// Neighbours in memory should be neighbours in space: the look-up is made for a few at once.
template <typename Reach, typename Visit>
void forEachWithin(const Obstacles& obstacles, std::span<const double> x, std::span<const double> y, std::size_t begin,
                   std::size_t end, Reach&& reach, Visit&& visit) {
  constexpr std::size_t kTogether = 4;
  for (std::size_t first = begin; first < end; first += kTogether) {
    const std::size_t last = std::min(end, first + kTogether);
    double apart = 0.0, farthest = 0.0;
    for (std::size_t i = first; i < last; ++i) {
      const double ax = x[i] - x[first], ay = y[i] - y[first];
      apart = std::max(apart, ax * ax + ay * ay);
      farthest = std::max(farthest, reach(i));
    }
    if (obstacles.clearance({x[first], y[first]}) > std::sqrt(apart) + farthest) continue;
    for (std::size_t i = first; i < last; ++i) {
      if (obstacles.clearance({x[i], y[i]}) <= reach(i)) visit(i);
    }
  }
}

}  // namespace froude
