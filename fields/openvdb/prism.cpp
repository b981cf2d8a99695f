// Walls, and caps by a sweep over trapezoids. Of its own on purpose: nothing here is shared with the distance field.
#include <froude/fields/openvdb/prism.h>

#include <algorithm>

namespace froude::vdb {
namespace {

// OpenVDB quarters the faces of a mesh of fewer faces than this again and again (tools::MeshToVolume, POLYGON_LIMIT)
// and measures the nodes around a quarter's first corner against that quarter alone: half a voxel wrong, here and
// there. It takes the faces of a larger mesh whole; then such corners are vertices, which all lie on the caps, far from
// the middle plane. So caps are sliced. Walls stay whole: a node beyond the first two layers is measured against its
// neighbours' faces only.
constexpr std::size_t kWholeFaces = 1000;

/// An edge from below to above; horizontal ones bound no trapezoid at a side.
struct Side {
  Vec2 low, high;
  double xAt(double y) const {
    if (y <= low.y()) return low.x();
    if (y >= high.y()) return high.x();
    return low.x() + (high.x() - low.x()) * ((y - low.y()) / (high.y() - low.y()));
  }
};

/// A trapezoid that is still growing upwards from `bottom`.
struct Open {
  std::uint32_t left, right;
  double bottom;
};

struct Trapezoid {
  Side left, right;
  double bottom, top;
};

std::vector<Side> sidesOf(const Polygon& polygon) {
  std::vector<Side> sides;
  for (std::uint32_t e = 0; e < polygon.edgeCount(); ++e) {
    const Vec2 &a = polygon.edgeStart(e), &b = polygon.edgeEnd(e);
    if (a.y() < b.y()) sides.push_back({a, b});
    if (b.y() < a.y()) sides.push_back({b, a});
  }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) { return a.low.y() < b.low.y(); });
  return sides;
}

/// Between two neighbouring heights the sides, from left to right, bound the solid in pairs. A pair that stays together
/// over several heights is one trapezoid.
std::vector<Trapezoid> trapezoidsOf(const Polygon& polygon) {
  const std::vector<Side> sides = sidesOf(polygon);
  std::vector<double> heights;
  for (const Vec2& v : polygon.vertices()) heights.push_back(v.y());
  std::sort(heights.begin(), heights.end());
  heights.erase(std::unique(heights.begin(), heights.end()), heights.end());

  std::vector<Trapezoid> done;
  std::vector<Open> open, next;
  std::vector<std::uint32_t> cut;
  std::uint32_t entering = 0;
  const auto close = [&](const Open& o, double top) { done.push_back({sides[o.left], sides[o.right], o.bottom, top}); };
  for (std::size_t k = 0; k + 1 < heights.size(); ++k) {
    const double bottom = heights[k], middle = 0.5 * (bottom + heights[k + 1]);
    std::erase_if(cut, [&](std::uint32_t s) { return sides[s].high.y() <= bottom; });
    while (entering < sides.size() && sides[entering].low.y() <= bottom) cut.push_back(entering++);
    std::stable_sort(cut.begin(), cut.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return sides[a].xAt(middle) < sides[b].xAt(middle); });
    next.clear();
    for (std::size_t j = 0; j + 1 < cut.size(); j += 2) next.push_back({cut[j], cut[j + 1], bottom});
    for (const Open& o : open) {
      const auto same =
          std::find_if(next.begin(), next.end(), [&](const Open& n) { return n.left == o.left && n.right == o.right; });
      if (same != next.end())
        same->bottom = o.bottom;
      else
        close(o, bottom);
    }
    open.swap(next);
  }
  for (const Open& o : open) close(o, heights.back());
  return done;
}

/// The part of a trapezoid between two heights, on both caps.
template <typename Vertex>
void addSlice(const Trapezoid& t, double bottom, double top, const Vertex& vertex, QuadMesh& mesh) {
  const Vec2 southWest(t.left.xAt(bottom), bottom), southEast(t.right.xAt(bottom), bottom),
      northEast(t.right.xAt(top), top), northWest(t.left.xAt(top), top);
  std::vector<Vec2> ring{southWest};
  for (const Vec2& corner : {southEast, northEast, northWest})
    if (corner != ring.back() && corner != southWest) ring.push_back(corner);
  if (ring.size() < 3) return;
  for (const double side : {1.0, -1.0}) {
    std::array<std::uint32_t, 4> face{0, 0, 0, QuadMesh::kNoVertex};
    for (std::size_t j = 0; j < ring.size(); ++j) {
      const Vec2& corner = ring[side > 0.0 ? j : ring.size() - 1 - j];
      face[j] = vertex(corner.x(), corner.y(), side);
    }
    mesh.faces.push_back(face);
  }
}

}  // namespace

void addPrism(const Polygon& polygon, const Vec2& origin, double unit, double halfHeight, QuadMesh& mesh) {
  const auto vertex = [&](double x, double y, double side) {
    mesh.vertices.push_back({static_cast<float>((x - origin.x()) / unit), static_cast<float>((y - origin.y()) / unit),
                             static_cast<float>(side * halfHeight / unit)});
    return static_cast<std::uint32_t>(mesh.vertices.size() - 1);
  };
  for (std::uint32_t e = 0; e < polygon.edgeCount(); ++e) {
    const Vec2 &a = polygon.edgeStart(e), &b = polygon.edgeEnd(e);
    mesh.faces.push_back(
        {vertex(a.x(), a.y(), -1.0), vertex(b.x(), b.y(), -1.0), vertex(b.x(), b.y(), 1.0), vertex(a.x(), a.y(), 1.0)});
  }
  const std::vector<Trapezoid> trapezoids = trapezoidsOf(polygon);
  const std::size_t slices = kWholeFaces / (2 * trapezoids.size()) + 1;
  for (const Trapezoid& t : trapezoids)
    for (std::size_t k = 0; k < slices; ++k) {
      const auto height = [&](std::size_t j) {
        return j == slices ? t.top
                           : t.bottom + (t.top - t.bottom) * (static_cast<double>(j) / static_cast<double>(slices));
      };
      addSlice(t, height(k), height(k + 1), vertex, mesh);
    }
}

}  // namespace froude::vdb
