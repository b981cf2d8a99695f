// The bodies: what they are made of, where they are, how they move. Fixed ones stand, scripted ones follow their
// script, free ones are moved by the rigid solver. Knows no particles.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include <froude/base/archive.h>
#include <froude/base/transform.h>
#include <froude/solver/definitions.h>

namespace froude {

/// Pose and motion of a body's frame over one sub-step. The frame is that of the definition; a free body's has its
/// origin in the centre of mass, so that it turns about its origin.
struct BodyMotion {
  Vec2 position{0, 0};  // of the frame's origin [m]
  double angle = 0.0;   // [rad], not wrapped
  Vec2 velocity{0, 0};  // of the frame's origin [m/s], constant over the sub-step
  double spin = 0.0;    // [rad/s], constant over the sub-step
  Transform transform() const { return Transform::of(position, angle); }
};

/// What a free body's motion depends on beside its pose. Zero for others.
struct FreeState {
  Vec2 velocity{0, 0};          // of the centre of mass [m/s]
  double spin = 0.0;            // [rad/s]
  double stillFor = 0.0;        // [s] that it has hardly moved
  double asleep = 0.0;          // 1: it rests, and so does all that it touches
  Vec2 pressure{0, 0};          // force of the fluid's pressure over the last sub-step [N/m]
  double pressureTorque = 0.0;  // about the centre of mass [N]
};

/// Of the whole body, per metre of depth; inverse 0 for what is not free.
struct MassData {
  double mass = 0.0;     // [kg/m]
  double inertia = 0.0;  // about the centre of mass [kg·m]
  double inverseMass = 0.0, inverseInertia = 0.0;
};

/// Bodies by index, in the order of their making: those of the definitions first. Removing one moves the later ones
/// down; ids last.
class BodySet {
 public:
  /// Throws Error for a definition that cannot work.
  explicit BodySet(std::vector<BodyDef> definitions);

  std::size_t size() const { return definitions_.size(); }
  const BodyDef& definition(std::size_t i) const { return definitions_[i]; }
  const BodyMotion& motion(std::size_t i) const { return motions_[i]; }
  /// The body's polygon in its frame.
  const std::shared_ptr<const Polygon>& shape(std::size_t i) const { return shapes_[i]; }
  /// The frame's origin in the definition's own coordinates: the centroid of a free body, else 0.
  const Vec2& frameOrigin(std::size_t i) const { return frameOrigins_[i]; }
  const MassData& mass(std::size_t i) const { return masses_[i]; }
  const FreeState& freeState(std::size_t i) const { return freeStates_[i]; }
  FreeState& freeState(std::size_t i) { return freeStates_[i]; }
  /// Sets the free body's motion over the sub-step; `finishStep` carries it out.
  void setMotion(std::size_t i, const Vec2& velocity, double spin) {
    motions_[i].velocity = velocity;
    motions_[i].spin = spin;
  }
  /// The hinge's place in the frame of the body. Precondition: it has one.
  const Vec2& hingeAnchor(std::size_t i) const { return hingeAnchors_[i]; }
  /// Radius of a disc of the same ratio of area to outline [m]: small for what is thin.
  double thickness(std::size_t i) const { return thickness_[i]; }
  /// Largest distance of a vertex from the frame's origin [m].
  double radius(std::size_t i) const { return radius_[i]; }

  bool isFree(std::size_t i) const { return definitions_[i].motion == Motion::Free; }
  bool moves(std::size_t i) const { return definitions_[i].motion != Motion::Fixed; }
  bool anyMoves() const { return anyMoves_; }
  bool anyFree() const { return anyFree_; }
  /// Rises whenever bodies come, go or are put elsewhere.
  std::uint64_t version() const { return version_; }

  BodyId id(std::size_t i) const { return {slots_[i], generations_[slots_[i]]}; }
  /// Empty for a null or stale id. Cost: O(1).
  std::optional<std::size_t> indexOf(BodyId id) const;

  /// Appends a body. Throws Error for a definition that cannot work; nothing is changed then.
  BodyId add(BodyDef definition);
  void remove(std::size_t i);
  /// A new pose of the definition's frame; velocity and spin stay, a sleeper wakes.
  void place(std::size_t i, const Vec2& position, double angle);
  /// Of a scripted body without script, or of a free one (its centre of mass), which wakes.
  void setVelocity(std::size_t i, const Vec2& velocity, double spin);
  void wake(std::size_t i);

  /// Sets each scripted body's velocity and spin to the mean of its script over [t, t + dt] (exact where constant,
  /// midpoint rule in each piece for expressions: error O(dt²)).
  void beginStep(double t, double dt);
  /// Moves the bodies by dt at the velocities of `beginStep` and `setMotion`.
  void finishStep(double dt);

  /// Fastest point of any body over the next step [m/s] and largest spin [rad/s].
  double maxSurfaceSpeed() const;
  double maxSpin() const;

  /// Saves motions, ids and the definitions of bodies that were added, but no scripts, which are functions. Loading
  /// makes the bodies that were there then; Error where an added one had a script and is not here with it.
  void archive(Archive& a);

 private:
  static void check(const BodyDef& definition);
  std::shared_ptr<const Polygon> frameShape(const BodyDef& definition) const;
  void append(BodyDef definition, std::uint32_t slot);
  void restore(std::span<const std::uint32_t> slots, const std::vector<std::uint32_t>& generations,
               std::span<const std::byte> records);
  bool isOriginal(std::uint32_t slot) const { return slot < originals_.size() && generations_[slot] == 1; }
  void reindex();

  std::vector<BodyDef> originals_;  // what the set was built from: their saved state is an id
  std::vector<BodyDef> definitions_;
  std::vector<BodyMotion> motions_;
  std::vector<std::shared_ptr<const Polygon>> shapes_;
  std::vector<Vec2> frameOrigins_, hingeAnchors_;
  std::vector<MassData> masses_;
  std::vector<FreeState> freeStates_;
  std::vector<double> radius_, thickness_;
  std::vector<std::uint32_t> slots_;        // by index
  std::vector<std::uint32_t> generations_;  // by slot: odd while it is taken
  std::vector<std::uint32_t> freeSlots_;    // the longest free one first
  std::vector<std::uint32_t> indexOfSlot_;  // by slot, where it is taken
  std::vector<std::byte> records_;          // the saved definitions of added bodies, by index
  bool anyMoves_ = false, anyFree_ = false;
  std::uint64_t version_ = 0;
  AlignedArray<double> flat_;  // work space of archive
  std::vector<std::uint32_t> loadedSlots_, loadedGenerations_;
  std::vector<std::byte> loadedRecords_;
};

}  // namespace froude
