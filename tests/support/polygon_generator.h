// Outlines that are hard on geometry, from a seeded stream: the same ones on every machine.
#pragma once

#include <string>
#include <vector>

#include <froude/base/random.h>
#include <froude/base/transform.h>
#include <froude/fields/polygon.h>

namespace froude::test {

enum class Shape { Convex, Star, Comb, Spiral, Koch, Needle, Plate, Ring };
inline constexpr int kShapeCount = 8;

/// Rings before any check, about the origin, with a size near 1 m.
struct Outline {
  std::string name;
  std::vector<Vec2> outer;
  std::vector<std::vector<Vec2>> holes;
};

namespace generator {

inline Vec2 polar(double radius, double angle) { return {radius * std::cos(angle), radius * std::sin(angle)}; }

/// Points on an ellipse at increasing angles.
inline std::vector<Vec2> convex(RandomStream& random) {
  const int n = 3 + static_cast<int>(random.below(14));
  const double a = random.uniform(0.2, 0.6);
  const double b = random.uniform(0.05, 0.6);
  std::vector<Vec2> ring;
  for (int i = 0; i < n; ++i) {
    const double angle = 2.0 * kPi * (i + random.uniform(0.0, 0.7)) / n;
    ring.emplace_back(a * std::cos(angle), b * std::sin(angle));
  }
  return ring;
}

inline std::vector<Vec2> star(RandomStream& random) {
  const int n = 5 + static_cast<int>(random.below(20));
  std::vector<Vec2> ring;
  for (int i = 0; i < n; ++i)
    ring.push_back(polar(random.uniform(0.05, 0.6), 2.0 * kPi * (i + random.uniform(0, 0.5)) / n));
  return ring;
}

/// Teeth of 0.1 mm to 5 cm on a bar of the same thickness.
inline std::vector<Vec2> comb(RandomStream& random) {
  const int teeth = 2 + static_cast<int>(random.below(6));
  const double width = std::pow(10.0, random.uniform(-4.0, -1.3));
  const double pitch = std::max(2.5 * width, 1.0 / teeth);
  const double height = random.uniform(0.2, 0.8);
  const double left = -0.5 * ((teeth - 1) * pitch + width);
  std::vector<Vec2> ring{{left, -0.3}, {left + (teeth - 1) * pitch + width, -0.3}};
  for (int i = teeth - 1; i >= 0; --i) {
    const double x = left + i * pitch;
    ring.emplace_back(x + width, -0.3 + height);
    ring.emplace_back(x, -0.3 + height);
    if (i > 0) {
      ring.emplace_back(x, -0.3 + width);
      ring.emplace_back(x - pitch + width, -0.3 + width);
    }
  }
  return ring;
}

inline std::vector<Vec2> spiral(RandomStream& random) {
  const double turns = random.uniform(1.0, 3.0);
  const double thickness = std::pow(10.0, random.uniform(-4.0, -1.7));
  const int n = 12 + static_cast<int>(random.below(40));
  std::vector<Vec2> inner;
  std::vector<Vec2> ring;
  for (int i = 0; i <= n; ++i) {
    const double angle = 2.0 * kPi * turns * i / n;
    const double radius = 0.15 + 0.12 * angle / (2.0 * kPi);
    ring.push_back(polar(radius + thickness, angle));
    inner.push_back(polar(radius, angle));
  }
  ring.insert(ring.end(), inner.rbegin(), inner.rend());
  return ring;
}

inline std::vector<Vec2> koch(RandomStream& random) {
  const int level = static_cast<int>(random.below(4));
  std::vector<Vec2> ring{polar(0.5, 0.0), polar(0.5, 2.0 * kPi / 3.0), polar(0.5, 4.0 * kPi / 3.0)};
  for (int l = 0; l < level; ++l) {
    std::vector<Vec2> finer;
    for (std::size_t i = 0; i < ring.size(); ++i) {
      const Vec2& a = ring[i];
      const Vec2 third = (ring[(i + 1) % ring.size()] - a) / 3.0;
      finer.insert(finer.end(),
                   {a, a + third, a + 1.5 * third + std::sqrt(0.75) * rightNormal(third), a + 2.0 * third});
    }
    ring = finer;
  }
  return ring;
}

/// A box with one or two spikes of aspect up to a million.
inline std::vector<Vec2> needle(RandomStream& random) {
  const double half = 0.5 * std::pow(10.0, random.uniform(-6.0, -3.0));
  const double x = random.uniform(-0.2, 0.2);
  std::vector<Vec2> ring{{-0.3, -0.3},   {0.3, -0.3}, {0.3, 0.0}, {x + half, 0.0}, {x, random.uniform(0.5, 1.0)},
                         {x - half, 0.0}};
  if (random.below(2) == 0) {
    ring.emplace_back(-0.3, 0.0);
  } else {
    ring.emplace_back(-0.9, random.uniform(-0.3, 0.0));
  }
  return ring;
}

/// 0.1 mm thick, straight or bent like an L or a V.
inline std::vector<Vec2> plate(RandomStream& random) {
  constexpr double kThickness = 1e-4;
  const double length = random.uniform(0.3, 1.0);
  switch (random.below(3)) {
    case 0:
      return {{-0.5 * length, 0.0}, {0.5 * length, 0.0}, {0.5 * length, kThickness}, {-0.5 * length, kThickness}};
    case 1:
      return {{0.0, 0.0}, {length, 0.0}, {length, kThickness}, {kThickness, kThickness}, {kThickness, 0.5}, {0.0, 0.5}};
    default: {
      const double rise = random.uniform(0.02, 0.6);
      return {{-0.5, rise},      {0.0, 0.0},
              {0.5, rise},       {0.5, rise + kThickness},
              {0.0, kThickness}, {-0.5, rise + kThickness}};
    }
  }
}

/// A disc with holes that leave walls down to 0.1 mm.
inline void ring(RandomStream& random, Outline* outline) {
  const int n = 3 + static_cast<int>(random.below(10));
  const double wall = std::pow(10.0, random.uniform(-4.0, -1.5));
  std::vector<Vec2> hole;
  for (int i = 0; i < n; ++i) {
    outline->outer.push_back(polar(0.5, 2.0 * kPi * i / n));
    hole.push_back(polar((0.5 - wall) * 0.999, -2.0 * kPi * i / n));
  }
  if (random.below(2) == 0) {
    outline->holes.push_back(hole);
    return;
  }
  const double size = random.uniform(0.02, 0.08);
  for (const double x : {-0.1, 0.0, 0.1}) {
    outline->holes.push_back({{x, 0.0}, {x, 0.5 * size}, {x + 0.5 * size, size}, {x + size, 0.0}});
  }
}

}  // namespace generator

inline Outline makeOutline(Shape shape, RandomStream& random) {
  Outline outline;
  switch (shape) {
    case Shape::Convex:
      outline = {"convex", generator::convex(random), {}};
      break;
    case Shape::Star:
      outline = {"star", generator::star(random), {}};
      break;
    case Shape::Comb:
      outline = {"comb", generator::comb(random), {}};
      break;
    case Shape::Spiral:
      outline = {"spiral", generator::spiral(random), {}};
      break;
    case Shape::Koch:
      outline = {"koch", generator::koch(random), {}};
      break;
    case Shape::Needle:
      outline = {"needle", generator::needle(random), {}};
      break;
    case Shape::Plate:
      outline = {"plate", generator::plate(random), {}};
      break;
    case Shape::Ring:
      outline.name = "ring";
      generator::ring(random, &outline);
      break;
  }
  return outline;
}

/// The outline scaled, then placed.
inline Polygon placed(const Outline& outline, double scale, const Transform& transform) {
  const auto move = [&](std::vector<Vec2> points) {
    for (Vec2& p : points) p = transform.toWorld(scale * p);
    return points;
  };
  std::vector<std::vector<Vec2>> holes;
  for (const std::vector<Vec2>& hole : outline.holes) holes.push_back(move(hole));
  return Polygon::make(move(outline.outer), std::move(holes));
}

/// A random polygon of the given shape, unscaled and in its own frame.
inline Polygon randomPolygon(Shape shape, RandomStream& random) {
  return placed(makeOutline(shape, random), 1.0, Transform());
}

}  // namespace froude::test
