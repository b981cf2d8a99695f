// The mesh that OpenVDB is given encloses what it should: volume and surface by the divergence theorem.
#include <froude/fields/openvdb/prism.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "openvdb/shapes.h"

namespace froude::vdb {
namespace {

using Vec3 = Eigen::Vector3d;

TEST(Prism, is_closed_turned_outwards_and_as_large_as_its_polygon) {
  for (const auto& [name, polygon] : test::goldenShapes()) {
    QuadMesh mesh;
    const double unit = 0.01, halfHeight = 0.05;
    addPrism(polygon, polygon.bounds().center(), unit, halfHeight, mesh);
    EXPECT_GE(mesh.faces.size(), 1000u) << name;
    double volume = 0.0, caps = 0.0, walls = 0.0;
    Vec3 closed = Vec3::Zero();  // of a closed surface the area vectors add up to nothing
    for (const auto& face : mesh.faces) {
      const auto at = [&](std::size_t k) {
        const auto& v = mesh.vertices.at(face[k]);
        return Vec3(static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2]));
      };
      for (std::size_t k = 1; k < (face[3] == QuadMesh::kNoVertex ? 2u : 3u); ++k) {
        const Vec3 normal = 0.5 * (at(k) - at(0)).cross(at(k + 1) - at(0));
        volume += at(0).dot(normal) / 3.0;
        closed += normal;
        (std::abs(normal.z()) > 0.5 * normal.norm() ? caps : walls) += normal.norm();
      }
    }
    double perimeter = 0.0;
    for (std::uint32_t e = 0; e < polygon.edgeCount(); ++e)
      perimeter += (polygon.edgeEnd(e) - polygon.edgeStart(e)).norm();
    // Vertices are floats: relative to the shape's size over its smallest extent.
    const double size = polygon.bounds().size().maxCoeff() / unit, rounding = 4.0 * std::ldexp(1.0, -23) * size;
    const double area = polygon.area() / (unit * unit), height = 2.0 * halfHeight / unit;
    EXPECT_NEAR(caps, 2.0 * area, 2.0 * rounding * perimeter / unit) << name;
    EXPECT_NEAR(walls, perimeter / unit * height, rounding * perimeter / unit * height) << name;
    EXPECT_NEAR(volume, area * height, rounding * perimeter / unit * height) << name;
    EXPECT_LT(closed.norm(), rounding * perimeter / unit) << name;
  }
}

}  // namespace
}  // namespace froude::vdb
