// Contact of points with the edges of soft bodies: soft against soft and itself, corners of polygons against soft
// edges.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <froude/fields/world_field.h>
#include <froude/particles/pool.h>
#include <froude/solver/coupling/edge_cells.h>
#include <froude/solver/rigid/body_set.h>
#include <froude/solver/soft/soft_body.h>

namespace froude {

/// Free bodies within a sub-step, as the contacts with soft bodies push them away from the motion that the rigid solver
/// found. To first order in the push.
class PushedBodies {
 public:
  void begin(const BodySet& bodies);
  /// What was pushed moves on for a part of dt [s].
  void advance(double dt);
  bool isFree(int body) const { return body >= 0 && states_[static_cast<std::size_t>(body)].inverseMass > 0.0; }
  /// How far the point x of the body is from where its motion brings it [m], and how much faster it is [m/s].
  /// `time` [s] since the start of the sub-step.
  Vec2 shiftAt(int body, const Vec2& x, double time) const;
  Vec2 velocityAt(int body, const Vec2& x, double time) const;
  /// Inverse of the mass that a push at x along n meets [m/kg].
  double inverseMassAt(int body, const Vec2& x, const Vec2& n, double time) const;
  /// A push of `amount` [kg·m] at x: an impulse of amount/dt, felt in the place at once.
  void push(int body, const Vec2& x, const Vec2& amount, double dt, double time);
  /// Adds the places to the motions of the sub-step; the velocities follow from the impulses.
  void store(BodySet& bodies, double dt) const;

 private:
  struct State {
    double inverseMass = 0.0, inverseInertia = 0.0;
    Vec2 center{0, 0}, motion{0, 0};  // of its mass at the start [m]; during the sub-step [m/s]
    Vec2 shift{0, 0}, velocity{0, 0};
    double turn = 0.0, spin = 0.0;
  };
  Vec2 arm(const State& s, const Vec2& x, double time) const { return x - s.center - time * s.motion; }
  std::vector<State> states_;
};

/// Work columns of all bodies, with the points' places at the start of the part.
struct SoftColumns {
  double* x = nullptr;  // [m]
  double* y = nullptr;
  const double* fromX = nullptr;
  const double* fromY = nullptr;
  const double* vx = nullptr;  // [m/s]
  const double* vy = nullptr;
  const double* inverseMass = nullptr;  // [m/kg]
};

/// The fluid that meets soft bodies: its particles are where the sub-step brought them.
struct MetFluid {
  ParticlePool* pool = nullptr;
  double inverseMass = 0.0, radius = 0.0;  // of a particle [m/kg], [m]
  CollisionFilter filter;
  bool feelsWalls = false;  // its pressure knows solids' outlines: they are met at distance 0, as polygons are
};

/// `body` of a touch by a particle of fluid: the impulse stays among what the accounts are about.
inline constexpr int kByFluid = -2;

/// A point and an edge that met, as the obstacle's owner feels it.
struct PairTouch {
  int body;  // of the polygon, −1: none
  std::uint32_t soft;
  Vec2 at, impulse, surface;
};

/// Which points may meet which edges in a sub-step, and what becomes of them in each part. Edges of solids push
/// outwards, those of ropes away from themselves; half an edge deep at most, or it is another side that is meant.
/// Sequential and in a fixed order, so that the bits do not depend on threads. No allocation once the lists have grown.
class SoftPairs {
 public:
  /// Anew when a body was added; `offset`: of its points in the columns.
  void add(const SoftBody& body, std::size_t offset);
  /// The pairs that come near each other within dt [s].
  void find(std::span<const std::unique_ptr<SoftBody>> softs, const SoftColumns& columns, const BodySet& bodies,
            const MetFluid* fluid, double dt);
  /// What fluid particles were pushed moves on for a part of dt [s].
  void advanceFluid(double dt);
  /// Gives the fluid's particles what they were pushed: places and velocities.
  void storeFluid(const MetFluid& fluid) const;
  /// Parts what overlaps at the end of the part [begin, end] [s since the start of the sub-step].
  void resolve(const SoftColumns& columns, const BodySet& bodies, PushedBodies& pushed, double begin, double end,
               std::vector<PairTouch>& touches);
  std::size_t pairCount() const { return pairs_.size(); }

 private:
  struct Point {
    std::uint32_t node, soft;  // in the columns
    double radius, friction;
    std::uint32_t group, collidesWith;
  };
  struct Edge {
    std::uint32_t a, b, soft;
    std::uint32_t next, previous;  // round the ring
    double radius, friction, length;
    bool twoSided;
    std::uint32_t group, collidesWith;
  };
  struct Corner {
    int body;
    Vec2 local;
    double friction;
  };
  struct Drop {
    std::uint32_t index;   // in the fluid's pool
    Vec2 start, velocity;  // over the sub-step [m], [m/s]
    Vec2 push, gain;       // since its start [m], [m/s]
  };
  struct Pair {
    std::uint32_t point, edge;  // point: beyond the points, of a corner; beyond them, of a drop
  };
  // How a point or corner stands to an edge at the end of a part.
  struct Overlap {
    std::uint32_t edge;
    double share, depth;  // along the edge; that the two overlap by [m]
    Vec2 normal;
  };
  // Where the point of a pair is, and was at the start of the part.
  struct Place {
    Vec2 x, from;
    double radius, friction, inverseMass;
    int body;            // of a corner; −1: a point of a soft body
    std::uint32_t node;  // of a point; of a drop its number
  };
  Place placeOf(std::uint32_t point, const SoftColumns& columns, const BodySet& bodies, const PushedBodies& pushed,
                double begin, double end) const;
  bool overlaps(const Place& place, const Edge& edge, const SoftColumns& columns, Overlap& overlap) const;
  void part(const Place& place, const Overlap& overlap, const SoftColumns& columns, PushedBodies& pushed, double dt,
            double end, std::vector<PairTouch>& touches);
  void sortEdges(const SoftColumns& columns, double dt);
  void findCorners(std::span<const std::unique_ptr<SoftBody>> softs, const BodySet& bodies, double dt);
  bool areNeighbours(std::span<const std::unique_ptr<SoftBody>> softs, const Point& p, const Edge& e) const;

  std::vector<Point> points_;
  std::vector<Edge> edges_;
  std::vector<std::size_t> offsets_;
  std::vector<Corner> corners_;
  std::vector<Drop> drops_;
  MetFluid fluid_;
  std::vector<Pair> pairs_;
  EdgeCells cells_;
  double dt_ = 0.0;             // of the part [s]
  std::vector<double> travel_;  // of an edge in the sub-step [m]
  std::vector<Vec2> ends_;      // of the edges, two each [m]
};

}  // namespace froude
