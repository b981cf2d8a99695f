// Keeps bodies apart and lets them rub: contact impulses by one projected Gauss-Seidel iteration in each small
// sub-step.
//
// M. Macklin et al., "Small steps in physics simulation", SCA 2019. What overlaps is parted by a velocity of its own
// that does not outlive the sub-step, so that parting gives no energy and impulses do not answer to old errors.
#pragma once

#include <atomic>
#include <vector>

#include <froude/base/crew.h>
#include <froude/solver/rigid/contact_list.h>

namespace froude {

/// A body in the solver: its velocity, and how far it has come since the start of the step.
struct alignas(64) SolverBody {
  double vx = 0.0, vy = 0.0, w = 0.0;   // [m/s, rad/s]
  double dx = 0.0, dy = 0.0;            // of the frame's origin [m]
  double turn = 0.0;                    // [rad]
  double c = 1.0, s = 0.0;              // of the turn
  double px = 0.0, py = 0.0, pw = 0.0;  // that part what overlaps, in this sub-step only [m/s, rad/s]
};

/// What the contacts of a step gave to whom.
struct ContactTotals {
  Vec2 outside{0, 0};  // impulse of fixed and scripted bodies and walls on free ones [kg·m/s per metre]
  double work = 0.0;   // of moving surfaces on free bodies [J/m]
};

class ContactSolver {
 public:
  /// What is the same for all contacts of a step.
  struct Settings {
    double h = 0.0;        // sub-step [s]
    double step = 0.0;     // [s]
    double gravity = 0.0;  // largest |g| [m/s²]
  };

  /// Takes the contacts that have points and of which one body is awake, in the order of the list; colours them.
  /// `awake` by body (the domain's last is 0).
  void prepare(const ContactList& list, const BodySet& bodies, const BodyPoses& poses,
               const std::vector<std::uint8_t>& awake, const Settings& settings, Crew& crew);

  // The parts of a sub-step, in order. Bodies by index, the domain's last.
  void warmStart(std::vector<SolverBody>& bodies, Crew& crew);
  /// Lets nothing come nearer than touching within the sub-step.
  void solve(std::vector<SolverBody>& bodies, Crew& crew);
  /// Parts what overlaps.
  void push(std::vector<SolverBody>& bodies, Crew& crew);
  /// After the bodies have moved: what has met fast enough goes back.
  void bounce(std::vector<SolverBody>& bodies, Crew& crew);

  /// Impulses back to the list; adds what bodies got to `onBody` (impulse x, y, moment about the centre of mass, by
  /// body).
  ContactTotals finish(const std::vector<SolverBody>& bodies, ContactList& list,
                       std::vector<std::array<double, 3>>& onBody, Crew& crew);

 private:
  struct Point {
    Vec2 armA, armB;    // from the frames' origins at the start of the step [m]
    double separation;  // at the start of the step, without what the arms contribute [m]
    double now;         // at the start of the sub-step [m]
    double inverseNormalMass, normalMass, tangentMass;
    double normalImpulse, tangentImpulse;
    double normalSum, tangentSum;  // over the sub-steps
    double approach;               // relative velocity along the normal before the sub-step's impulses [m/s]
  };
  struct Constraint {
    std::uint32_t a, b, contact, count;
    double inverseMassA, inverseInertiaA, inverseMassB, inverseInertiaB;
    Vec2 normal;
    double friction, restitution, belt;  // belt: of the surfaces along the tangent [m/s]
    double thickness;                    // of the thinner body [m]
    double bouncesAbove;                 // [m/s]
    double touching;                     // [m]
    double pushLimit;                    // [m/s]
    double coupling;                     // of the two points' normal impulses [1/kg]
    double inverseDeterminant;           // of their matrix [kg²]; 0 where it has none
    std::array<Point, 2> points;
  };
  struct Velocities;
  struct Colour {
    std::uint32_t begin, end;
  };
  void colour(const std::vector<std::uint8_t>& awake);
  void handOver(const Constraint& c, std::vector<std::array<double, 3>>& onBody) const;
  Constraint makeConstraint(std::uint32_t contact, const ContactList& list, const BodySet& bodies,
                            const BodyPoses& poses) const;
  template <typename Body>
  void forEachColour(Crew& crew, Body&& body);
  void noteApproach(const std::vector<SolverBody>& bodies, Crew& crew);
  static void rub(const Constraint& c, Point& p, Velocities& v);
  double keepApart(Constraint& c, Velocities& v) const;
  void bounceOne(Constraint& c, SolverBody& a, SolverBody& b) const;
  static void part(Constraint& c, const std::array<double, 2>& least, const std::array<bool, 2>& blow, Velocities& v);
  void pushOne(Constraint& c, SolverBody& a, SolverBody& b) const;

  Settings settings_;
  int iterations_ = 1;                   // a sub-step
  std::atomic<bool> anyBounces_{false};  // any that could
  std::atomic<bool> anyBears_{false};    // any that bore something in the step before
  std::atomic<bool> anyBelt_{false};     // any whose surfaces run
  std::atomic<bool> overruns_{false};    // any that would still overlap
  std::atomic<bool> anyFast_{false};     // any that may in this sub-step
  std::vector<Constraint> constraints_;  // by colour
  std::vector<Colour> colours_;
  std::vector<ContactRef> active_;
  std::vector<std::uint32_t> colourOf_, order_, start_;
  std::vector<std::uint64_t> taken_;  // colours of each body's contacts
  std::uint32_t outsideFrom_ = 0;     // constraints with what does not give way
  std::uint32_t serialFrom_ = 0;      // constraints that found no colour
};

}  // namespace froude
