// The whole state, in a fixed order: checkpoint, resume, undo and the state hash see the same.
#include <array>
#include <initializer_list>

#include <froude/solver/world_impl.h>

namespace froude {
namespace {

// Copied value by value into plain arrays: padding has no defined bits.
template <typename T, std::size_t N>
void archiveFields(Archive& a, std::string_view name, const std::array<T*, N>& fields) {
  std::array<T, N> values;
  for (std::size_t i = 0; i < N; ++i) values[i] = *fields[i];
  a.bytes(name, values.data(), sizeof(T), N);
  for (std::size_t i = 0; i < N; ++i) *fields[i] = values[i];
}

void archiveLedger(Archive& a, Ledger& l) {
  archiveFields(a, "counters",
                std::array{&l.steps, &l.substeps, &l.rejected, &l.particleSteps, &l.sweeps, &l.leaks, &l.crushed,
                           &l.wallHits, &l.quarantined, &l.retired, &l.sunk, &l.expired, &l.emitted, &l.recycled,
                           &l.refused, &l.added, &l.killed});
  a.bytes("limits", l.limits.data(), sizeof l.limits[0], l.limits.size());
  archiveFields(a, "sums",
                std::array{&l.maxDensityError, &l.densityErrorTime, &l.energy0, &l.maxKinetic, &l.work, &l.dissipation,
                           &l.energyDrift, &l.massEmitted, &l.massRetired, &l.momentum0.x(), &l.momentum0.y(),
                           &l.impulse.x(), &l.impulse.y(), &l.maxSpeed});
}

void archiveBalance(Archive& a, Balance& b) {
  archiveFields(
      a, "balance",
      std::array{&b.kinetic, &b.potential, &b.momentum.x(), &b.momentum.y(), &b.mass, &b.maxSpeed, &b.strain});
}

void archiveBodyStates(Archive& a, std::vector<BodyState>& states, AlignedArray<double>& flat) {
  constexpr std::size_t kFields = 12;
  flat.resize(kFields * states.size());
  double* v = flat.data();
  for (const BodyState& s : states) {
    for (const double value :
         {s.transform.position.x(), s.transform.position.y(), s.transform.rotation.c, s.transform.rotation.s, s.angle,
          s.velocity.x(), s.velocity.y(), s.spin, s.force.x(), s.force.y(), s.torque, s.asleep ? 1.0 : 0.0}) {
      *v++ = value;
    }
  }
  a.bytes("states", flat.data(), sizeof(double), flat.size());
  if (!a.loading()) return;
  v = flat.data();
  for (BodyState& s : states) {
    s = {{{v[0], v[1]}, {v[2], v[3]}}, v[4], {v[5], v[6]}, v[7], {v[8], v[9]}, v[10], v[11] != 0.0};
    v += kFields;
  }
}

template <typename Body>
void section(Archive& a, const char* name, Body&& body) {
  a.beginSection(name);
  body();
  a.endSection();
}

}  // namespace

void World::Impl::archive(Archive& a) {
  a.value("time", time);
  section(a, "ledger", [&] { archiveLedger(a, ledger); });
  section(a, "present", [&] { archiveBalance(a, present); });
  std::uint8_t flag = started ? 1 : 0;
  a.value("started", flag);
  started = flag != 0;
  section(a, "bodies", [&] {
    bodies.archive(a);
    if (a.loading()) bodyStates.resize(bodies.size());
    archiveBodyStates(a, bodyStates, flat);
    if (bodies.anyFree()) rigid.archive(bodies, a);
  });
  if (fluid != nullptr) {
    section(a, "fluid", [&] {
      fluid->archive(a);
      fluidModel->archive(a);
    });
  }
  if (bullets != nullptr) section(a, "bullets", [&] { bullets->archive(a); });
  if (soft != nullptr) section(a, "soft", [&] { soft->archive(a); });
  for (std::size_t k = 0; k < emitters.size(); ++k) {
    section(a, ("emitter" + std::to_string(k)).c_str(), [&] { emitters[k].archive(a); });
  }
  if (!sinks.empty()) section(a, "sinks", [&] { sinks.archive(a); });
  if (!a.loading()) return;
  obstacles->rebuild(bodies);
  obstaclesStale = obstaclesBehind = false;
  edited = true;  // measured anew before the next sub-step, which finds no difference unless the caller made one
}

}  // namespace froude
