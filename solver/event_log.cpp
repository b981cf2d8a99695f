#include <froude/solver/event_log.h>

#include <algorithm>

namespace froude {

void EventLog::clear() {
  contacts_.clear();
  sinks_.clear();
  leaks_.clear();
}

void EventLog::beginAttempt() {
  attemptContacts_ = contacts_.size();
  attemptSinks_ = sinks_.size();
  attemptLeaks_ = leaks_.size();
}

void EventLog::dropAttempt() {
  contacts_.resize(attemptContacts_);
  sinks_.resize(attemptSinks_);
  leaks_.resize(attemptLeaks_);
}

ContactRecorder* EventLog::listenTo(Species species, const ParticlePool& pool, const BodySet& bodies, double time,
                                    double dt) {
  species_ = species;
  pool_ = &pool;
  bodies_ = &bodies;
  time_ = time;
  dt_ = dt;
  speciesBegin_ = contacts_.size();
  return (species == Species::Fluid ? settings.fluidContacts : settings.bulletContacts) ? this : nullptr;
}

void EventLog::add(const ParticleContact& c) {
  if (c.approach < settings.slowestContact) return;
  const BodyId body = c.body >= 0 ? bodies_->id(static_cast<std::size_t>(c.body)) : BodyId{};
  contacts_.push_back(
      {species_, pool_->handleAt(c.particle), body, c.point, c.normal, c.approach, time_ + c.time * dt_});
}

void EventLog::add(const ParticleLeak& leak) {
  const bool ofBody = !leak.inside && leak.body >= 0;
  const BodyId body = ofBody ? bodies_->id(static_cast<std::size_t>(leak.body)) : BodyId{};
  leaks_.push_back({species_, pool_->handleAt(leak.particle), body, leak.from, leak.to,
                    leak.inside ? leak.to : leak.entered, 0.0, time_ + dt_, leak.inside});
}

void EventLog::finishSpecies() {
  const auto begin = contacts_.begin() + static_cast<std::ptrdiff_t>(speciesBegin_);
  // Fluids meet walls twice in a sub-step, on their free and on their solved path, and are sorted by cell in between.
  std::stable_sort(begin, contacts_.end(),
                   [](const ContactEvent& a, const ContactEvent& b) { return a.particle.slot < b.particle.slot; });
  if (species_ != Species::Fluid) return;
  auto kept = begin, ofParticle = begin;
  for (auto e = begin; e != contacts_.end(); ++e) {
    if (kept == begin || ofParticle->particle != e->particle) ofParticle = kept;
    const bool known = std::any_of(
        ofParticle, kept, [&](const ContactEvent& k) { return k.particle == e->particle && k.body == e->body; });
    if (!known) *kept++ = *e;
  }
  contacts_.erase(kept, contacts_.end());
}

}  // namespace froude
