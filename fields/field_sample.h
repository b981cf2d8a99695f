// What a field answers at a point: distance, normal, closest point and the feature they come from.
#pragma once

#include <froude/base/types.h>

namespace froude {

/// The part of the boundary that is closest. A vertex counts as the start of the edge that leaves it.
enum class FeatureKind : std::uint8_t { None, Edge, StartVertex };

/// Frame and units are those of the query [m].
struct FieldSample {
  double distance = kInfinity;  ///< signed: negative inside the solid
  Vec2 normal{0.0, 0.0};        ///< outward, unit: the minimum translation is −distance · normal. Zero if not exact
  Vec2 closest{0.0, 0.0};       ///< on the boundary; the query itself if not exact
  std::int32_t edge = -1;       ///< number of the closest edge; −1 if not exact
  FeatureKind feature = FeatureKind::None;
  bool exact = false;  ///< false: `distance` has the right sign and a magnitude that does not exceed the true one
};

}  // namespace froude
