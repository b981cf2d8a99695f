#include <froude/solver/rigid/contact_solver.h>

#include <bit>

namespace froude {
namespace {

constexpr std::size_t kBlock = 32;      // contacts a task
constexpr std::uint32_t kColours = 32;  // between free bodies; as many again with what does not give way
constexpr double kPushShare = 0.15;     // of an overlap a sub-step
constexpr double kPushLimit = 20.0;     // thicknesses of the thinner body a second

double mixedFriction(double a, double b) { return std::sqrt(a * b); }

}  // namespace

ContactSolver::Constraint ContactSolver::makeConstraint(std::uint32_t contact, const ContactList& list,
                                                        const BodySet& bodies, const BodyPoses& poses) const {
  const Contact& from = list.contacts()[contact];
  Constraint c;
  c.a = from.bodyA, c.b = from.bodyB;
  c.contact = contact;
  c.count = from.count;
  c.normal = from.normal;
  const auto domain = static_cast<std::uint32_t>(bodies.size());
  const bool wallA = c.a == domain, wallB = c.b == domain;
  const MassData none;
  const MassData& ma = wallA ? none : bodies.mass(c.a);
  const MassData& mb = wallB ? none : bodies.mass(c.b);
  c.inverseMassA = ma.inverseMass, c.inverseInertiaA = ma.inverseInertia;
  c.inverseMassB = mb.inverseMass, c.inverseInertiaB = mb.inverseInertia;
  // A wall of the domain is like what touches it.
  const BodyDef& da = bodies.definition(wallA ? c.b : c.a);
  const BodyDef& db = bodies.definition(wallB ? c.a : c.b);
  c.friction = mixedFriction(da.friction, db.friction);
  c.restitution = std::max(da.restitution, db.restitution);
  c.belt = (wallA ? 0.0 : da.surfaceVelocity) + (wallB ? 0.0 : db.surfaceVelocity);
  c.pushRate = kPushShare / settings_.h;
  c.pushLimit = kPushLimit * std::min(list.thickness(c.a), list.thickness(c.b));
  const Vec2 originA = poses.pose[c.a].position, originB = poses.pose[c.b].position;
  const Vec2 tangent = leftNormal(c.normal);
  const double inverseMass = c.inverseMassA + c.inverseMassB;
  for (std::uint32_t k = 0; k < c.count; ++k) {
    const ContactPoint& at = from.points[k];
    Point& p = c.points[k];
    p.armA = at.at - originA;
    p.armB = at.at - originB;
    p.separation = at.separation;
    auto massAlong = [&](const Vec2& d) {
      const double ra = cross(p.armA, d), rb = cross(p.armB, d);
      const double inverse = inverseMass + c.inverseInertiaA * ra * ra + c.inverseInertiaB * rb * rb;
      return inverse > 0.0 ? 1.0 / inverse : 0.0;
    };
    p.normalMass = massAlong(c.normal);
    p.tangentMass = massAlong(tangent);
    p.normalImpulse = at.normalImpulse;
    p.tangentImpulse = at.tangentImpulse;
    p.normalSum = p.tangentSum = p.approach = 0.0;
  }
  return c;
}

// Greedy, in the order of the list: the first colour that neither body has yet. Contacts with what does not give way
// come last, where nothing can undo them. A body with more contacts than there are colours has the rest solved one by
// one.
void ContactSolver::colour(const std::vector<std::uint32_t>& active, const ContactList& list,
                           const std::vector<std::uint8_t>& awake) {
  taken_.assign(awake.size(), 0);
  colourOf_.resize(active.size());
  start_.assign(2 * kColours + 2, 0);
  for (std::size_t k = 0; k < active.size(); ++k) {
    const Contact& contact = list.contacts()[active[k]];
    const bool movesA = awake[contact.bodyA] != 0, movesB = awake[contact.bodyB] != 0;
    const bool both = movesA && movesB;
    const std::uint64_t range = both ? (std::uint64_t{1} << kColours) - 1 : ~((std::uint64_t{1} << kColours) - 1);
    std::uint64_t taken = ~range;
    if (movesA) taken |= taken_[contact.bodyA];
    if (movesB) taken |= taken_[contact.bodyB];
    std::uint32_t colour = 2 * kColours;
    if (~taken != 0) {
      colour = static_cast<std::uint32_t>(std::countr_one(taken));
      const std::uint64_t bit = std::uint64_t{1} << colour;
      if (movesA) taken_[contact.bodyA] |= bit;
      if (movesB) taken_[contact.bodyB] |= bit;
    }
    colourOf_[k] = colour;
    ++start_[colour + 1];
  }
  for (std::size_t c = 1; c < start_.size(); ++c) start_[c] += start_[c - 1];
  colours_.clear();
  for (std::uint32_t c = 0; c < 2 * kColours; ++c) {
    if (start_[c + 1] > start_[c]) colours_.push_back({start_[c], start_[c + 1]});
  }
  serialFrom_ = start_[2 * kColours];
  order_.resize(active.size());
  for (std::size_t k = 0; k < active.size(); ++k) order_[start_[colourOf_[k]]++] = active[k];
}

void ContactSolver::prepare(const ContactList& list, const BodySet& bodies, const BodyPoses& poses,
                            const std::vector<std::uint8_t>& awake, const Settings& settings) {
  settings_ = settings;
  active_.clear();
  for (std::uint32_t k = 0; k < list.contacts().size(); ++k) {
    const Contact& c = list.contacts()[k];
    if (c.count > 0 && (awake[c.bodyA] != 0 || awake[c.bodyB] != 0)) active_.push_back(k);
  }
  colour(active_, list, awake);
  constraints_.resize(order_.size());
  anyBounces_ = false;
  for (std::size_t k = 0; k < order_.size(); ++k) {
    constraints_[k] = makeConstraint(order_[k], list, bodies, poses);
    anyBounces_ = anyBounces_ || constraints_[k].restitution > 0.0;
  }
}

template <typename Body>
void ContactSolver::forEachColour(Crew& crew, Body&& body) {
  for (const Colour& colour : colours_) {
    Constraint* first = constraints_.data() + colour.begin;
    crew.stage(colour.end - colour.begin, kBlock, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) body(first[k]);
    });
  }
  for (std::size_t k = serialFrom_; k < constraints_.size(); ++k) body(constraints_[k]);
}

