#include <froude/solver/soft/soft_pairs.h>

#include <algorithm>
#include <array>
#include <cmath>

#include <froude/fields/world_field.h>

namespace froude {
namespace {

constexpr double kDeepest = 0.5;    // of an edge's length
constexpr double kAhead = 1.1;      // of the sub-step: a part more than it may last
constexpr double kWayOut = 5.0;     // edge lengths in a second
constexpr double kNeighbour = 1.5;  // edge lengths apart at rest, or nearer: no contact of a body with itself
constexpr double kSlack = 1.5;      // of the way that a point goes at its speed

double distanceToSegment(const Vec2& p, const Vec2& a, const Vec2& b) {
  const Vec2 along = b - a;
  const double share = std::clamp((p - a).dot(along) / std::max(along.squaredNorm(), 1e-300), 0.0, 1.0);
  return (p - a - share * along).norm();
}

Vec2 at(const double* x, const double* y, std::uint32_t i) { return {x[i], y[i]}; }

}  // namespace

void PushedBodies::begin(const BodySet& bodies) {
  states_.assign(bodies.size(), {});
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (!bodies.isFree(i)) continue;
    State& s = states_[i];
    s.inverseMass = bodies.mass(i).inverseMass;
    s.inverseInertia = bodies.mass(i).inverseInertia;
    s.center = bodies.motion(i).position;
    s.motion = bodies.motion(i).velocity;
  }
}

void PushedBodies::advance(double dt) {
  for (State& s : states_) {
    s.shift += dt * s.velocity;
    s.turn += dt * s.spin;
  }
}

Vec2 PushedBodies::shiftAt(int body, const Vec2& x, double time) const {
  if (!isFree(body)) return {0.0, 0.0};
  const State& s = states_[static_cast<std::size_t>(body)];
  return s.shift + cross(s.turn, arm(s, x, time));
}

Vec2 PushedBodies::velocityAt(int body, const Vec2& x, double time) const {
  if (!isFree(body)) return {0.0, 0.0};
  const State& s = states_[static_cast<std::size_t>(body)];
  return s.velocity + cross(s.spin, arm(s, x, time));
}

double PushedBodies::inverseMassAt(int body, const Vec2& x, const Vec2& n, double time) const {
  if (!isFree(body)) return 0.0;
  const State& s = states_[static_cast<std::size_t>(body)];
  const double lever = cross(arm(s, x, time), n);
  return s.inverseMass + lever * lever * s.inverseInertia;
}

void PushedBodies::push(int body, const Vec2& x, const Vec2& amount, double dt, double time) {
  if (!isFree(body)) return;
  State& s = states_[static_cast<std::size_t>(body)];
  const double turn = s.inverseInertia * cross(arm(s, x, time), amount);
  s.shift += s.inverseMass * amount;
  s.velocity += s.inverseMass / dt * amount;
  s.turn += turn;
  s.spin += turn / dt;
}

void PushedBodies::store(BodySet& bodies, double dt) const {
  for (std::size_t i = 0; i < states_.size(); ++i) {
    const State& s = states_[i];
    if (s.inverseMass == 0.0 || (s.shift == Vec2(0.0, 0.0) && s.turn == 0.0)) continue;
    const BodyMotion& m = bodies.motion(i);
    bodies.setMotion(i, m.velocity + s.shift / dt, m.spin + s.turn / dt);
  }
}

void SoftPairs::add(const SoftBody& body, std::size_t offset) {
  const SoftDef& d = body.def;
  const auto soft = static_cast<std::uint32_t>(offsets_.size());
  offsets_.push_back(offset);
  const auto base = static_cast<std::uint32_t>(offset);
  const bool rope = d.model == SoftModel::Rope;
  const double radius = rope ? 0.5 * d.thickness : 0.0;
  std::vector<std::uint32_t> nodes;
  const std::size_t firstEdge = edges_.size();
  auto addEdge = [&](std::uint32_t a, std::uint32_t b) {
    const double length = (d.mesh->points[b] - d.mesh->points[a]).norm();
    edges_.push_back({base + a, base + b, soft, 0, 0, radius, d.friction, length, rope, d.group, d.collidesWith});
    nodes.push_back(a);
    nodes.push_back(b);
  };
  if (rope) {
    for (std::uint32_t k = 0; k + 1 < d.mesh->points.size(); ++k) addEdge(k, k + 1);
  } else {
    for (const auto& e : d.mesh->outline) addEdge(e[0], e[1]);
  }
  for (std::size_t e = firstEdge; e < edges_.size(); ++e) {
    for (std::size_t other = firstEdge; other < edges_.size(); ++other) {
      if (edges_[other].a != edges_[e].b) continue;
      edges_[e].next = static_cast<std::uint32_t>(other);
      edges_[other].previous = static_cast<std::uint32_t>(e);
    }
  }
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  for (const std::uint32_t k : nodes) {
    points_.push_back({base + k, soft, radius, d.friction, d.group, d.collidesWith});
  }
  travel_.resize(edges_.size());
  ends_.resize(2 * edges_.size());
}

