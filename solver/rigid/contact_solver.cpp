#include <froude/solver/rigid/contact_solver.h>

#include <bit>

namespace froude {
namespace {

constexpr std::size_t kBlock = 32;      // contacts a task
constexpr std::uint32_t kColours = 32;  // between free bodies; as many again with what does not give way
constexpr double kPartShare = 0.4;      // of an overlap that a sub-step takes away
constexpr double kBounce = 0.2;         // of √(g · thickness): what meets slower does not bounce
// A blow runs through a heap body by body: iterations go on while anything would still overlap by so much in the
// sub-step.
constexpr double kOverrun = 0.02;    // of the thinner body
constexpr int kIterations = 8;       // at most
constexpr int kColdIterations = 50;  // where no point bears anything yet: a scene's start
constexpr double kTouching = 2e-3;   // thicknesses apart that count as touching
constexpr double kWellPosed = 1e-6;  // of two points as if alone: what their determinant must be
constexpr double kPushLimit = 20.0;  // thicknesses of the thinner body a second

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
  c.thickness = std::min(list.thickness(c.a), list.thickness(c.b));
  c.touching = kTouching * c.thickness;
  c.bouncesAbove =
      std::max(2.0 * settings_.gravity * settings_.step, kBounce * std::sqrt(settings_.gravity * c.thickness));
  c.pushLimit = kPushLimit * c.thickness;
  const Vec2 originA = poses.pose[c.a].position, originB = poses.pose[c.b].position;
  const Vec2 tangent = leftNormal(c.normal);
  const double inverseMass = c.inverseMassA + c.inverseMassB;
  for (std::uint32_t k = 0; k < c.count; ++k) {
    const ContactPoint& at = from.points[k];
    Point& p = c.points[k];
    p.armA = at.at - originA;
    p.armB = at.at - originB;
    p.separation = at.separation;
    auto inverseMassAlong = [&](const Vec2& d) {
      const double ra = cross(p.armA, d), rb = cross(p.armB, d);
      return inverseMass + c.inverseInertiaA * ra * ra + c.inverseInertiaB * rb * rb;
    };
    p.inverseNormalMass = inverseMassAlong(c.normal);
    p.normalMass = 1.0 / p.inverseNormalMass;
    p.tangentMass = 1.0 / inverseMassAlong(tangent);
    p.normalImpulse = settings_.h * at.normalForce;
    p.tangentImpulse = settings_.h * at.tangentForce;
    p.now = p.separation;
    p.normalSum = p.tangentSum = p.approach = 0.0;
  }
  c.coupling = c.inverseDeterminant = 0.0;
  if (c.count < 2) return c;
  const Point &p = c.points[0], &q = c.points[1];
  c.coupling = inverseMass + c.inverseInertiaA * cross(p.armA, c.normal) * cross(q.armA, c.normal) +
               c.inverseInertiaB * cross(p.armB, c.normal) * cross(q.armB, c.normal);
  const double alone = p.inverseNormalMass * q.inverseNormalMass;
  const double determinant = alone - c.coupling * c.coupling;
  if (determinant > kWellPosed * alone) c.inverseDeterminant = 1.0 / determinant;
  return c;
}

// Greedy, in the order of the list: the first colour that neither body has yet. Contacts with what does not give way
// come last, where nothing can undo them. A body with more contacts than there are colours has the rest solved one by
// one.
void ContactSolver::colour(const std::vector<std::uint8_t>& awake) {
  taken_.assign(awake.size(), 0);
  colourOf_.resize(active_.size());
  start_.assign(2 * kColours + 2, 0);
  for (std::size_t k = 0; k < active_.size(); ++k) {
    const ContactRef& contact = active_[k];
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
  outsideFrom_ = start_[kColours];
  order_.resize(active_.size());
  for (std::size_t k = 0; k < active_.size(); ++k) order_[start_[colourOf_[k]]++] = active_[k].contact;
}

void ContactSolver::prepare(const ContactList& list, const BodySet& bodies, const BodyPoses& poses,
                            const std::vector<std::uint8_t>& awake, const Settings& settings, Crew& crew) {
  settings_ = settings;
  active_.clear();
  for (const ContactRef& c : list.touching()) {
    if (awake[c.bodyA] != 0 || awake[c.bodyB] != 0) active_.push_back(c);
  }
  colour(awake);
  constraints_.resize(order_.size());
  for (std::atomic<bool>* any : {&anyBounces_, &anyBears_, &anyBelt_}) any->store(false, std::memory_order_relaxed);
  crew.stage(order_.size(), 2 * kBlock, [&](std::size_t begin, std::size_t end) {
    bool bounces = false, bears = false, belt = false;
    for (std::size_t k = begin; k < end; ++k) {
      const Constraint& c = constraints_[k] = makeConstraint(order_[k], list, bodies, poses);
      bounces = bounces || c.restitution > 0.0;
      belt = belt || c.belt != 0.0;
      for (std::uint32_t i = 0; i < c.count; ++i) bears = bears || c.points[i].normalImpulse != 0.0;
    }
    if (bounces) anyBounces_.store(true, std::memory_order_relaxed);
    if (bears) anyBears_.store(true, std::memory_order_relaxed);
    if (belt) anyBelt_.store(true, std::memory_order_relaxed);
  });
  iterations_ = anyBears_.load(std::memory_order_relaxed) ? kIterations : kColdIterations;
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

// The velocities of a contact's two bodies while it is solved: in registers, and written once. What does not give way
// is not written, as many threads may read it.
struct ContactSolver::Velocities {
  double ax, ay, aw, bx, by, bw;

  Velocities(const SolverBody& a, const SolverBody& b) : ax(a.vx), ay(a.vy), aw(a.w), bx(b.vx), by(b.vy), bw(b.w) {}
  /// The impulse (x, y) at the point: on B, and back on A.
  void give(const Constraint& c, const Point& p, double x, double y) {
    ax -= c.inverseMassA * x;
    ay -= c.inverseMassA * y;
    aw -= c.inverseInertiaA * (p.armA.x() * y - p.armA.y() * x);
    bx += c.inverseMassB * x;
    by += c.inverseMassB * y;
    bw += c.inverseInertiaB * (p.armB.x() * y - p.armB.y() * x);
  }
  /// Of B's point seen from A's.
  double alongX(const Point& p) const { return bx - bw * p.armB.y() - ax + aw * p.armA.y(); }
  double alongY(const Point& p) const { return by + bw * p.armB.x() - ay - aw * p.armA.x(); }
  double along(const Vec2& n, const Point& p) const { return n.x() * alongX(p) + n.y() * alongY(p); }
  void store(const Constraint& c, SolverBody& a, SolverBody& b) const {
    if (c.inverseMassA > 0.0) a.vx = ax, a.vy = ay, a.w = aw;
    if (c.inverseMassB > 0.0) b.vx = bx, b.vy = by, b.w = bw;
  }
};

namespace {

// Adds the impulse (x, y) at the arms to the parting velocities; what does not give way is not written.
template <typename Constraint>
void applyParting(const Constraint& c, const Vec2& armA, const Vec2& armB, double x, double y, SolverBody& a,
                  SolverBody& b) {
  if (c.inverseMassA > 0.0) {
    a.px -= c.inverseMassA * x;
    a.py -= c.inverseMassA * y;
    a.pw -= c.inverseInertiaA * (armA.x() * y - armA.y() * x);
  }
  if (c.inverseMassB > 0.0) {
    b.px += c.inverseMassB * x;
    b.py += c.inverseMassB * y;
    b.pw += c.inverseInertiaB * (armB.x() * y - armB.y() * x);
  }
}

// Of the points where the bodies are now [m].
template <typename Point>
double separationNow(const Vec2& n, const Point& p, const SolverBody& a, const SolverBody& b) {
  const double ax = a.c * p.armA.x() - a.s * p.armA.y(), ay = a.s * p.armA.x() + a.c * p.armA.y();
  const double bx = b.c * p.armB.x() - b.s * p.armB.y(), by = b.s * p.armB.x() + b.c * p.armB.y();
  return p.separation + n.x() * (b.dx - a.dx + (bx - p.armB.x()) - (ax - p.armA.x())) +
         n.y() * (b.dy - a.dy + (by - p.armB.y()) - (ay - p.armA.y()));
}

// Impulses of one or two points: x ≥ 0, v = A·x + b ≥ 0 and one of each pair 0; by trying which of the two push. Where
// rounding leaves none, both are as if alone and give half.
template <typename Constraint>
inline std::array<double, 2> solvePoints(const Constraint& c, const std::array<double, 2>& b) {
  const double x0 = -b[0] * c.points[0].normalMass;
  if (c.count == 1) return {std::max(0.0, x0), 0.0};
  const double a00 = c.points[0].inverseNormalMass, a01 = c.coupling, a11 = c.points[1].inverseNormalMass;
  if (c.inverseDeterminant > 0.0) {
    const double x = (a01 * b[1] - a11 * b[0]) * c.inverseDeterminant;
    const double y = (a01 * b[0] - a00 * b[1]) * c.inverseDeterminant;
    if (x >= 0.0 && y >= 0.0) return {x, y};
  }
  if (x0 >= 0.0 && a01 * x0 + b[1] >= 0.0) return {x0, 0.0};
  const double y0 = -b[1] * c.points[1].normalMass;
  if (y0 >= 0.0 && a01 * y0 + b[0] >= 0.0) return {0.0, y0};
  if (b[0] >= 0.0 && b[1] >= 0.0) return {0.0, 0.0};
  return {std::max(0.0, 0.5 * x0), std::max(0.0, 0.5 * y0)};
}

}  // namespace

void ContactSolver::noteApproach(const std::vector<SolverBody>& bodies, Crew& crew) {
  anyFast_.store(false, std::memory_order_relaxed);
  if (!anyBounces_.load(std::memory_order_relaxed)) return;
  crew.stage(constraints_.size(), 4 * kBlock, [&](std::size_t begin, std::size_t end) {
    bool fast = false;
    for (std::size_t k = begin; k < end; ++k) {
      Constraint& c = constraints_[k];
      for (std::uint32_t i = 0; i < c.count; ++i) {
        Point& p = c.points[i];
        p.approach = Velocities(bodies[c.a], bodies[c.b]).along(c.normal, p);
        fast = fast || (c.restitution > 0.0 && p.approach < -c.bouncesAbove);
      }
    }
    if (fast) anyFast_.store(true, std::memory_order_relaxed);
  });
}

void ContactSolver::warmStart(std::vector<SolverBody>& bodies, Crew& crew) {
  noteApproach(bodies, crew);
  forEachColour(crew, [&](Constraint& c) {
    SolverBody& a = bodies[c.a];
    SolverBody& b = bodies[c.b];
    Velocities v(a, b);
    for (std::uint32_t i = 0; i < c.count; ++i) {
      Point& p = c.points[i];
      p.now = separationNow(c.normal, p, a, b);
      p.normalSum += p.normalImpulse;
      p.tangentSum += p.tangentImpulse;
      const double x = p.normalImpulse * c.normal.x() - p.tangentImpulse * c.normal.y();
      const double y = p.normalImpulse * c.normal.y() + p.tangentImpulse * c.normal.x();
      v.give(c, p, x, y);
    }
    v.store(c, a, b);
  });
}

// Coulomb's law at one point, with what bears on it now.
inline void ContactSolver::rub(const Constraint& c, Point& p, Velocities& v) {
  const double nx = c.normal.x(), ny = c.normal.y();
  const double slip = v.alongY(p) * nx - v.alongX(p) * ny - c.belt;
  const double grip = c.friction * p.normalImpulse;
  const double impulse = std::clamp(p.tangentImpulse - p.tangentMass * slip, -grip, grip);
  const double change = impulse - p.tangentImpulse;
  p.tangentImpulse = impulse;
  p.tangentSum += change;
  v.give(c, p, -change * ny, change * nx);
}

// Newton's law of restitution where they touch already: blow by blow, as each is handed on.
inline double ContactSolver::keepApart(Constraint& c, Velocities& v) const {
  double overrun = 0.0;
  std::array<double, 2> least{0.0, 0.0};
  std::array<bool, 2> blow{false, false};
  for (std::uint32_t i = 0; i < c.count; ++i) {
    Point& p = c.points[i];
    const double room = std::max(0.0, p.now);
    const double apart = v.along(c.normal, p);
    blow[i] = c.restitution > 0.0 && room <= c.touching && apart < -c.bouncesAbove;
    least[i] = blow[i] ? -c.restitution * apart : -room / settings_.h;
    if (blow[i]) p.approach = 0.0;
    overrun = std::max(overrun, -apart * settings_.h - room);
  }
  part(c, least, blow, v);
  return overrun / c.thickness;
}

// What was on its way at the start of the sub-step and has arrived: against the approach that it had then.
void ContactSolver::bounceOne(Constraint& c, SolverBody& a, SolverBody& b) const {
  std::array<double, 2> least{0.0, 0.0};
  std::array<bool, 2> blow{false, false};
  for (std::uint32_t i = 0; i < c.count; ++i) {
    const Point& p = c.points[i];
    blow[i] = p.approach < -c.bouncesAbove && p.normalImpulse > 0.0 && separationNow(c.normal, p, a, b) <= c.touching;
    if (blow[i]) least[i] = -c.restitution * p.approach;
  }
  if (!blow[0] && !blow[1]) return;
  Velocities v(a, b);
  part(c, least, blow, v);
  v.store(c, a, b);
}

// At least these velocities apart. A blow, with the friction that it brings, is over at once: it is not borne on.
inline void ContactSolver::part(Constraint& c, const std::array<double, 2>& least, const std::array<bool, 2>& blow,
                                Velocities& v) {
  std::array<double, 2> rest{0.0, 0.0};
  for (std::uint32_t i = 0; i < c.count; ++i) {
    const Point& p = c.points[i];
    rest[i] = v.along(c.normal, p) - least[i] - p.inverseNormalMass * p.normalImpulse;
    if (c.count == 2) rest[i] -= c.coupling * c.points[1 - i].normalImpulse;
  }
  const std::array<double, 2> x = solvePoints(c, rest);
  std::array<double, 2> borne{0.0, 0.0};
  for (std::uint32_t i = 0; i < c.count; ++i) {
    Point& p = c.points[i];
    borne[i] = p.normalImpulse;
    const double change = x[i] - p.normalImpulse;
    p.normalImpulse = x[i];
    p.normalSum += change;
    v.give(c, p, change * c.normal.x(), change * c.normal.y());
  }
  for (std::uint32_t i = 0; i < c.count; ++i) {
    if (!blow[i]) continue;
    Point& p = c.points[i];
    const double tangent = p.tangentImpulse;
    rub(c, p, v);
    p.normalImpulse = borne[i];
    p.tangentImpulse = tangent;
  }
}

void ContactSolver::solve(std::vector<SolverBody>& bodies, Crew& crew) {
  for (int k = 0; k < iterations_; ++k) {
    overruns_.store(false, std::memory_order_relaxed);
    forEachColour(crew, [&](Constraint& c) {
      SolverBody& a = bodies[c.a];
      SolverBody& b = bodies[c.b];
      Velocities v(a, b);
      if (keepApart(c, v) > kOverrun) overruns_.store(true, std::memory_order_relaxed);
      // Afterwards, so that a point that is new rubs as it bears: a rolling disc has a new one in every step.
      for (std::uint32_t i = 0; i < c.count; ++i) rub(c, c.points[i], v);
      v.store(c, a, b);
    });
    if (!overruns_.load(std::memory_order_relaxed)) return;
  }
}

void ContactSolver::pushOne(Constraint& c, SolverBody& a, SolverBody& b) const {
  std::array<double, 2> rest{0.0, 0.0};
  bool any = false;
  for (std::uint32_t i = 0; i < c.count; ++i) {
    const Point& p = c.points[i];
    const double v = c.normal.x() * (b.px - b.pw * p.armB.y() - a.px + a.pw * p.armA.y()) +
                     c.normal.y() * (b.py + b.pw * p.armB.x() - a.py - a.pw * p.armA.x());
    any = any || p.now < 0.0 || v < 0.0;
    rest[i] = v + std::max(p.now < 0.0 ? kPartShare * p.now / settings_.h : p.now / settings_.h, -c.pushLimit);
  }
  if (!any) return;
  const std::array<double, 2> x = solvePoints(c, rest);
  for (std::uint32_t i = 0; i < c.count; ++i) {
    const Point& p = c.points[i];
    applyParting(c, p.armA, p.armB, x[i] * c.normal.x(), x[i] * c.normal.y(), a, b);
  }
}

void ContactSolver::push(std::vector<SolverBody>& bodies, Crew& crew) {
  forEachColour(crew, [&](Constraint& c) { pushOne(c, bodies[c.a], bodies[c.b]); });
}

void ContactSolver::bounce(std::vector<SolverBody>& bodies, Crew& crew) {
  if (!anyFast_.load(std::memory_order_relaxed)) return;
  forEachColour(crew, [&](Constraint& c) {
    if (c.restitution > 0.0) bounceOne(c, bodies[c.a], bodies[c.b]);
  });
}

void ContactSolver::handOver(const Constraint& c, std::vector<std::array<double, 3>>& onBody) const {
  for (std::uint32_t i = 0; i < c.count; ++i) {
    const Point& p = c.points[i];
    const Vec2 impulse = p.normalSum * c.normal + p.tangentSum * leftNormal(c.normal);
    auto give = [&](std::uint32_t body, const Vec2& arm, const Vec2& to) {
      std::array<double, 3>& sum = onBody[body];
      sum[0] += to.x(), sum[1] += to.y(), sum[2] += cross(arm, to);
    };
    give(c.a, p.armA, -impulse);
    give(c.b, p.armB, impulse);
  }
}

// Free bodies of one colour are all different; what does not give way is in many contacts, and its sums are made in
// their order.
ContactTotals ContactSolver::finish(const std::vector<SolverBody>& bodies, ContactList& list,
                                    std::vector<std::array<double, 3>>& onBody, Crew& crew) {
  std::vector<Contact>& contacts = list.contacts();
  forEachColour(crew, [&](Constraint& c) {
    for (std::uint32_t i = 0; i < c.count; ++i) {
      contacts[c.contact].points[i].normalForce = c.points[i].normalImpulse / settings_.h;
      contacts[c.contact].points[i].tangentForce = c.points[i].tangentImpulse / settings_.h;
    }
    if (c.inverseMassA > 0.0 && c.inverseMassB > 0.0) handOver(c, onBody);
  });
  ContactTotals totals;
  for (std::size_t k = outsideFrom_; k < constraints_.size(); ++k) {
    const Constraint& c = constraints_[k];
    if (c.inverseMassA > 0.0 && c.inverseMassB > 0.0) continue;
    handOver(c, onBody);
    const bool isA = c.inverseMassA == 0.0;
    const SolverBody& outside = bodies[isA ? c.a : c.b];
    for (std::uint32_t i = 0; i < c.count; ++i) {
      const Point& p = c.points[i];
      const Vec2 impulse = p.normalSum * c.normal + p.tangentSum * leftNormal(c.normal);
      const Vec2 on = isA ? impulse : Vec2(-impulse);
      totals.outside += on;
      totals.work += on.dot(Vec2(outside.vx, outside.vy) + cross(outside.w, isA ? p.armA : p.armB));
    }
  }
  if (!anyBelt_.load(std::memory_order_relaxed)) return totals;
  for (const Constraint& c : constraints_) {
    for (std::uint32_t i = 0; i < c.count; ++i) totals.work += c.points[i].tangentSum * c.belt;
  }
  return totals;
}

}  // namespace froude
