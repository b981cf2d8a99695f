#include <froude/solver/coupling/obstacles.h>

namespace froude {
namespace {

constexpr int kCoarseCells =
    64;  // along the longer side of the domain: enough to part bodies, cheap to rebuild each step
// A narrower band makes more cells than caches hold: small bullets in a large domain met them at 550 ns a look.
constexpr double kBandsAcross = 256.0;

}  // namespace

Obstacles::Obstacles(const DomainDef& domain, const BodySet& bodies, double reach)
    : domain_(domain), band_(std::max(reach, domain.box.size().maxCoeff() / kBandsAcross)) {
  const Vec2 size = domain.box.size();
  coarseCell_ = std::max(size.x(), size.y()) / kCoarseCells;
  coarseOrigin_ = domain.box.min;
  coarseNx_ = std::max(1, static_cast<int>(std::ceil(size.x() / coarseCell_)));
  coarseNy_ = std::max(1, static_cast<int>(std::ceil(size.y() / coarseCell_)));
  coarseStart_.resize(static_cast<std::size_t>(coarseNx_ * coarseNy_) + 1);
  rebuild(bodies);
}

void Obstacles::rebuild(const BodySet& bodies) {
  std::vector<Baked> fixed;
  std::vector<Moving> before = std::move(moving_);
  moving_.clear();
  surfaces_.clear();
  auto fieldOf = [&](const std::shared_ptr<const Polygon>& shape) {
    for (const std::vector<Moving>* known : {&before, &moving_}) {
      for (const Moving& m : *known) {
        if (m.shape == shape) return m.field;
      }
    }
    return std::make_shared<const DistanceField>(*shape, band_);
  };
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const BodyDef& def = bodies.definition(i);
    const BodyMotion& motion = bodies.motion(i);
    surfaces_.push_back({def.surfaceVelocity,
                         def.friction,
                         def.restitution,
                         bodies.moves(i) ? static_cast<int>(moving_.size()) : -1,
                         {def.group, def.collidesWith},
                         def.slip.value_or(domain_.slip)});
    const auto number = static_cast<std::int32_t>(i);
    if (bodies.moves(i)) {
      moving_.push_back({number,
                         bodies.shape(i),
                         fieldOf(bodies.shape(i)),
                         {},
                         motion.transform(),
                         {},
                         motion.transform(),
                         0.0,
                         def.group,
                         def.collidesWith});
    } else {
      fixed.push_back({def.shape, motion.position, motion.angle, number, def.group, def.collidesWith});
    }
  }
  anySticks_ = sticks(-1);
  for (std::size_t i = 0; i < bodies.size(); ++i) anySticks_ = anySticks_ || sticks(static_cast<int>(i));
  if (fixed_ == nullptr || fixed != baked_) bake(fixed);
  std::fill(coarseStart_.begin(), coarseStart_.end(), 0u);
  coarseBodies_.resize(0);
  beginStep(bodies, 0.0, 0.0);
}

void Obstacles::bake(const std::vector<Baked>& fixed) {
  std::vector<PlacedPolygon> placed;
  for (const Baked& b : fixed) {
    placed.push_back({b.shape.get(), Transform::of(b.position, b.angle), b.body, b.group, b.collidesWith});
  }
  DomainWalls walls{domain_.box, domain_.closed};
  if (domain_.periodicX) walls.closed[0] = walls.closed[1] = false;
  if (domain_.periodicY) walls.closed[2] = walls.closed[3] = false;
  fixed_ = std::make_unique<WorldField>(placed, walls, band_);
  baked_ = fixed;
  ++fixedVersion_;
}

void Obstacles::outlines(bool moving, const CollisionFilter& filter, std::vector<CutOutline>& outlines) const {
  if (moving) {
    for (const Moving& m : moving_) {
      if (filter.accepts(m.group, m.collidesWith)) {
        outlines.push_back({m.shape.get(), m.motion.start, m.motion.start.position, m.body});
      }
    }
    return;
  }
  for (const Baked& b : baked_) {
    if (filter.accepts(b.group, b.collidesWith)) {
      outlines.push_back({b.shape.get(), Transform::of(b.position, b.angle), b.position, b.body});
    }
  }
}

