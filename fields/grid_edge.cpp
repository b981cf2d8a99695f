#include <froude/fields/grid_edge.h>

namespace froude::detail {

void appendEdge(const Vec2& a, const Vec2& b, std::int32_t previous, std::uint32_t source,
                std::vector<GridEdge>* edges) {
  GridEdge e;
  e.a = a;
  e.b = b;
  e.length = (b - a).stableNorm();
  e.direction = (b - a) / e.length;
  e.previous = previous;
  e.source = source & 0x3FFFFFFFu;
  e.convexStart = 0;
  e.convexEnd = 0;
  edges->push_back(e);
}

void appendEdges(const Polygon& polygon, const Transform* transform, std::uint32_t source,
                 std::vector<GridEdge>* edges) {
  const auto base = static_cast<std::int32_t>(edges->size());
  const auto place = [&](const Vec2& v) { return transform == nullptr ? v : transform->toWorld(v); };
  for (std::uint32_t i = 0; i < polygon.edgeCount(); ++i) {
    appendEdge(place(polygon.edgeStart(i)), place(polygon.edgeEnd(i)),
               base + static_cast<std::int32_t>(polygon.previous(i)), source, edges);
  }
}

}  // namespace froude::detail