void SoftPairs::sortEdges(const SoftColumns& c, double dt) {
  double reach = 0.0;
  for (std::size_t e = 0; e < edges_.size(); ++e) {
    const Edge& edge = edges_[e];
    const Vec2 a = ends_[2 * e] = at(c.x, c.y, edge.a), b = ends_[2 * e + 1] = at(c.x, c.y, edge.b);
    const double fastest = std::max(at(c.vx, c.vy, edge.a).squaredNorm(), at(c.vx, c.vy, edge.b).squaredNorm());
    travel_[e] = kSlack * dt * std::sqrt(fastest) + 0.25 * edge.length + edge.radius;
    reach = std::max(reach, travel_[e] + 0.5 * (b - a).norm());
  }
  cells_.build(ends_, reach);
}

bool SoftPairs::areNeighbours(std::span<const std::unique_ptr<SoftBody>> softs, const Point& p, const Edge& e) const {
  const auto base = static_cast<std::uint32_t>(offsets_[p.soft]);
  const auto& rest = softs[p.soft]->def.mesh->points;
  return distanceToSegment(rest[p.node - base], rest[e.a - base], rest[e.b - base]) < kNeighbour * e.length;
}

// Convex corners of polygons within reach of any edge.
void SoftPairs::findCorners(std::span<const std::unique_ptr<SoftBody>> softs, const BodySet& bodies, double dt) {
  corners_.clear();
  std::uint32_t groups = 0, accepts = 0;
  for (const auto& soft : softs) {
    groups |= soft->def.group;
    accepts |= soft->def.collidesWith;
  }
  const Box reach = cells_.box().grown(cells_.cell());
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const BodyDef& def = bodies.definition(i);
    if ((accepts & def.group) == 0 || (def.collidesWith & groups) == 0) continue;
    const BodyMotion& m = bodies.motion(i);
    const double travel = dt * (m.velocity.norm() + std::abs(m.spin) * bodies.radius(i));
    if (!reach.grown(bodies.radius(i) + travel).contains(m.position)) continue;
    const Transform pose = m.transform();
    const Polygon& polygon = *bodies.shape(i);
    for (std::uint32_t v = 0; v < polygon.edgeCount(); ++v) {
      if (!polygon.convexAt(v) || !reach.grown(travel).contains(pose.toWorld(polygon.edgeStart(v)))) continue;
      corners_.push_back({static_cast<int>(i), polygon.edgeStart(v), def.friction});
    }
  }
}

void SoftPairs::find(std::span<const std::unique_ptr<SoftBody>> softs, const SoftColumns& c, const BodySet& bodies,
                     const MetFluid* fluid, double duration) {
  const double dt = kAhead * duration;
  pairs_.clear();
  drops_.clear();
  if (edges_.empty()) return;
  sortEdges(c, dt);
  findCorners(softs, bodies, dt);
  auto consider = [&](std::uint32_t number, const Vec2& x, double reach, auto&& skips) {
    cells_.forEachNear(x, reach, [&](std::uint32_t e) {
      const Edge& edge = edges_[e];
      if (skips(edge)) return;
      if (distanceToSegment(x, at(c.x, c.y, edge.a), at(c.x, c.y, edge.b)) > reach + travel_[e]) return;
      pairs_.push_back({number, e});
    });
  };
  for (std::uint32_t k = 0; k < points_.size(); ++k) {
    const Point& p = points_[k];
    const double reach = p.radius + kSlack * dt * at(c.vx, c.vy, p.node).norm();
    consider(k, at(c.x, c.y, p.node), reach, [&](const Edge& e) {
      if (e.soft == p.soft) {
        return softs[p.soft]->tangled || e.a == p.node || e.b == p.node || areNeighbours(softs, p, e);
      }
      return !CollisionFilter{p.group, p.collidesWith}.accepts(e.group, e.collidesWith);
    });
  }
  for (std::uint32_t k = 0; k < corners_.size(); ++k) {
    const Corner& corner = corners_[k];
    const BodyMotion& m = bodies.motion(static_cast<std::size_t>(corner.body));
    const BodyDef& def = bodies.definition(static_cast<std::size_t>(corner.body));
    const Vec2 x = m.transform().toWorld(corner.local);
    const double reach = kSlack * dt * (m.velocity + cross(m.spin, Vec2(x - m.position))).norm();
    consider(static_cast<std::uint32_t>(points_.size()) + k, x, reach, [&](const Edge& e) {
      if (c.inverseMass[e.a] == 0.0 || c.inverseMass[e.b] == 0.0) return true;  // where it is held, it may pass through
      return !CollisionFilter{e.group, e.collidesWith}.accepts(def.group, def.collidesWith);
    });
  }
  if (fluid == nullptr) return;
  fluid_ = *fluid;
  const Box reach = cells_.box().grown(cells_.cell() + fluid->radius);
  const auto x = fluid->pool->x(), y = fluid->pool->y(), vx = fluid->pool->vx(), vy = fluid->pool->vy();
  const auto first = static_cast<std::uint32_t>(points_.size() + corners_.size());
  for (std::uint32_t k = 0; k < x.size(); ++k) {
    const Vec2 end(x[k], y[k]), v(vx[k], vy[k]);
    if (!reach.contains(end)) continue;
    const std::size_t before = pairs_.size();
    consider(first + static_cast<std::uint32_t>(drops_.size()), end, fluid->radius + kSlack * dt * v.norm(),
             [&](const Edge& e) { return !fluid->filter.accepts(e.group, e.collidesWith); });
    if (pairs_.size() > before) drops_.push_back({k, end - duration * v, v, {0.0, 0.0}, {0.0, 0.0}});
  }
}

