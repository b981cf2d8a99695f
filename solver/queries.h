// What may be asked of a world between steps: areas and rays.
#pragma once

#include <variant>

#include <froude/base/api.h>
#include <froude/fields/polygon.h>
#include <froude/fields/world_field.h>
#include <froude/solver/definitions.h>

namespace froude {

/// A disc: all within `radius` of `center` [m].
struct Disc {
  Vec2 center{0, 0};
  double radius = 0.0;
};

/// A part of the plane in world coordinates [m], boundary included: a box, a disc, or a polygon, which must outlive the
/// area. It is not continued across periodic sides.
class FROUDE_API Area {
 public:
  Area(const Box& box) : shape_(box) {}               // NOLINT(google-explicit-constructor): reads as what it is
  Area(const Disc& disc) : shape_(disc) {}            // NOLINT(google-explicit-constructor)
  Area(const Polygon& polygon) : shape_(&polygon) {}  // NOLINT(google-explicit-constructor)
  Area(Polygon&&) = delete;

  Box bounds() const;
  bool contains(const Vec2& point) const;
  /// Does a polygon that stands at `transform` share a point with the area? Cost: its edges (times the area's).
  bool meets(const Polygon& polygon, const Transform& transform) const;

 private:
  std::variant<Box, Disc, const Polygon*> shape_;
};

/// What meets everything that can be met at all: for queries without a side of their own.
inline constexpr CollisionFilter kEverything{~0u, ~0u};

/// What a ray meets first. If !hit, `point` is its end and `distance` its length.
struct RayHit {
  bool hit = false;
  BodyId body;                 // null: a wall of the domain
  Vec2 point{0, 0};            // [m]
  Vec2 normal{0, 0};           // outward from the body, unit
  double distance = 0.0;       // from the start [m]
  bool startedInside = false;  // the ray begins in a solid: distance 0, point on the boundary nearest to the start
};

}  // namespace froude
