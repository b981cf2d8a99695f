// From a particle's value to a colour: viridis, a fixed range for the whole run, ticks at round numbers.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "scene/scene.h"

namespace froude::exporting {

struct Color {
  std::uint8_t r, g, b;
};

/// Viridis at t in [0, 1]; values outside are clamped. Linear between eleven of its colours, within 3/255 of the
/// original.
Color viridis(double t);

/// For signed values, t in [−1, 1]: blues below zero, oranges above, darker away from zero, with a step at zero so that
/// the sign is seen everywhere. Blue and orange are told apart by people with every common colour blindness.
Color diverging(double t);

/// For strain, t in [0, 1], clamped: pale rose to dark plum, apart from viridis and from the colours of polygons.
Color strainColor(double t);

/// Smallest of 1, 1.5, 2, 2.5, 3, 4, 5, 6, 8 · 10^k that is at least `value` > 0.
double roundUp(double value);
/// Largest of 1, 2, 5 · 10^k that is at most `value` > 0.
double roundDown(double value);
/// Multiples of 1, 2 or 5 · 10^k in [low, high], `wanted` or fewer steps.
std::vector<double> niceTicks(double low, double high, int wanted);

/// What particles are coloured by, and which values the two ends of the colour bar stand for.
struct ColorScale {
  enum class Quantity { Speed, Pressure, Density, Strain };
  Quantity quantity = Quantity::Speed;
  double low = 0.0, high = 1.0;  // [m/s, N/m, kg/m², 1]
  double factor = 1.0;           // from SI to the labels' unit
  std::string label;             // "speed (m/s)"

  double position(double value) const { return (value - low) / (high - low); }
};

/// The range is the scene's own, or follows from its scales: speed 0 … √(2gH), or the fastest start if that is more;
/// pressure 0 … ρgH; density ±10 %; H is the height of the fluid's top at the start above the domain's lower side. It
/// depends on the scene alone, so a resumed run keeps its colours.
ColorScale colorScale(const scene::Scene& scene);
/// The same for another of "speed", "pressure" and "density" than the scene's; a range that the scene gives is its own.
ColorScale colorScale(const scene::Scene& scene, const std::string& color);

/// Of soft bodies: from 0 to the largest strain that their weight, their fall and their speed at the start ask for, 100
/// % at most, or the scene's own range.
ColorScale strainScale(const scene::Scene& scene);

}  // namespace froude::exporting