void SoftPairs::advanceFluid(double dt) {
  for (Drop& d : drops_) d.push += dt * d.gain;
}

void SoftPairs::storeFluid(const MetFluid& fluid) const {
  for (const Drop& d : drops_) {
    fluid.pool->x()[d.index] += d.push.x();
    fluid.pool->y()[d.index] += d.push.y();
    fluid.pool->vx()[d.index] += d.gain.x();
    fluid.pool->vy()[d.index] += d.gain.y();
  }
}

SoftPairs::Place SoftPairs::placeOf(std::uint32_t number, const SoftColumns& c, const BodySet& bodies,
                                    const PushedBodies& pushed, double begin, double end) const {
  if (number < points_.size()) {
    const Point& p = points_[number];
    return {
        at(c.x, c.y, p.node), at(c.fromX, c.fromY, p.node), p.radius, p.friction, c.inverseMass[p.node], -1, p.node};
  }
  number -= static_cast<std::uint32_t>(points_.size());
  if (number >= corners_.size()) {
    number -= static_cast<std::uint32_t>(corners_.size());
    const Drop& d = drops_[number];
    return {d.start + end * d.velocity + d.push,
            d.start + begin * d.velocity + d.push - (end - begin) * d.gain,
            fluid_.radius,
            0.0,
            fluid_.inverseMass,
            kByFluid,
            number};
  }
  const Corner& corner = corners_[number];
  const BodyMotion& m = bodies.motion(static_cast<std::size_t>(corner.body));
  Place place{{0.0, 0.0}, {0.0, 0.0}, 0.0, corner.friction, 0.0, corner.body, 0};
  place.x = Transform::of(m.position + end * m.velocity, m.angle + end * m.spin).toWorld(corner.local);
  place.from = Transform::of(m.position + begin * m.velocity, m.angle + begin * m.spin).toWorld(corner.local);
  const Vec2 shift = pushed.shiftAt(corner.body, place.x, end);
  place.from += shift - (end - begin) * pushed.velocityAt(corner.body, place.x, end);
  place.x += shift;
  return place;
}

bool SoftPairs::overlaps(const Place& place, const Edge& e, const SoftColumns& c, Overlap& o) const {
  const Vec2 a = at(c.x, c.y, e.a), along = at(c.x, c.y, e.b) - a;
  const bool pressed = place.body == kByFluid && fluid_.feelsWalls && !e.twoSided;
  const double square = along.squaredNorm(), radius = e.radius + (pressed ? 0.0 : place.radius);
  if (!(square > 0.0)) return false;
  o.share = (place.x - a).dot(along) / square;
  if (e.twoSided) {
    o.share = std::clamp(o.share, 0.0, 1.0);
    const Vec2 away = place.x - a - o.share * along;
    const double distance = away.norm();
    o.depth = radius - distance;
    o.normal = away / distance;
    return o.depth > 0.0 && distance > 0.0;
  }
  o.normal = rightNormal(along) / std::sqrt(square);
  double inside = -(place.x - a).dot(o.normal);
  if (!(inside > -radius)) return false;
  if (o.share < 0.0 || o.share > 1.0) {
    // Beyond its end the edge speaks for a point inside of a reflex corner alone, which no edge has above it.
    const bool after = o.share > 1.0;
    const Edge& other = edges_[after ? e.next : e.previous];
    const Vec2 onwards = at(c.x, c.y, other.b) - at(c.x, c.y, other.a);
    const double turn = after ? cross(along, onwards) : cross(onwards, along);
    if (turn >= 0.0 || inside <= 0.0) return false;
    o.share = after ? 1.0 : 0.0;
    const Vec2 away = at(c.x, c.y, after ? e.b : e.a) - place.x;
    inside = away.norm();
    if (!(inside > 0.0)) return false;
    o.normal = away / inside;
  }
  o.depth = radius + inside;
  if (!(o.depth > 0.0) || inside > kDeepest * e.length) return false;
  // What was inside before comes out slowly: it may have come to this edge from the side.
  const Vec2 startA = at(c.fromX, c.fromY, e.a), startB = at(c.fromX, c.fromY, e.b);
  const double before = radius - (place.from - (1.0 - o.share) * startA - o.share * startB).dot(o.normal);
  o.depth = std::min(o.depth, std::max(0.0, o.depth - std::max(0.0, before)) + kWayOut * e.length * dt_);
  return true;
}

