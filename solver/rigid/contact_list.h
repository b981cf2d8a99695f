// The pairs of convex pieces that may touch, and what each pair remembers from step to step.
#pragma once

#include <memory>
#include <vector>

#include <froude/base/crew.h>
#include <froude/fields/world_field.h>
#include <froude/solver/contact/contact_manifold.h>
#include <froude/solver/rigid/body_set.h>

namespace froude {

/// A convex piece of a body, or a wall of the domain.
struct Proxy {
  const ConvexShape* shape = nullptr;
  std::uint32_t body = 0;  // index; BodySet::size() for the domain
  std::uint64_t key = 0;   // by slot of the body and piece: lasts while bodies come and go; walls come last
};

/// One point of a contact and the forces that it bore in its last sub-step [N/m].
struct ContactPoint {
  Vec2 at{0, 0};            // world [m], when it was found
  double separation = 0.0;  // [m]
  double normalForce = 0.0, tangentForce = 0.0;
  std::uint32_t id = 0;
};

/// A pair whose boxes are near each other.
struct Contact {
  std::uint32_t a = 0, b = 0;          // proxies, a's key below b's
  std::uint32_t bodyA = 0, bodyB = 0;  // their bodies
  PairCache cache;
  std::uint32_t count = 0;  // of points
  Vec2 normal{0, 0};        // from A to B, world
  std::array<ContactPoint, 2> points;
};

/// Which contact, and between whom: what passes over all of them read, without the contacts themselves.
struct ContactRef {
  std::uint32_t contact = 0, bodyA = 0, bodyB = 0;
};

/// Where the bodies are at the start of a step, and how far each may get.
struct BodyPoses {
  std::vector<Transform> pose;      // by body; the domain's last
  std::vector<Vec2> drift;          // of the frame's origin in the step [m]
  std::vector<double> spread;       // how far any of its points may be from where the drift takes it [m]
  std::vector<double> thickness;    // of bodies that contacts move, else infinite [m]
  std::vector<std::uint8_t> still;  // asleep, or never moved by contacts

  /// How far apart two bodies may be that get contact points [m]. What is farther may still meet in the step, when it
  /// is fast or is thrown: that is a matter of continuous motion.
  double margin(std::uint32_t a, std::uint32_t b) const { return 0.3 * std::min(thickness[a], thickness[b]); }
};

/// Contacts in the order of their keys, whatever history led to them. Sleepers keep theirs as they are.
class ContactList {
 public:
  /// The pieces of all bodies; contacts between pieces that are still there are kept. Cost: convex pieces of shapes
  /// that are new, and what `update` costs when it pairs anew.
  void rebuild(const DomainDef& domain, const BodySet& bodies);

  /// Finds the points of all pairs that may touch in the step. Boxes have a margin, so pairs are looked for anew only
  /// when one has left its own. Cost: pairs; when looking anew, pieces × those that overlap them along x.
  void update(const BodySet& bodies, const BodyPoses& poses, Crew& crew);

  std::vector<Contact>& contacts() { return contacts_; }
  const std::vector<Contact>& contacts() const { return contacts_; }
  /// Of the last `update`, in the order of the list: those with points, and those without.
  const std::vector<ContactRef>& touching() const { return touching_; }
  const std::vector<ContactRef>& apart() const { return apart_; }
  const ConvexShape& shape(std::uint32_t proxy) const { return *proxies_[proxy].shape; }
  /// Smallest inner radius of a body's pieces [m].
  double thickness(std::size_t body) const { return thickness_[body]; }

  /// Pairs, their memory and the boxes that they were found with.
  void archive(Archive& a);

 private:
  struct Shape {
    std::shared_ptr<const Polygon> polygon;
    std::vector<ConvexShape> pieces;
  };
  void findReach(const BodyPoses& poses, Crew& crew);
  bool leftItsBox() const;
  void pairAnew(const BodySet& bodies);
  void sweepAlongX(const BodySet& bodies);
  void sortByKey();
  void sortAlongX();
  void collide(Contact& contact, const BodyPoses& poses) const;
  void flatten();
  void restore();

  std::vector<std::unique_ptr<Shape>> shapes_;
  std::unique_ptr<Shape> walls_;
  std::vector<Proxy> proxies_;
  std::vector<double> thickness_;
  std::vector<Box> reach_, fat_;  // by proxy: over the step with all of its travel, and for some steps [m]
  std::vector<Contact> contacts_, before_;
  std::vector<ContactRef> touching_, apart_;
  std::vector<std::uint32_t> order_;         // proxies along x
  std::vector<std::uint32_t> byKey_, rank_;  // proxies by key, and each one's place there
  std::vector<Box> sorted_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> found_;  // ranks
  std::vector<std::uint32_t> start_, partner_;
  bool stale_ = true;                      // boxes are to be made anew
  std::vector<std::uint32_t> savedPairs_;  // work space of archive
  std::vector<double> savedPoints_, savedBoxes_;
};

}  // namespace froude
