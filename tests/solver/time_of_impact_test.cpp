// Times of impact against closed forms.
#include <froude/solver/contact/time_of_impact.h>

#include <gtest/gtest.h>

#include "support/convex_pairs.h"

namespace froude {
namespace {

using namespace test;

TEST(TimeOfImpact, a_fast_small_box_meets_a_thin_wall) {
  const ConvexShape wall(rectangle(0.001, 5)), bullet(rectangle(0.01, 0.01));
  const RigidMotion still, flight{{{-100, 0}, {}}, {1000, 0}, 50.0};
  const TimeOfImpact hit = timeOfImpact(wall, still, bullet, flight, 1.0, 1e-4);
  ASSERT_EQ(hit.status, ImpactStatus::Hit);
  EXPECT_NEAR(hit.time, 0.1, 2e-5);
}

TEST(TimeOfImpact, a_spinning_rod_meets_a_plane_when_its_end_does) {
  const double h = 0.6, w = 2.0, target = 1e-5;
  const ConvexShape floor(rectangle(10, 1, {0, -1 - h})), rod({{-1, -1e-9}, {1, -1e-9}, {1, 1e-9}, {-1, 1e-9}});
  const TimeOfImpact hit = timeOfImpact(floor, {}, rod, {{}, {0, 0}, w}, 1.0, target);
  ASSERT_EQ(hit.status, ImpactStatus::Hit);
  EXPECT_NEAR(hit.time, std::asin(h) / w, 2 * target);
  EXPECT_LE(hit.steps, 10);
}

}  // namespace
}  // namespace froude