void SoftPairs::part(const Place& place, const Overlap& o, const SoftColumns& c, PushedBodies& pushed, double dt,
                     double end, std::vector<PairTouch>& touches) {
  const Edge& e = edges_[o.edge];
  const double wa = (1.0 - o.share) * c.inverseMass[e.a], wb = o.share * c.inverseMass[e.b];
  auto weightAlong = [&](const Vec2& n) {
    return (1.0 - o.share) * wa + o.share * wb + place.inverseMass + pushed.inverseMassAt(place.body, place.x, n, end);
  };
  const double weight = weightAlong(o.normal);
  if (!(weight > 0.0)) return;
  const double normal = o.depth / weight;  // [kg·m]
  Vec2 amount = normal * o.normal;
  const Vec2 movedA = at(c.x, c.y, e.a) - at(c.fromX, c.fromY, e.a);
  const Vec2 movedB = at(c.x, c.y, e.b) - at(c.fromX, c.fromY, e.b);
  const Vec2 moved = place.x - place.from - (1.0 - o.share) * movedA - o.share * movedB;
  const Vec2 slip = moved - moved.dot(o.normal) * o.normal;
  const double length = slip.norm(), friction = std::sqrt(place.friction * e.friction);
  if (length > 0.0 && friction > 0.0) {
    const Vec2 direction = slip / length;
    amount -= std::min(friction * normal, length / weightAlong(direction)) * direction;
  }
  c.x[e.a] -= wa * amount.x();
  c.y[e.a] -= wa * amount.y();
  c.x[e.b] -= wb * amount.x();
  c.y[e.b] -= wb * amount.y();
  if (place.body == kByFluid) {
    Drop& d = drops_[place.node];
    d.push += place.inverseMass * amount;
    d.gain += place.inverseMass / dt * amount;
    touches.push_back({kByFluid, e.soft, place.x, amount / dt, {0.0, 0.0}});
  } else if (place.body < 0) {
    c.x[place.node] += place.inverseMass * amount.x();
    c.y[place.node] += place.inverseMass * amount.y();
  } else {
    touches.push_back({place.body, e.soft, place.x, amount / dt, (place.x - place.from) / dt});
    pushed.push(place.body, place.x, amount, dt, end);
  }
}

// Near a corner of a solid a point is within several of its edges; the nearest is where it came in.
void SoftPairs::resolve(const SoftColumns& c, const BodySet& bodies, PushedBodies& pushed, double begin, double end,
                        std::vector<PairTouch>& touches) {
  constexpr std::size_t kMost = 8;
  dt_ = end - begin;
  std::array<Overlap, kMost> found;
  for (std::size_t i = 0, next = 0; i < pairs_.size(); i = next) {
    const std::uint32_t point = pairs_[i].point;
    const Place place = placeOf(point, c, bodies, pushed, begin, end);
    std::size_t count = 0;
    for (next = i; next < pairs_.size() && pairs_[next].point == point; ++next) {
      Overlap o{pairs_[next].edge, 0.0, 0.0, {0.0, 0.0}};
      const Edge& edge = edges_[o.edge];
      if (!overlaps(place, edge, c, o)) continue;
      std::size_t same = 0;
      while (same < count && (edge.twoSided || edges_[found[same].edge].soft != edge.soft)) ++same;
      if (same < count) {
        if (o.depth < found[same].depth) found[same] = o;
      } else if (count < kMost) {
        found[count++] = o;
      }
    }
    for (std::size_t k = 0; k < count; ++k) {
      const Place now = k == 0 ? place : placeOf(point, c, bodies, pushed, begin, end);
      if (k > 0 && !overlaps(now, edges_[found[k].edge], c, found[k])) continue;
      part(now, found[k], c, pushed, end - begin, end, touches);
    }
  }
}

}  // namespace froude
