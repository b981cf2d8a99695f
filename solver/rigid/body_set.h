// The polygons' own motion: fixed ones stand, scripted ones follow their script. Knows no particles.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include <froude/base/archive.h>
#include <froude/base/transform.h>
#include <froude/solver/definitions.h>

namespace froude {

/// Pose and motion of a body over one sub-step.
struct BodyMotion {
  Vec2 position{0, 0};  // of the origin [m]
  double angle = 0.0;   // [rad], not wrapped
  Vec2 velocity{0, 0};  // of the origin [m/s], constant over the sub-step
  double spin = 0.0;    // [rad/s], constant over the sub-step
  Transform transform() const { return Transform::of(position, angle); }
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
  bool moves(std::size_t i) const { return definitions_[i].motion == Motion::Scripted; }
  bool anyMoves() const { return anyMoves_; }

  BodyId id(std::size_t i) const { return {slots_[i], generations_[slots_[i]]}; }
  /// Empty for a null or stale id. Cost: O(1).
  std::optional<std::size_t> indexOf(BodyId id) const;

  /// Appends a body. Throws Error for a definition that cannot work; nothing is changed then.
  BodyId add(BodyDef definition);
  void remove(std::size_t i);
  /// A new pose; velocity and spin stay.
  void place(std::size_t i, const Vec2& position, double angle);
  /// Of a scripted body without script.
  void setVelocity(std::size_t i, const Vec2& velocity, double spin);

  /// Sets each scripted body's velocity and spin to the mean of its script over [t, t + dt] (exact where constant,
  /// midpoint rule in each piece for expressions: error O(dt²)).
  void beginStep(double t, double dt);
  /// Moves the bodies by dt at the velocities of `beginStep`.
  void finishStep(double dt);

  /// Fastest point of any body over the next step [m/s] and largest spin [rad/s].
  double maxSurfaceSpeed() const;
  double maxSpin() const;

  /// Saves motions, ids and the definitions of bodies that were added, but no scripts, which are functions. Loading
  /// makes the bodies that were there then; Error where an added one had a script and is not here with it.
  void archive(Archive& a);

 private:
  static void check(const BodyDef& definition);
  void append(BodyDef definition, std::uint32_t slot);
  void restore(std::span<const std::uint32_t> slots, const std::vector<std::uint32_t>& generations,
               std::span<const std::byte> records);
  bool isOriginal(std::uint32_t slot) const { return slot < originals_.size() && generations_[slot] == 1; }
  void reindex();

  std::vector<BodyDef> originals_;  // what the set was built from: their saved state is an id
  std::vector<BodyDef> definitions_;
  std::vector<BodyMotion> motions_;
  std::vector<double> radius_;              // largest distance of a vertex from the origin [m]
  std::vector<std::uint32_t> slots_;        // by index
  std::vector<std::uint32_t> generations_;  // by slot: odd while it is taken
  std::vector<std::uint32_t> freeSlots_;    // the longest free one first
  std::vector<std::uint32_t> indexOfSlot_;  // by slot, where it is taken
  std::vector<std::byte> records_;          // the saved definitions of added bodies, by index
  bool anyMoves_ = false;
  AlignedArray<double> flat_;  // work space of archive
  std::vector<std::uint32_t> loadedSlots_, loadedGenerations_;
  std::vector<std::byte> loadedRecords_;
};

}  // namespace froude
