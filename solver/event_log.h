// The events of a step while it runs: contacts as the models book them, thrown away with a step that is undone.
#pragma once

#include <span>
#include <vector>

#include <froude/solver/events.h>
#include <froude/solver/rigid/body_set.h>
#include <froude/solver/step_context.h>

namespace froude {

class EventLog final : public ContactRecorder, public LeakRecorder {
 public:
  EventSettings settings;

  /// A new step: forgets the last one's events.
  void clear();
  /// An attempt at a sub-step begins; `dropAttempt` forgets its events.
  void beginAttempt();
  void dropAttempt();

  /// The pool whose contacts come next; null if they are not wanted. [time, time + dt] is the sub-step [s].
  ContactRecorder* listenTo(Species species, const ParticlePool& pool, const BodySet& bodies, double time, double dt);
  /// Null if leaks are not wanted. They are of the pool that was named last.
  LeakRecorder* leakRecorder() { return settings.leaks ? this : nullptr; }
  void add(const ParticleContact& contact) override;
  void add(const ParticleLeak& leak) override;
  /// The species is through: brings its contacts of this sub-step into order, by particle's slot and then as they came.
  void finishSpecies();

  void addSink(const SinkEvent& event) { sinks_.push_back(event); }

  std::span<const ContactEvent> contacts() const { return contacts_; }
  std::span<const SinkEvent> sinks() const { return sinks_; }
  std::span<const LeakEvent> leaks() const { return leaks_; }
  /// Those of the present attempt; of what is inside, body, boundary and depth are for the world to fill in.
  std::span<LeakEvent> freshLeaks() { return std::span(leaks_).subspan(attemptLeaks_); }

 private:
  std::vector<ContactEvent> contacts_;
  std::vector<SinkEvent> sinks_;
  std::vector<LeakEvent> leaks_;
  std::size_t attemptContacts_ = 0, attemptSinks_ = 0, attemptLeaks_ = 0, speciesBegin_ = 0;
  Species species_ = Species::Fluid;
  const ParticlePool* pool_ = nullptr;
  const BodySet* bodies_ = nullptr;
  double time_ = 0.0, dt_ = 0.0;
};

}  // namespace froude