void Obstacles::beginStep(const BodySet& bodies, double dt, double reach) {
  if (moving_.empty()) return;
  dt_ = dt;
  reach_ = reach;
  for (Moving& m : moving_) {
    const BodyMotion& motion = bodies.motion(static_cast<std::size_t>(m.body));
    m.motion = {motion.transform(), motion.velocity, motion.spin};
    m.end = Transform::of(motion.position + dt * motion.velocity, motion.angle + dt * motion.spin);
    // Vertices turn on arcs: the chord's sagitta r(1 − cos θ/2) bounds what the two end poses miss.
    Box box;
    double farthest = 0.0;
    for (const Vec2& v : m.field->polygon().vertices()) {
      box.include(m.motion.start.toWorld(v));
      box.include(m.end.toWorld(v));
      farthest = std::max(farthest, v.squaredNorm());
    }
    const double halfTurn = std::min(0.5 * std::abs(motion.spin) * dt, kPi);
    m.swept = box.grown(std::sqrt(farthest) * (1.0 - std::cos(halfTurn)));
    m.middle = Transform::of(motion.position + 0.5 * dt * motion.velocity, motion.angle + 0.5 * dt * motion.spin);
    m.stray = 0.5 * dt * (motion.velocity.norm() + std::abs(motion.spin) * std::sqrt(farthest));
  }
  auto cellRange = [&](const Box& box, int& x0, int& x1, int& y0, int& y1) {
    auto clampTo = [](double v, int n) {
      return static_cast<int>(std::clamp(std::floor(v), 0.0, static_cast<double>(n - 1)));
    };
    x0 = clampTo((box.min.x() - coarseOrigin_.x()) / coarseCell_, coarseNx_);
    x1 = clampTo((box.max.x() - coarseOrigin_.x()) / coarseCell_, coarseNx_);
    y0 = clampTo((box.min.y() - coarseOrigin_.y()) / coarseCell_, coarseNy_);
    y1 = clampTo((box.max.y() - coarseOrigin_.y()) / coarseCell_, coarseNy_);
  };
  auto forEachCell = [&](const Moving& m, auto&& visit) {
    int x0, x1, y0, y1;
    cellRange(m.swept.grown(reach), x0, x1, y0, y1);
    for (int y = y0; y <= y1; ++y) {
      for (int x = x0; x <= x1; ++x) visit(static_cast<std::size_t>(y * coarseNx_ + x));
    }
  };
  std::fill(coarseStart_.begin(), coarseStart_.end(), 0u);
  for (const Moving& m : moving_) forEachCell(m, [&](std::size_t c) { ++coarseStart_[c + 1]; });
  for (std::size_t c = 1; c < coarseStart_.size(); ++c) coarseStart_[c] += coarseStart_[c - 1];
  coarseBodies_.resize(coarseStart_[coarseStart_.size() - 1]);
  for (std::uint32_t k = static_cast<std::uint32_t>(moving_.size()); k-- > 0;) {
    // Filled from the back so that each start is decremented to its own place and the list rises in body order.
    forEachCell(moving_[k], [&](std::size_t c) { coarseBodies_[--coarseStart_[c + 1]] = k; });
  }
  // Each start now stands one place early: shift back.
  for (std::size_t c = 0; c + 1 < coarseStart_.size(); ++c) coarseStart_[c] = coarseStart_[c + 1];
  coarseStart_[coarseStart_.size() - 1] = static_cast<std::uint32_t>(coarseBodies_.size());
}

std::span<const std::uint32_t> Obstacles::movingNear(const Vec2& x) const {
  auto index = [](double v, int n) {
    return static_cast<int>(v > 0.0 ? std::min(v, static_cast<double>(n - 1)) : 0.0);
  };
  const int cx = index((x.x() - coarseOrigin_.x()) / coarseCell_, coarseNx_);
  const int cy = index((x.y() - coarseOrigin_.y()) / coarseCell_, coarseNy_);
  const auto c = static_cast<std::size_t>(cy * coarseNx_ + cx);
  return {coarseBodies_.data() + coarseStart_[c], coarseStart_[c + 1] - coarseStart_[c]};
}

