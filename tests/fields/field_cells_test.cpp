// What a field tells of its cells, against the distance to every edge.
#include <gtest/gtest.h>

#include <froude/base/random.h>
#include <froude/fields/distance_field.h>

#include "support/polygon_generator.h"
#include "support/polygon_oracle.h"

namespace froude {
namespace {

TEST(FieldCells, far_ones_lie_wholly_on_the_side_they_say) {
  RandomStream random(77, 1);
  for (int shape = 0; shape < test::kShapeCount; ++shape) {
    const Polygon polygon = test::randomPolygon(static_cast<test::Shape>(shape), random);
    const std::vector<test::OracleEdge> edges = test::oracleEdges(polygon);
    const DistanceField field(polygon, 0.02);
    std::size_t near = 0, outside = 0;
    for (int j = 0; j < field.ny(); ++j)
      for (int i = 0; i < field.nx(); ++i) {
        const FieldCell cell = field.cell(i, j);
        const Vec2 p = field.gridOrigin() + field.cellSize() * Vec2(i + random.uniform(), j + random.uniform());
        const auto d = static_cast<double>(test::signedDistance(edges, p));
        if (cell.kind == FieldCell::Kind::Near) {
          ++near;
          ASSERT_GT(cell.edges, 0u);
        } else {
          outside += cell.kind == FieldCell::Kind::Outside ? 1 : 0;
          ASSERT_EQ(cell.edges, 0u);
          ASSERT_EQ(cell.kind == FieldCell::Kind::Inside, d < 0.0);
          ASSERT_LE(std::abs(static_cast<double>(cell.clearance)), std::abs(d) * (1.0 + 1e-6));
          ASSERT_GT(std::abs(d), field.band());
        }
      }
    EXPECT_GT(near, 50u) << shape;
    EXPECT_GT(outside, 50u) << shape;
  }
}

TEST(FieldCells, the_grid_holds_the_shape_grown_by_the_band) {
  const Polygon polygon = Polygon::box({{1.0, 2.0}, {3.0, 2.5}});
  const DistanceField field(polygon, 0.25, 0.1);
  const Vec2 end = field.gridOrigin() + field.cellSize() * Vec2(field.nx(), field.ny());
  EXPECT_LE(field.gridOrigin().x(), 0.75);
  EXPECT_LE(field.gridOrigin().y(), 1.75);
  EXPECT_GE(end.x(), 3.25);
  EXPECT_GE(end.y(), 2.75);
}

}  // namespace
}  // namespace froude
