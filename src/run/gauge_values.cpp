#include "run/gauge_values.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include <froude/base/parallel.h>
#include "scene/material_point.h"

namespace froude::run {
namespace {

using scene::GaugeDef;

struct Part {
  const char* name;  // "" for the gauge's own column
  const char* unit;
};

/// What a type of gauge looks like and how it is read. `profile` and the window of `pressure` add columns of their own.
struct Type {
  const char* name;
  std::vector<Part> parts;
  std::function<void(const GaugeDef&, std::size_t body, GaugeInput&, std::span<double>)> read;
};

void put(std::span<double> out, const Vec2& v) {
  out[0] = v.x();
  out[1] = v.y();
}

double front(const GaugeDef& def, const World& world) {
  const ParticlePool* fluid = world.fluid();
  if (fluid == nullptr) return std::nan("");
  const std::span<const double> values = def.axis == 'y' ? fluid->y() : fluid->x();
  return quantile({values.begin(), values.end()}, def.quantile);
}

Vec2 profilePoint(const GaugeDef& def, int k) {
  const double t = def.count > 1 ? static_cast<double>(k) / (def.count - 1) : 0.0;
  return (1.0 - t) * def.from + t * def.to;
}

/// Largest and mean compression max(0, ρ/ρ0 − 1) of the fluid's particles; 0 without particles.
void densityError(const World& world, std::span<double> out) {
  out[0] = out[1] = 0.0;
  const ParticlePool* fluid = world.fluid();
  if (fluid == nullptr || fluid->empty()) return;
  const auto id = fluid->findColumn<float>("density");
  if (!id) {
    out[0] = out[1] = std::nan("");
    return;
  }
  const std::span<const float> density = fluid->column(*id);
  const auto error = [&](std::size_t i) { return std::max(0.0, static_cast<double>(density[i]) - 1.0); };
  out[0] = parallelMax(density.size(), 0.0, [&](std::size_t begin, std::size_t end) {
    double largest = 0.0;
    for (std::size_t i = begin; i < end; ++i) largest = std::max(largest, error(i));
    return largest;
  });
  out[1] = parallelSum(density.size(), [&](std::size_t begin, std::size_t end) {
    double sum = 0.0;
    for (std::size_t i = begin; i < end; ++i) sum += error(i);
    return sum;
  });
  out[1] /= static_cast<double>(density.size());
}

void energy(const GaugeDef& def, const World& world, std::span<double> out) {
  const Totals t = world.totals(def.species);
  out[0] = t.kinetic;
  out[1] = t.potential;
  out[2] = t.strain;
  out[3] = t.kinetic + t.potential + t.strain;
}

/// How far a material point has come from where it was put.
Vec2 tip(const GaugeDef& def, std::size_t soft, const World& world) {
  const SoftDef& body = world.softDefinition(soft);
  const scene::MaterialPoint point(*body.mesh, def.at);
  const std::size_t first = world.softFirst(soft);
  const auto x = world.soft()->x(), y = world.soft()->y();
  const Vec2 start = Transform::of(body.position, body.angle).toWorld(point.nearest);
  return point.at([&](std::uint32_t i) { return Vec2(x[first + i], y[first + i]); }) - start;
}

const std::vector<Type>& types() {
  using Out = std::span<double>;
  static const std::vector<Type> all = {
      {"front", {{"", "m"}}, [](auto& d, auto, auto& in, Out o) { o[0] = front(d, in.world()); }},
      {"toe", {{"", "m"}}, [](auto&, auto, auto& in, Out o) { o[0] = in.surface().toe(); }},
      {"height", {{"", "m"}}, [](auto& d, auto, auto& in, Out o) { o[0] = in.surface().height(d.x); }},
      {"level", {{"", "m"}}, [](auto&, auto, auto& in, Out o) { o[0] = in.surface().level(); }},
      {"volume", {{"", "m²"}}, [](auto&, auto, auto& in, Out o) { o[0] = in.surface().area(); }},
      {"pressure", {{"", "N/m"}}, [](auto& d, auto, auto& in, Out o) { o[0] = in.world().pressureAt(d.at); }},
      {"velocity",
       {{"x", "m/s"}, {"y", "m/s"}},
       [](auto& d, auto, auto& in, Out o) { put(o, in.world().velocityAt(d.at)); }},
      {"profile",
       {},
       [](auto& d, auto, auto& in, Out o) {
         for (int k = 0; k < d.count; ++k)
           put(o.subspan(2 * static_cast<std::size_t>(k)), in.world().velocityAt(profilePoint(d, k)));
       }},
      {"force",
       {{"x", "N"}, {"y", "N"}, {"torque", "N·m"}},
       [](auto&, auto body, auto& in, Out o) {
         put(o, in.world().body(body).force);
         o[2] = in.world().body(body).torque;
       }},
      {"pose",
       {{"x", "m"}, {"y", "m"}, {"angle", "degrees"}},
       [](auto&, auto body, auto& in, Out o) {
         put(o, in.world().body(body).transform.position);
         o[2] = in.world().body(body).angle * (180.0 / kPi);
       }},
      {"tip", {{"x", "m"}, {"y", "m"}}, [](auto& d, auto soft, auto& in, Out o) { put(o, tip(d, soft, in.world())); }},
      {"area", {{"", "m²"}}, [](auto&, auto soft, auto& in, Out o) { o[0] = in.world().softState(soft).area; }},
      {"energy",
       {{"kinetic", "J"}, {"potential", "J"}, {"strain", "J"}, {"total", "J"}},
       [](auto& d, auto, auto& in, Out o) { energy(d, in.world(), o); }},
      {"momentum",
       {{"x", "kg·m/s"}, {"y", "kg·m/s"}, {"angular", "kg·m²/s"}},
       [](auto& d, auto, auto& in, Out o) {
         const Totals t = in.world().totals(d.species);
         put(o, t.momentum);
         o[2] = t.angular;
       }},
      {"mass", {{"", "kg"}}, [](auto& d, auto, auto& in, Out o) { o[0] = in.world().totals(d.species).mass; }},
      {"count",
       {{"", "1"}},
       [](auto& d, auto, auto& in, Out o) { o[0] = static_cast<double>(in.world().totals(d.species).count); }},
      {"max_speed",
       {{"", "m/s"}},
       [](auto& d, auto, auto& in, Out o) { o[0] = in.world().totals(d.species).maxSpeed; }},
      {"density_error",
       {{"max", "1"}, {"mean", "1"}},
       [](auto&, auto, auto& in, Out o) { densityError(in.world(), o); }},
      {"leaks",
       {{"", "1"}},
       [](auto&, auto, auto& in, Out o) { o[0] = static_cast<double>(in.world().ledger().leaks); }},
  };
  return all;
}

const Type& typeOf(const GaugeDef& def) {
  std::string known;
  for (const Type& t : types()) {
    if (def.type == t.name) return t;
    known += (known.empty() ? "" : ", ") + std::string(t.name);
  }
  throw Error(fmt::format("gauge {}: no type \"{}\"; known are {}", def.name, def.type, known));
}

}  // namespace

std::vector<GaugeColumn> gaugeColumns(const GaugeDef& def) {
  const Type& type = typeOf(def);
  if (!(def.every > 0.0) || !std::isfinite(def.every))
    throw Error(fmt::format("gauge {}: every = {} s, which must be a positive number", def.name, def.every));
  if (def.type == "front" && !(def.quantile >= 0.0 && def.quantile <= 1.0))
    throw Error(fmt::format("gauge {}: quantile = {}, which must be from 0 to 1", def.name, def.quantile));
  if (def.type == "profile" && def.count < 1)
    throw Error(fmt::format("gauge {}: count = {}, which must be at least 1", def.name, def.count));

  std::vector<GaugeColumn> columns;
  for (const Part& p : type.parts) columns.push_back({*p.name != 0 ? def.name + "." + p.name : def.name, p.unit});
  if (def.type == "profile")
    for (int k = 0; k < def.count; ++k)
      for (const char* axis : {"x", "y"}) columns.push_back({fmt::format("{}.{}.{}", def.name, k, axis), "m/s"});
  if (def.type == "pressure" && def.window > 0.0) columns.push_back({def.name + ".mean", "N/m"});
  return columns;
}

void readGauge(const GaugeDef& def, std::size_t body, GaugeInput& input, std::span<double> values) {
  typeOf(def).read(def, body, input, values);
}

double quantile(std::vector<double> values, double q) {
  if (values.empty()) return std::nan("");
  const double place = q * static_cast<double>(values.size() - 1);
  const auto below = std::min(static_cast<std::size_t>(place), values.size() - 1);
  const auto nth = values.begin() + static_cast<std::ptrdiff_t>(below);
  std::nth_element(values.begin(), nth, values.end());
  if (below + 1 == values.size()) return *nth;
  const double above = *std::min_element(nth + 1, values.end());
  return *nth + (place - static_cast<double>(below)) * (above - *nth);
}

}  // namespace froude::run