void ContactSolver::noteApproach(const std::vector<SolverBody>& bodies, Crew& crew) {
  if (!anyBounces_) return;
  crew.stage(constraints_.size(), 4 * kBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      Constraint& c = constraints_[k];
      const SolverBody& a = bodies[c.a];
      const SolverBody& b = bodies[c.b];
      for (std::uint32_t i = 0; i < c.count; ++i) {
        Point& p = c.points[i];
        p.approach = c.normal.x() * (b.vx - b.w * p.armB.y() - a.vx + a.w * p.armA.y()) +
                     c.normal.y() * (b.vy + b.w * p.armB.x() - a.vy - a.w * p.armA.x());
      }
    }
  });
}

namespace {

// Adds the impulse (x, y) at the arms; what does not give way is not written, as many threads may read it.
template <typename Constraint>
void apply(const Constraint& c, const Vec2& armA, const Vec2& armB, double x, double y, SolverBody& a, SolverBody& b) {
  if (c.inverseMassA > 0.0) {
    a.vx -= c.inverseMassA * x;
    a.vy -= c.inverseMassA * y;
    a.w -= c.inverseInertiaA * (armA.x() * y - armA.y() * x);
  }
  if (c.inverseMassB > 0.0) {
    b.vx += c.inverseMassB * x;
    b.vy += c.inverseMassB * y;
    b.w += c.inverseInertiaB * (armB.x() * y - armB.y() * x);
  }
}

}  // namespace

void ContactSolver::warmStart(std::vector<SolverBody>& bodies, Crew& crew) {
  forEachColour(crew, [&](Constraint& c) {
    SolverBody& a = bodies[c.a];
    SolverBody& b = bodies[c.b];
    for (std::uint32_t i = 0; i < c.count; ++i) {
      const Point& p = c.points[i];
      const double x = p.normalImpulse * c.normal.x() - p.tangentImpulse * c.normal.y();
      const double y = p.normalImpulse * c.normal.y() + p.tangentImpulse * c.normal.x();
      apply(c, p.armA, p.armB, x, y, a, b);
    }
  });
}

