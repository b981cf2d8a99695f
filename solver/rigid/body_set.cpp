#include <froude/solver/rigid/body_set.h>

#include <algorithm>
#include <array>

#include <froude/solver/rigid/body_record.h>

namespace froude {
namespace {

double valueAt(const TimeFunction& f, double t) { return f ? f(t) : 0.0; }

// Means over [t, t + dt] of a script that is at rest after its last piece.
void scriptMeans(const std::vector<ScriptPiece>& script, double t, double dt, BodyMotion& motion) {
  motion.velocity = {0.0, 0.0};
  motion.spin = 0.0;
  double begin = t;
  for (const ScriptPiece& piece : script) {
    if (piece.until <= begin) continue;
    const double end = std::min(piece.until, t + dt);
    const double share = (end - begin) / dt;
    const double mid = 0.5 * (begin + end);
    motion.velocity += share * Vec2(valueAt(piece.velocityX, mid), valueAt(piece.velocityY, mid));
    motion.spin += share * valueAt(piece.spin, mid);
    begin = end;
    if (begin >= t + dt) break;
  }
}

}  // namespace

void BodySet::check(const BodyDef& def) {
  auto refuse = [&](const std::string& why) { throw Error("body '" + def.name + "' " + why); };
  if (def.shape == nullptr) refuse("has no shape");
  if (!def.position.allFinite() || !std::isfinite(def.angle)) refuse("has a pose that is not finite");
  if (!def.velocity.allFinite() || !std::isfinite(def.spin) || !std::isfinite(def.surfaceVelocity)) {
    refuse("has a velocity that is not finite");
  }
  if (!(def.friction >= 0.0)) refuse("needs a friction of at least 0");
  if (!(def.restitution >= 0.0 && def.restitution <= 1.0)) refuse("needs a restitution between 0 and 1");
  if (def.motion != Motion::Free) {
    if (def.hinge) refuse("has a hinge, which holds free bodies only; make it free");
    return;
  }
  if (!(def.density > 0.0) || !std::isfinite(def.density)) refuse("is free and needs a density above 0 kg/m²");
  if (!(def.shape->area() > 0.0)) refuse("is free and has no area, so no mass");
  if (!def.script.empty()) refuse("is free and cannot have a script; make it scripted");
  if (!def.hinge) return;
  if (!def.hinge->at.allFinite()) refuse("has a hinge at a place that is not finite");
  if (def.hinge->motor && !(def.hinge->motor->torque >= 0.0 && std::isfinite(def.hinge->motor->speed))) {
    refuse("has a motor that needs a finite speed and a torque of at least 0");
  }
}

// A free body's polygon about its centroid. Copies of one shape share one.
std::shared_ptr<const Polygon> BodySet::frameShape(const BodyDef& def) const {
  if (def.motion != Motion::Free) return def.shape;
  for (std::size_t i = size(); i-- > 0;) {
    if (isFree(i) && definitions_[i].shape == def.shape) return shapes_[i];
  }
  return std::make_shared<const Polygon>(def.shape->transformed({-def.shape->centroid(), Rotation()}));
}

BodySet::BodySet(std::vector<BodyDef> definitions) : originals_(std::move(definitions)) {
  for (const BodyDef& def : originals_) {
    check(def);
    const auto slot = static_cast<std::uint32_t>(generations_.size());
    generations_.push_back(1);
    append(def, slot);
  }
  reindex();
}

void BodySet::append(BodyDef def, std::uint32_t slot) {
  const bool free = def.motion == Motion::Free;
  const Vec2 origin = free ? def.shape->centroid() : Vec2(0.0, 0.0);
  const Transform pose = Transform::of(def.position, def.angle);
  BodyMotion motion{free ? pose.toWorld(origin) : def.position, def.angle, {0.0, 0.0}, 0.0};
  if (free || (def.motion == Motion::Scripted && def.script.empty())) {
    motion.velocity = def.velocity;
    motion.spin = def.spin;
  }
  shapes_.push_back(frameShape(def));
  double radius = 0.0;
  for (const Vec2& v : shapes_.back()->vertices()) radius = std::max(radius, v.norm());
  motions_.push_back(motion);
  radius_.push_back(radius);
  double outline = 0.0;
  for (std::uint32_t e = 0; e < def.shape->edgeCount(); ++e)
    outline += (def.shape->edgeEnd(e) - def.shape->edgeStart(e)).norm();
  thickness_.push_back(2.0 * def.shape->area() / outline);
  frameOrigins_.push_back(origin);
  hingeAnchors_.push_back(def.hinge ? Vec2(pose.toLocal(def.hinge->at) - origin) : Vec2(0.0, 0.0));
  MassData mass;
  if (free) {
    mass.mass = def.density * def.shape->area();
    mass.inertia = def.density * shapes_.back()->secondMoment();
    mass.inverseMass = 1.0 / mass.mass;
    mass.inverseInertia = 1.0 / mass.inertia;
  }
  masses_.push_back(mass);
  freeStates_.push_back({});
  if (free) freeStates_.back().velocity = def.velocity, freeStates_.back().spin = def.spin;
  slots_.push_back(slot);
  definitions_.push_back(std::move(def));
}

// What follows from definitions and slots.
void BodySet::reindex() {
  indexOfSlot_.resize(generations_.size());
  records_.clear();
  anyMoves_ = anyFree_ = false;
  ++version_;
  for (std::size_t i = 0; i < size(); ++i) {
    indexOfSlot_[slots_[i]] = static_cast<std::uint32_t>(i);
    if (!isOriginal(slots_[i])) writeBodyRecord(definitions_[i], &records_);
    anyMoves_ = anyMoves_ || moves(i);
    anyFree_ = anyFree_ || isFree(i);
  }
}

std::optional<std::size_t> BodySet::indexOf(BodyId id) const {
  const bool live =
      id.slot < generations_.size() && (id.generation & 1u) != 0 && generations_[id.slot] == id.generation;
  return live ? std::optional<std::size_t>(indexOfSlot_[id.slot]) : std::nullopt;
}

BodyId BodySet::add(BodyDef def) {
  check(def);
  std::uint32_t slot = 0;
  if (freeSlots_.empty()) {
    slot = static_cast<std::uint32_t>(generations_.size());
    generations_.push_back(0);
  } else {
    slot = freeSlots_.front();
    freeSlots_.erase(freeSlots_.begin());
  }
  ++generations_[slot];
  append(std::move(def), slot);
  indexOfSlot_.resize(generations_.size());
  indexOfSlot_[slot] = static_cast<std::uint32_t>(size() - 1);
  writeBodyRecord(definitions_.back(), &records_);
  anyMoves_ = anyMoves_ || moves(size() - 1);
  anyFree_ = anyFree_ || isFree(size() - 1);
  ++version_;
  return {slot, generations_[slot]};
}

void BodySet::remove(std::size_t i) {
  const auto at = static_cast<std::ptrdiff_t>(i);
  ++generations_[slots_[i]];
  freeSlots_.push_back(slots_[i]);
  definitions_.erase(definitions_.begin() + at);
  motions_.erase(motions_.begin() + at);
  radius_.erase(radius_.begin() + at);
  thickness_.erase(thickness_.begin() + at);
  shapes_.erase(shapes_.begin() + at);
  frameOrigins_.erase(frameOrigins_.begin() + at);
  hingeAnchors_.erase(hingeAnchors_.begin() + at);
  masses_.erase(masses_.begin() + at);
  freeStates_.erase(freeStates_.begin() + at);
  slots_.erase(slots_.begin() + at);
  reindex();
}

void BodySet::place(std::size_t i, const Vec2& position, double angle) {
  motions_[i].position = Transform::of(position, angle).toWorld(frameOrigins_[i]);
  motions_[i].angle = angle;
  wake(i);
  ++version_;
}

void BodySet::setVelocity(std::size_t i, const Vec2& velocity, double spin) {
  motions_[i].velocity = velocity;
  motions_[i].spin = spin;
  if (!isFree(i)) return;
  freeStates_[i].velocity = velocity;
  freeStates_[i].spin = spin;
  wake(i);
}

void BodySet::wake(std::size_t i) {
  freeStates_[i].stillFor = 0.0;
  freeStates_[i].asleep = 0.0;
}

void BodySet::beginStep(double t, double dt) {
  if (!anyMoves_) return;
  for (std::size_t i = 0; i < size(); ++i) {
    if (moves(i) && !definitions_[i].script.empty()) scriptMeans(definitions_[i].script, t, dt, motions_[i]);
  }
}

void BodySet::finishStep(double dt) {
  if (!anyMoves_) return;
  for (std::size_t i = 0; i < size(); ++i) {
    if (!moves(i)) continue;
    motions_[i].position += dt * motions_[i].velocity;
    motions_[i].angle += dt * motions_[i].spin;
  }
}

double BodySet::maxSurfaceSpeed() const {
  double speed = 0.0;
  for (std::size_t i = 0; i < size(); ++i) {
    if (!moves(i)) continue;
    const Vec2& v = isFree(i) ? freeStates_[i].velocity : motions_[i].velocity;
    const double w = isFree(i) ? freeStates_[i].spin : motions_[i].spin;
    speed = std::max(speed, v.norm() + std::abs(w) * radius_[i]);
  }
  return speed;
}

double BodySet::maxSpin() const {
  double spin = 0.0;
  for (std::size_t i = 0; i < size(); ++i) {
    spin = std::max(spin, std::abs(isFree(i) ? freeStates_[i].spin : motions_[i].spin));
  }
  return spin;
}

void BodySet::restore(std::span<const std::uint32_t> slots, const std::vector<std::uint32_t>& generations,
                      std::span<const std::byte> records) {
  // Another set until all is read, so that an error leaves this one as it was.
  BodySet loaded({});
  loaded.originals_ = originals_;
  loaded.generations_ = generations;
  for (const std::uint32_t slot : slots) {
    if (slot >= generations.size() || (generations[slot] & 1u) == 0) throw Error("saved bodies: the state is damaged");
    if (loaded.isOriginal(slot)) {
      loaded.append(originals_[slot], slot);
      continue;
    }
    BodyRecord record = readBodyRecord(records);
    if (record.scriptPieces > 0) {
      const std::optional<std::size_t> here = indexOf({slot, generations[slot]});
      if (!here || definitions_[*here].script.size() != record.scriptPieces) {
        throw Error("body '" + record.definition.name +
                    "' was created by a call and has a script, which is a function and is not saved; create it here "
                    "before the state is loaded");
      }
      record.definition.script = definitions_[*here].script;
    }
    records = records.subspan(record.size);
    loaded.append(std::move(record.definition), slot);
  }
  definitions_ = std::move(loaded.definitions_);
  motions_ = std::move(loaded.motions_);
  radius_ = std::move(loaded.radius_);
  thickness_ = std::move(loaded.thickness_);
  shapes_ = std::move(loaded.shapes_);
  frameOrigins_ = std::move(loaded.frameOrigins_);
  hingeAnchors_ = std::move(loaded.hingeAnchors_);
  masses_ = std::move(loaded.masses_);
  freeStates_ = std::move(loaded.freeStates_);
  slots_ = std::move(loaded.slots_);
  generations_ = generations;
  reindex();
}

void BodySet::archive(Archive& a) {
  const std::size_t originals = a.count("originals", originals_.size());
  if (originals != originals_.size()) {
    throw Error("the saved state began with " + std::to_string(originals) + " bodies, this world with " +
                std::to_string(originals_.size()));
  }
  loadedSlots_ = slots_;
  loadedGenerations_ = generations_;
  loadedRecords_ = records_;
  a.array("slots", loadedSlots_);
  a.array("generations", loadedGenerations_);
  a.array("created", loadedRecords_);
  if (a.loading() && (loadedSlots_ != slots_ || loadedGenerations_ != generations_ || loadedRecords_ != records_)) {
    restore(loadedSlots_, loadedGenerations_, loadedRecords_);
  }
  a.array("free", freeSlots_);
  const std::size_t n = size();
  constexpr std::size_t kFields = 14;
  flat_.resize(kFields * n);
  for (std::size_t i = 0; i < n; ++i) {
    const BodyMotion& m = motions_[i];
    const FreeState& f = freeStates_[i];
    const std::array<double, kFields> values{
        m.position.x(), m.position.y(), m.angle,    m.velocity.x(), m.velocity.y(), m.spin,         f.velocity.x(),
        f.velocity.y(), f.spin,         f.stillFor, f.asleep,       f.pressure.x(), f.pressure.y(), f.pressureTorque};
    std::copy(values.begin(), values.end(), flat_.data() + kFields * i);
  }
  a.bytes("motions", flat_.data(), sizeof(double), flat_.size());
  if (!a.loading()) return;
  for (std::size_t i = 0; i < n; ++i) {
    const double* v = flat_.data() + kFields * i;
    motions_[i] = {{v[0], v[1]}, v[2], {v[3], v[4]}, v[5]};
    freeStates_[i] = {{v[6], v[7]}, v[8], v[9], v[10], {v[11], v[12]}, v[13]};
  }
}

}  // namespace froude