double Obstacles::movingClearance(const Vec2& x) const {
  if (moving_.empty()) return kInfinity;
  double result = reach_;  // a body that is not listed in this cell is farther than the reach
  for (const std::uint32_t k : movingNear(x)) {
    const Box& b = moving_[k].swept;
    const double dx = std::max({b.min.x() - x.x(), 0.0, x.x() - b.max.x()});
    const double dy = std::max({b.min.y() - x.y(), 0.0, x.y() - b.max.y()});
    result = std::min(result, std::sqrt(dx * dx + dy * dy));
  }
  return result;
}

double Obstacles::movingBound(std::uint32_t k, const Vec2& x, const CollisionFilter& filter) const {
  const Moving& m = moving_[k];
  if (!filter.accepts(m.group, m.collidesWith)) return kInfinity;
  return m.field->sample(m.middle.toLocal(x)).distance - m.stray;
}

double Obstacles::clearance(const Vec2& x) const {
  double result = kInfinity;
  forEachImage(x, fixed_->band(), [&](const Vec2& shift) {
    result = std::min({result, fixed_->lowerBound(x + shift), movingClearance(x + shift)});
  });
  return result;
}

double Obstacles::freeDistance(const Vec2& x, const CollisionFilter& filter) const {
  double result = kInfinity;
  forEachImage(x, fixed_->band(), [&](const Vec2& shift) {
    result = std::min({result, fixed_->sample(x + shift, filter).distance, movingClearance(x + shift)});
  });
  return result;
}

// What the surface of a body adds to a hit: its belt runs counter-clockwise, to the left of the outward normal.
void Obstacles::touch(ObstacleHit& hit, int body) const {
  if (body < 0) return;
  const Surface& surface = surfaces_[static_cast<std::size_t>(body)];
  hit.surfaceVelocity += beltVelocity(body, hit.normal);
  hit.friction = surface.friction;
  hit.restitution = surface.restitution;
}

void Obstacles::sweepMoving(const Vec2& from, const Vec2& to, double t0, double radius, const CollisionFilter& filter,
                            ObstacleHit& best) const {
  const double share = 1.0 - t0;
  Box path;
  path.include(from);
  path.include(to);
  path = path.grown(radius);
  auto sweepOne = [&](const Moving& m) {
    if (!filter.accepts(m.group, m.collidesWith) || !m.swept.overlaps(path)) return;
    RigidMotion motion = m.motion;
    motion.start = m.motion.at(t0 * dt_);
    const SweepHit hit = sweepDisc(*m.field, motion, share * dt_, from, to, radius);
    if (!hit.hit || (best.hit && t0 + hit.time * share >= best.time)) return;
    const double time = t0 + hit.time * share;
    best = {true,   time, hit.center, hit.normal,       m.motion.velocityAt(hit.point, time * dt_),
            m.body, 0.0,  0.0,        hit.startedInside};
    touch(best, m.body);
  };
  // A path within one coarse cell and the reach needs that cell's bodies only; a longer one looks at all.
  if ((to - from).norm() + radius <= reach_) {
    for (const std::uint32_t k : movingNear(from)) sweepOne(moving_[k]);
  } else {
    for (const Moving& m : moving_) sweepOne(m);
  }
}

ObstacleHit Obstacles::sweep(const Vec2& from, const Vec2& to, double t0, double radius,
                             const CollisionFilter& filter) const {
  ObstacleHit best;
  best.center = to;
  forEachImage(from, (to - from).norm() + radius, [&](const Vec2& shift) {
    const SweepHit hit = fixed_->sweepDisc(from + shift, to + shift, radius, filter);
    const double time = t0 + hit.time * (1.0 - t0);
    if (hit.hit && (!best.hit || time < best.time)) {
      best = {true, time, hit.center - shift, hit.normal, {0.0, 0.0}, hit.body, 0.0, 0.0, hit.startedInside};
      touch(best, hit.body);
    }
    if (moving_.empty()) return;
    ObstacleHit image = best;
    sweepMoving(from + shift, to + shift, t0, radius, filter, image);
    if (image.hit && (!best.hit || image.time < best.time)) {
      best = image;
      best.center -= shift;
    }
  });
  return best;
}