void ContactSolver::solveOne(Constraint& c, SolverBody* bodies, bool pushing) const {
  SolverBody& a = bodies[c.a];
  SolverBody& b = bodies[c.b];
  const double nx = c.normal.x(), ny = c.normal.y();
  const double perStep = 1.0 / settings_.h;
  for (std::uint32_t i = 0; i < c.count; ++i) {  // friction first: what keeps apart has the last word
    Point& p = c.points[i];
    const double vx = b.vx - b.w * p.armB.y() - a.vx + a.w * p.armA.y();
    const double vy = b.vy + b.w * p.armB.x() - a.vy - a.w * p.armA.x();
    const double slip = vy * nx - vx * ny - c.belt;
    const double grip = c.friction * p.normalImpulse;
    const double impulse = std::clamp(p.tangentImpulse - p.tangentMass * slip, -grip, grip);
    const double change = impulse - p.tangentImpulse;
    p.tangentImpulse = impulse;
    apply(c, p.armA, p.armB, -change * ny, change * nx, a, b);
  }
  for (std::uint32_t i = 0; i < c.count; ++i) {
    Point& p = c.points[i];
    double wanted = 0.0;  // relative velocity, at least
    if (pushing) {
      const double ax = a.c * p.armA.x() - a.s * p.armA.y(), ay = a.s * p.armA.x() + a.c * p.armA.y();
      const double bx = b.c * p.armB.x() - b.s * p.armB.y(), by = b.s * p.armB.x() + b.c * p.armB.y();
      const double moved = nx * (b.dx - a.dx + (bx - p.armB.x()) - (ax - p.armA.x())) +
                           ny * (b.dy - a.dy + (by - p.armB.y()) - (ay - p.armA.y()));
      const double separation = p.separation + moved;
      wanted = separation > 0.0 ? -separation * perStep : std::min(-c.pushRate * separation, c.pushLimit);
    } else if (p.approach < -settings_.restitutionAbove && p.normalImpulse > 0.0) {
      wanted = -c.restitution * p.approach;
    }
    const double v = nx * (b.vx - b.w * p.armB.y() - a.vx + a.w * p.armA.y()) +
                     ny * (b.vy + b.w * p.armB.x() - a.vy - a.w * p.armA.x());
    const double impulse = std::max(0.0, p.normalImpulse - p.normalMass * (v - wanted));
    const double change = impulse - p.normalImpulse;
    p.normalImpulse = impulse;
    apply(c, p.armA, p.armB, change * nx, change * ny, a, b);
    if (!pushing) {
      p.normalSum += p.normalImpulse;
      p.tangentSum += p.tangentImpulse;
    }
  }
}

void ContactSolver::solve(std::vector<SolverBody>& bodies, Crew& crew, bool pushing) {
  forEachColour(crew, [&](Constraint& c) { solveOne(c, bodies.data(), pushing); });
}

ContactTotals ContactSolver::finish(const std::vector<SolverBody>& bodies, ContactList& list,
                                    std::vector<std::array<double, 3>>& onBody) const {
  ContactTotals totals;
  for (const Constraint& c : constraints_) {
    Contact& contact = list.contacts()[c.contact];
    for (std::uint32_t i = 0; i < c.count; ++i) {
      const Point& p = c.points[i];
      contact.points[i].normalImpulse = p.normalImpulse;
      contact.points[i].tangentImpulse = p.tangentImpulse;
      const Vec2 impulse = p.normalSum * c.normal + p.tangentSum * leftNormal(c.normal);
      auto give = [&](std::uint32_t body, const Vec2& arm, const Vec2& to) {
        std::array<double, 3>& sum = onBody[body];
        sum[0] += to.x(), sum[1] += to.y(), sum[2] += cross(arm, to);
      };
      give(c.a, p.armA, -impulse);
      give(c.b, p.armB, impulse);
      auto fromOutside = [&](const SolverBody& outside, const Vec2& arm, const Vec2& on) {
        totals.outside += on;
        totals.work += on.dot(Vec2(outside.vx, outside.vy) + cross(outside.w, arm));
      };
      if (c.inverseMassA == 0.0) fromOutside(bodies[c.a], p.armA, impulse);
      if (c.inverseMassB == 0.0) fromOutside(bodies[c.b], p.armB, -impulse);
      totals.work += p.tangentSum * c.belt;
    }
  }
  return totals;
}

}  // namespace froude
