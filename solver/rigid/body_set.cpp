#include <froude/solver/rigid/body_set.h>

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

BodySet::BodySet(std::vector<BodyDef> definitions) : definitions_(std::move(definitions)) {
  for (const BodyDef& def : definitions_) {
    if (def.shape == nullptr) throw Error("body '" + def.name + "' has no shape");
    if (def.motion == Motion::Free)
      throw Error("body '" + def.name + "': free bodies are not in this version; use fixed or scripted");
    BodyMotion motion{def.position, def.angle, {0.0, 0.0}, 0.0};
    if (def.motion == Motion::Scripted && def.script.empty()) {
      motion.velocity = def.velocity;
      motion.spin = def.spin;
    }
    motions_.push_back(motion);
    double radius = 0.0;
    for (const Vec2& v : def.shape->vertices()) radius = std::max(radius, v.norm());
    radius_.push_back(radius);
    anyMoves_ = anyMoves_ || def.motion == Motion::Scripted;
  }
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
    if (moves(i)) speed = std::max(speed, motions_[i].velocity.norm() + std::abs(motions_[i].spin) * radius_[i]);
  }
  return speed;
}

double BodySet::maxSpin() const {
  double spin = 0.0;
  for (const BodyMotion& m : motions_) spin = std::max(spin, std::abs(m.spin));
  return spin;
}

void BodySet::archive(Archive& a) {
  const std::size_t n = a.count("count", motions_.size());
  if (n != motions_.size())
    throw Error("the saved state has " + std::to_string(n) + " bodies, this world " + std::to_string(motions_.size()));
  constexpr std::size_t kFields = 6;
  flat_.resize(kFields * n);
  for (std::size_t i = 0; i < n; ++i) {
    const BodyMotion& m = motions_[i];
    double* v = flat_.data() + kFields * i;
    v[0] = m.position.x(), v[1] = m.position.y(), v[2] = m.angle;
    v[3] = m.velocity.x(), v[4] = m.velocity.y(), v[5] = m.spin;
  }
  a.bytes("motions", flat_.data(), sizeof(double), flat_.size());
  if (!a.loading()) return;
  for (std::size_t i = 0; i < n; ++i) {
    const double* v = flat_.data() + kFields * i;
    motions_[i] = {{v[0], v[1]}, v[2], {v[3], v[4]}, v[5]};
  }
}

}  // namespace froude
