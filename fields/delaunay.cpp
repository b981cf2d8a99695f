#include <froude/fields/delaunay.h>

#include <boost/polygon/voronoi.hpp>

template <>
struct boost::polygon::geometry_concept<froude::detail::PointLattice::Node> {
  using type = boost::polygon::point_concept;
};

template <>
struct boost::polygon::point_traits<froude::detail::PointLattice::Node> {
  using coordinate_type = std::int32_t;
  static coordinate_type get(const froude::detail::PointLattice::Node& p, boost::polygon::orientation_2d axis) {
    return axis == boost::polygon::HORIZONTAL ? p.x : p.y;
  }
};

namespace froude::detail {

PointLattice::PointLattice(const Box& box)
    : center_(box.center()), scale_(static_cast<double>(1 << 30) / box.size().maxCoeff()) {}

namespace {

/// Twice the signed area; exact, since coordinates stay below 2³⁰.
std::int64_t area(const PointLattice::Node& a, const PointLattice::Node& b, const PointLattice::Node& c) {
  return (std::int64_t{b.x} - a.x) * (std::int64_t{c.y} - a.y) - (std::int64_t{b.y} - a.y) * (std::int64_t{c.x} - a.x);
}

}  // namespace

std::vector<TriangleCorners> delaunay(std::span<const PointLattice::Node> points) {
  boost::polygon::voronoi_diagram<double> diagram;
  boost::polygon::construct_voronoi(points.begin(), points.end(), &diagram);
  std::vector<TriangleCorners> triangles;
  triangles.reserve(2 * points.size());
  std::vector<std::uint32_t> ring;
  for (const auto& vertex : diagram.vertices()) {
    ring.clear();
    const auto* const first = vertex.incident_edge();
    const auto* edge = first;
    do {  // counter-clockwise round the vertex: so are the points whose cells meet there
      ring.push_back(static_cast<std::uint32_t>(edge->cell()->source_index()));
      edge = edge->rot_next();
    } while (edge != first);
    std::rotate(ring.begin(), std::min_element(ring.begin(), ring.end()), ring.end());
    for (std::size_t i = 1; i + 1 < ring.size(); ++i)
      if (area(points[ring[0]], points[ring[i]], points[ring[i + 1]]) > 0)
        triangles.push_back({ring[0], ring[i], ring[i + 1]});
  }
  return triangles;
}

}  // namespace froude::detail