std::size_t Obstacles::edgesNear(const Vec2& x, double radius, double unit, const CollisionFilter& filter,
                                 std::span<WallEdge> edges) const {
  std::size_t count = 0;
  const double scale = 1.0 / unit;
  const std::size_t room = std::min(edges.size(), kMaxWallEdges);
  auto add = [&](const Vec2& a, const Vec2& b, int owner) {
    if (count < room) edges[count++] = {a, b, owner};
  };
  forEachImage(x, radius, [&](const Vec2& shift) {
    const Vec2 p = x + shift;
    if (fixed_->lowerBound(p) < radius) {
      fixed_->forEachEdgeNear(p, radius, [&](const FieldEdge& e) {
        if (e.body >= 0 && !acceptsBody(e.body, filter)) return;
        add((e.a - p) * scale, (e.b - p) * scale, e.body);
      });
    }
    for (const std::uint32_t k : movingNear(p)) {
      const Moving& m = moving_[k];
      if (!filter.accepts(m.group, m.collidesWith) || !m.swept.grown(radius).contains(p)) continue;
      const Vec2 local = m.end.toLocal(p);
      if (m.field->lowerBound(local) >= radius) continue;
      const Polygon& polygon = m.field->polygon();
      m.field->forEachEdgeNear(local, radius, [&](std::uint32_t e) {
        add(m.end.rotation.apply(polygon.edgeStart(e) - local) * scale,
            m.end.rotation.apply(polygon.edgeEnd(e) - local) * scale, m.body);
      });
    }
  });
  return count;
}

Obstacles::Distance Obstacles::distance(const Vec2& x, const CollisionFilter& filter) const {
  Distance best;
  forEachImage(x, fixed_->band(), [&](const Vec2& shift) {
    const WorldSample s = fixed_->sample(x + shift, filter);
    if (s.distance < best.distance) best = {s.distance, s.normal, s.body};
    for (const std::uint32_t k : movingNear(x + shift)) {
      const Moving& m = moving_[k];
      if (!filter.accepts(m.group, m.collidesWith)) continue;
      const FieldSample f = m.field->sample(m.end.toLocal(x + shift));
      if (f.distance < best.distance) best = {f.distance, m.end.rotation.apply(f.normal), m.body};
    }
  });
  return best;
}

Vec2 Obstacles::velocityAt(int body, const Vec2& x) const {
  if (body < 0) return {0.0, 0.0};
  const int k = surfaces_[static_cast<std::size_t>(body)].moving;
  if (k < 0) return {0.0, 0.0};
  const Moving& m = moving_[static_cast<std::size_t>(k)];
  return m.motion.velocity + cross(m.motion.spin, x - m.end.position);
}

Vec2 Obstacles::carriedFrom(int body, const Vec2& x, double t0) const {
  const int k = body < 0 ? -1 : surfaces_[static_cast<std::size_t>(body)].moving;
  if (k < 0) return x;
  const Moving& m = moving_[static_cast<std::size_t>(k)];
  return m.end.toWorld(m.motion.at(t0 * dt_).toLocal(x));
}

Vec2 Obstacles::surfaceVelocityAt(int body, const Vec2& x, const Vec2& normal) const {
  return velocityAt(body, x) + beltVelocity(body, normal);
}

std::size_t Obstacles::memoryBytes() const {
  std::size_t bytes = fixed_->memoryBytes() + (coarseStart_.capacity() + coarseBodies_.capacity()) * 4;
  for (const Moving& m : moving_) bytes += m.field->memoryBytes();
  return bytes;
}

}  // namespace froude
