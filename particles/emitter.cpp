#include <froude/particles/emitter.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include <froude/base/transform.h>

namespace froude {
namespace {

// A length that is a whole number of spacings up to rounding counts as that number.
constexpr double kRounding = 1e-9;

// Events this much of an interval before t0 are still due: step ends and event times are rounded differently.
constexpr double kLate = 1e-6;

[[noreturn]] void refuse(const EmitterDef& def, const std::string& what) {
  throw EmitterError("emitter '" + def.name + "': " + what);
}

void check(const EmitterDef& def, double spacing) {
  const bool fluid = def.kind == EmitterDef::Kind::Fluid;
  if (!def.from.allFinite() || !def.to.allFinite()) refuse(def, "the ends of the nozzle must be finite numbers");
  if (def.from == def.to) refuse(def, "the nozzle has no length, so no direction; 'from' and 'to' must differ");
  if (!std::isfinite(def.speed) || def.speed < 0.0) refuse(def, "speed must be a finite number ≥ 0 m/s");
  if (fluid && def.speed == 0.0)
    refuse(def, "a fluid needs a speed above 0 m/s, or no row ever makes room for the next");
  if (fluid && !(spacing > 0.0 && std::isfinite(spacing))) refuse(def, "the spacing must be a positive number");
  if (fluid && (def.to - def.from).norm() < spacing * (1.0 - kRounding)) {
    refuse(def, "the nozzle is " + std::to_string((def.to - def.from).norm()) +
                    " m long, shorter than one spacing of " + std::to_string(spacing) +
                    " m; make it longer or the spacing smaller");
  }
  if (!fluid && !(def.rate > 0.0 && std::isfinite(def.rate)))
    refuse(def, "rate must be a positive number of bullets/s");
  if (!fluid && !(def.spread >= 0.0 && def.spread <= kPi)) refuse(def, "spread must be within 0 … 180 degrees");
  if (!std::isfinite(def.start) || !(def.stop > def.start)) refuse(def, "stop must be later than start");
  if (!(def.lifetime > 0.0)) refuse(def, "lifetime must be above 0 s; leave it out for particles that stay");
  if (def.limit == 0) refuse(def, "a limit of 0 lets nothing in; it must be at least 1");
}

}  // namespace

Emitter::Emitter(EmitterDef def, double spacing, std::uint64_t seed, std::uint64_t index)
    : def_(std::move(def)),
      section_(def_.name + "." + std::to_string(index)),
      spacing_(spacing),
      seed_(seed),
      index_(index) {
  check(def_, spacing);
  const Vec2 along = def_.to - def_.from;
  direction_ = leftNormal(along).normalized();
  if (def_.kind == EmitterDef::Kind::Fluid) {
    interval_ = spacing / def_.speed;
    perEvent_ = static_cast<std::size_t>(std::floor(along.norm() / spacing * (1.0 + kRounding)));
  } else {
    interval_ = 1.0 / def_.rate;
    perEvent_ = 1;
  }
}

double Emitter::eventTime(std::uint64_t event) const { return def_.start + static_cast<double>(event) * interval_; }

std::uint64_t Emitter::firstEventAtOrAfter(double time) const {
  if (!(time > def_.start)) return 0;
  const double guess = std::floor((time - def_.start) / interval_);
  constexpr double kMost = 9.0e15;  // beyond it a double no longer counts one by one
  auto event = static_cast<std::uint64_t>(std::clamp(guess - 1.0, 0.0, kMost));
  while (static_cast<double>(event) < kMost && eventTime(event) < time) ++event;
  return event;
}

Emitter::Span Emitter::due(double t0, double dt) const {
  const std::uint64_t first = std::max(nextEvent_, firstEventAtOrAfter(t0 - kLate * interval_));
  return {first, std::max(first, firstEventAtOrAfter(std::min(t0 + dt, def_.stop)))};
}

std::size_t Emitter::pending(double t0, double dt) const {
  const Span span = due(t0, dt);
  return static_cast<std::size_t>(span.end - span.first) * perEvent_;
}

std::size_t Emitter::room(std::size_t live) const {
  if (def_.policy != GrowthPolicy::Fixed) return static_cast<std::size_t>(-1);
  return def_.limit > live ? def_.limit - live : 0;
}

std::size_t Emitter::emit(double t0, double dt, Place place, std::size_t room) {
  const Span span = due(t0, dt);
  const Vec2 along = (def_.to - def_.from).normalized();
  const Vec2 middle = 0.5 * (def_.from + def_.to);
  std::size_t placed = 0;
  for (std::uint64_t event = span.first; event < span.end; ++event) {
    const double age = std::max(0.0, t0 + dt - eventTime(event));
    const std::size_t count = std::min(perEvent_, room - placed);
    refused_ += perEvent_ - count;
    if (def_.kind == EmitterDef::Kind::Bullet) {
      if (count == 0) continue;
      RandomStream random(seed_, index_);
      random.setCounter(2 * event);
      const Vec2 start = def_.from + random.uniform() * (def_.to - def_.from);
      const Rotation turn = Rotation::of(random.uniform(-def_.spread, def_.spread));
      const Vec2 velocity = def_.speed * turn.apply(direction_);
      place(start + age * velocity, velocity);
    } else {
      const Vec2 velocity = def_.speed * direction_;
      const double firstOffset = -0.5 * static_cast<double>(perEvent_ - 1) * spacing_;
      for (std::size_t k = 0; k < count; ++k) {
        place(middle + (firstOffset + static_cast<double>(k) * spacing_) * along + age * velocity, velocity);
      }
    }
    placed += count;
  }
  nextEvent_ = span.end;
  return placed;
}

void Emitter::archive(Archive& archive) {
  archive.beginSection(section_);
  archive.value("events", nextEvent_);
  archive.value("refused", refused_);
  archive.endSection();
}

}  // namespace froude
