#include "export/color_scale.h"

#include <algorithm>
#include <cmath>

namespace froude::exporting {
namespace {

constexpr std::array<std::array<double, 3>, 11> kViridis = {{{68, 1, 84},
                                                             {72, 36, 117},
                                                             {65, 68, 135},
                                                             {53, 95, 141},
                                                             {42, 120, 142},
                                                             {33, 145, 140},
                                                             {34, 168, 132},
                                                             {68, 191, 112},
                                                             {122, 209, 81},
                                                             {189, 223, 38},
                                                             {253, 231, 37}}};

using Stops = std::array<std::array<double, 3>, 3>;
constexpr Stops kRoses = {{{250, 228, 228}, {222, 96, 130}, {84, 14, 74}}};
constexpr Stops kBlues = {{{207, 226, 243}, {88, 152, 204}, {14, 55, 112}}};
constexpr Stops kOranges = {{{253, 232, 205}, {236, 150, 66}, {122, 55, 10}}};

double fluidHeight(const scene::Scene& scene) {
  const Box& domain = scene.world.domain.box;
  double top = -kInfinity;
  for (const scene::SeededBlock& block : scene.fluidBlocks)
    for (const Vec2& p : block.positions) top = std::max(top, p.y());
  if (top == -kInfinity) return domain.size().y();
  return top + 0.5 * scene.world.fluid->spacing - domain.min.y();
}

/// The largest gravity at the domain's corners and centre at the start [m/s²].
double gravityScale(const scene::Scene& scene) {
  if (!scene.world.gravityField) return scene.world.gravity.norm();
  const Box& box = scene.world.domain.box;
  double largest = 0.0;
  for (const Vec2& p : {box.min, box.max, box.center()})
    largest = std::max(largest, scene.world.gravityField(p, 0.0).norm());
  return largest;
}

/// The fastest thing at the start: particles, emitters, bodies [m/s].
double startSpeed(const scene::Scene& scene) {
  double speed = 0.0;
  for (const auto* blocks : {&scene.fluidBlocks, &scene.bulletBlocks})
    for (const scene::SeededBlock& block : *blocks)
      for (const Vec2& v : block.velocities) speed = std::max(speed, v.norm());
  for (const EmitterDef& e : scene.world.emitters) speed = std::max(speed, e.speed);
  for (const BodyDef& b : scene.world.bodies) {
    speed = std::max({speed, b.velocity.norm(), std::abs(b.surfaceVelocity)});
    for (const ScriptPiece& piece : b.script)
      for (const TimeFunction* f : {&piece.velocityX, &piece.velocityY})
        if (*f) speed = std::max(speed, std::abs((*f)(0.0)));
  }
  return speed;
}

}  // namespace

Color viridis(double t) {
  const double place = (t > 0.0 ? std::min(t, 1.0) : 0.0) * (kViridis.size() - 1);
  const std::size_t k = std::min(static_cast<std::size_t>(place), kViridis.size() - 2);
  const double w = place - static_cast<double>(k);
  const auto mix = [&](std::size_t c) {
    return static_cast<std::uint8_t>(std::lround((1.0 - w) * kViridis[k][c] + w * kViridis[k + 1][c]));
  };
  return {mix(0), mix(1), mix(2)};
}

namespace {

Color between(const Stops& stops, double t) {
  const double place = 2.0 * (t > 0.0 ? std::min(t, 1.0) : 0.0);
  const std::size_t k = place < 1.0 ? 0 : 1;
  const double w = place - static_cast<double>(k);
  const auto mix = [&](std::size_t c) {
    return static_cast<std::uint8_t>(std::lround((1.0 - w) * stops[k][c] + w * stops[k + 1][c]));
  };
  return {mix(0), mix(1), mix(2)};
}

}  // namespace

Color diverging(double t) { return between(t < 0.0 ? kBlues : kOranges, std::abs(t)); }

Color strainColor(double t) { return between(kRoses, t); }

double roundUp(double value) {
  const double decade = std::pow(10.0, std::floor(std::log10(value)));
  for (const double m : {1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0})
    if (value <= m * decade * (1.0 + 1e-12)) return m * decade;
  return 10.0 * decade;
}

double roundDown(double value) {
  const double decade = std::pow(10.0, std::floor(std::log10(value)));
  return (value >= 5.0 * decade ? 5.0 : value >= 2.0 * decade ? 2.0 : 1.0) * decade;
}

std::vector<double> niceTicks(double low, double high, int wanted) {
  double step = 0.0;
  const double least = (high - low) / wanted;
  const double decade = std::pow(10.0, std::floor(std::log10(least)));
  for (const double m : {1.0, 2.0, 5.0, 10.0})
    if (step == 0.0 && m * decade >= least * (1.0 - 1e-9)) step = m * decade;
  std::vector<double> ticks;
  const double slack = 1e-9 * (high - low);
  for (double k = std::ceil((low - slack) / step); k * step <= high + slack; k += 1.0) ticks.push_back(k * step);
  return ticks;
}

ColorScale colorScale(const scene::Scene& scene) { return colorScale(scene, scene.output.image.color); }

ColorScale colorScale(const scene::Scene& scene, const std::string& color) {
  const double height = fluidHeight(scene), gravity = gravityScale(scene);
  const double restDensity = scene.world.fluid ? scene.world.fluid->density : 1000.0;
  ColorScale scale;
  std::string unit;
  if (color == "pressure") {
    scale.quantity = ColorScale::Quantity::Pressure;
    const double speed = startSpeed(scene);
    const double pressure = std::max(restDensity * gravity * height, 0.5 * restDensity * speed * speed);
    scale.high = pressure > 0.0 ? roundUp(0.99 * pressure) : 1.0;
    unit = "N/m";
  } else if (color == "density") {
    scale.quantity = ColorScale::Quantity::Density;
    scale.low = 0.9 * restDensity;
    scale.high = 1.1 * restDensity;
    unit = "kg/m²";
  } else {
    const double speed = std::max(std::sqrt(2.0 * gravity * height), startSpeed(scene));
    // A little over the end of the bar does not show; a bar that ends at 8 for 6.1 does.
    scale.high = speed > 0.0 ? roundUp(0.95 * speed) : 1.0;
    unit = "m/s";
  }
  if (scene.output.image.range && color == scene.output.image.color) {
    scale.low = (*scene.output.image.range)[0];
    scale.high = (*scene.output.image.range)[1];
  }
  const double largest = std::max(std::abs(scale.low), std::abs(scale.high));
  if (unit == "N/m" && largest >= 2000.0) {
    scale.factor = 1e-3;
    unit = "kN/m";
  } else if (unit == "m/s" && largest < 0.02) {
    scale.factor = 1e3;
    unit = "mm/s";
  }
  const char* names[] = {"speed", "pressure", "density", "strain"};
  scale.label = std::string(names[static_cast<int>(scale.quantity)]) + " (" + unit + ")";
  return scale;
}

namespace {

/// A beam that is held bends by 3 ρ g L²/(E t), any other body gives way by ρ g h/E under its weight and by v √(ρ/E)
/// when it is stopped.
double expectedStrain(const SoftDef& def, double gravity, const Box& domain) {
  Box box;
  const Transform transform = Transform::of(def.position, def.angle);
  for (const Vec2& p : def.mesh->points) box.include(transform.toWorld(p));
  const Vec2 size = box.size();
  const double weight = def.density * gravity / def.young;  // [1/m]
  if (!def.pinned.empty()) {
    const double thin = def.model == SoftModel::Rope ? def.thickness : size.minCoeff();
    return def.model == SoftModel::Rope ? weight * size.maxCoeff() : 3.0 * weight * size.squaredNorm() / thin;
  }
  const double fall =
      std::sqrt(def.velocity.squaredNorm() + 2.0 * gravity * std::max(0.0, box.min.y() - domain.min.y()));
  return weight * size.maxCoeff() + fall * std::sqrt(def.density / def.young);
}

}  // namespace

ColorScale strainScale(const scene::Scene& scene) {
  ColorScale scale;
  scale.quantity = ColorScale::Quantity::Strain;
  scale.factor = 100.0;
  scale.label = "strain (%)";
  double largest = 0.0;
  for (const SoftDef& def : scene.world.soft)
    largest = std::max(largest, expectedStrain(def, gravityScale(scene), scene.world.domain.box));
  scale.high = largest > 0.0 && std::isfinite(largest) ? std::min(roundUp(0.9 * largest), 1.0) : 0.1;
  if (scene.output.image.strainRange) {
    scale.low = (*scene.output.image.strainRange)[0];
    scale.high = (*scene.output.image.strainRange)[1];
  }
  return scale;
}

}  // namespace froude::exporting
