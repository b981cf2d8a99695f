// Stencils beside thin walls against what hangs together in the whole tank.
#include <gtest/gtest.h>

#include <froude/base/random.h>
#include <froude/fields/cut_reach.h>

#include "support/cut_oracle.h"
#include "support/polygon_generator.h"

namespace froude {
namespace {

constexpr std::int32_t kCells = 24;
const CutGrid kGrid{{0.0, 0.0}, 1.0 / kCells, 0, 0};
const CutWalls kTank{{{0.0, 0.0}, {1.0, 1.0}}, {true, true, true, true}};

CutCells cutOf(const Polygon& polygon, const Transform& place) {
  const CutOutline outline{&polygon, place, place.position, 0};
  CutCells cut;
  cut.setFixed(kGrid, {&outline, 1}, kTank);
  cut.update({-1, -1, kCells, kCells}, {});
  return cut;
}

/// The twelve faces as the header lists them: i, j relative to the cell.
struct Face {
  std::int32_t i, j;
  bool vertical;
};
constexpr std::array<Face, 12> kFaces{{{0, -1, true},
                                       {1, -1, true},
                                       {0, 0, true},
                                       {1, 0, true},
                                       {0, 1, true},
                                       {1, 1, true},
                                       {-1, 0, false},
                                       {0, 0, false},
                                       {1, 0, false},
                                       {-1, 1, false},
                                       {0, 1, false},
                                       {1, 1, false}}};

/// Label of what opens to the face between the main parts of its cells, and whether anything does.
std::pair<bool, std::size_t> mainLabel(const CutCells& cut, test::CutRegions& regions, std::int32_t i, std::int32_t j,
                                       bool vertical) {
  if (!regions.inside(i, j)) return {false, 0};
  const std::int32_t c = cut.find(i, j);
  if (c < 0) {
    const std::int32_t li = vertical ? i - 1 : i, lj = vertical ? j : j - 1;
    const std::int32_t before = cut.find(li, lj);
    const bool open = before >= 0 ? cut.cells()[static_cast<std::size_t>(before)].open[vertical ? 1 : 3] > 0.0
                                  : !cut.solid(i, j) && regions.inside(li, lj);
    return {open, open ? regions.label(i, j, -1) : 0};
  }
  const CutCell& cell = cut.cells()[static_cast<std::size_t>(c)];
  const bool open = cell.open[vertical ? 0 : 2] > 0.0;
  return {open, open ? regions.label(i, j, static_cast<std::int32_t>(cell.part)) : 0};
}

/// No part uses a face of another region; every part without a stencil could use all that is open.
void expectOwnSide(const CutCells& cut, std::size_t* checked) {
  CutReach reach;
  reach.build(kGrid, cut);
  test::CutRegions regions(cut, kCells, kCells);
  for (std::int32_t j = 0; j < kCells; ++j) {
    for (std::int32_t i = 0; i < kCells; ++i) {
      const std::int32_t c = cut.find(i, j);
      if (c < 0 && cut.solid(i, j)) continue;
      const CutCell* cell = c < 0 ? nullptr : &cut.cells()[static_cast<std::size_t>(c)];
      for (std::uint32_t p = 0; p < (cell == nullptr ? 1 : cell->partCount); ++p) {
        const std::int32_t part = cell == nullptr ? -1 : static_cast<std::int32_t>(cell->part + p);
        const std::size_t own = regions.label(i, j, part);
        const CutStencil* stencil = nullptr;
        for (std::size_t s = reach.begin(i, j); s < reach.stencils().size(); ++s) {
          const CutStencil& at = reach.stencils()[s];
          if (at.i != i || at.j != j) break;
          if (at.part == part) stencil = &at;
        }
        for (std::size_t k = 0; k < 12; ++k) {
          const Face f = kFaces[k];
          if (stencil != nullptr && stencil->face[k] > 0) {
            const CutEdge& edge = cut.edges()[static_cast<std::size_t>(stencil->face[k] - 1)];
            ASSERT_EQ(edge.i, i + f.i);
            ASSERT_EQ(edge.j, j + f.j);
            ASSERT_EQ(edge.vertical, f.vertical);
            ASSERT_EQ(regions.label(edge.i, edge.j, edge.b), own);
            ++*checked;
            continue;
          }
          const auto [open, label] = mainLabel(cut, regions, i + f.i, j + f.j, f.vertical);
          if (stencil == nullptr || stencil->face[k] == CutStencil::kMain) {
            if (stencil != nullptr) {
              ASSERT_TRUE(open);
            }
            if (open) {
              ASSERT_EQ(label, own) << i << ' ' << j << " face " << k;
            }
          }
        }
      }
    }
  }
}

TEST(CutReach, nobody_uses_a_face_behind_a_plate) {
  std::size_t checked = 0;
  RandomStream random(31, 3);
  for (int round = 0; round < 60; ++round) {
    SCOPED_TRACE(round);
    const Polygon plate = Polygon::box({{-1.5, -0.00005}, {1.5, 0.00005}});
    const double angle = round < 4 ? 0.5 * kPi * round : random.uniform(0, 7);
    // On a grid line with one side, beside one, anywhere.
    const Vec2 at =
        round < 4 ? Vec2(0.5 - 0.00005, 0.5 - 0.00005) : Vec2(random.uniform(0.3, 0.7), random.uniform(0.3, 0.7));
    expectOwnSide(cutOf(plate, Transform::of(at, angle)), &checked);
    if (HasFatalFailure()) return;
  }
  EXPECT_GT(checked, 2000u);
}

TEST(CutReach, holds_round_closed_shapes_of_every_kind) {
  std::size_t checked = 0;
  RandomStream random(32, 3);
  for (int round = 0; round < 200; ++round) {
    SCOPED_TRACE(round);
    const auto shape = static_cast<test::Shape>(random.below(test::kShapeCount));
    const Polygon polygon = test::placed(test::makeOutline(shape, random), 0.7, {});
    expectOwnSide(cutOf(polygon, Transform::of({0.5, 0.5}, random.uniform(0, 7))), &checked);
    if (HasFatalFailure()) return;
  }
  EXPECT_GT(checked, 200u);
}

TEST(CutReach, a_plate_that_ends_hides_what_is_opposite_and_not_what_is_round_its_end) {
  // Horizontal, in the middle of row 12, from the left wall to the middle of cell 10.
  const Polygon plate = Polygon::box({{-1.0, -0.00005}, {10.5 / kCells, 0.00005}});
  const CutCells cut = cutOf(plate, Transform::of({0.0, 12.4 / kCells}, 0.0));
  CutReach reach;
  reach.build(kGrid, cut);
  auto stencilsOf = [&](std::int32_t i, std::int32_t j) {
    std::vector<CutStencil> found;
    for (std::size_t s = reach.begin(i, j); s < reach.stencils().size(); ++s) {
      if (reach.stencils()[s].i != i || reach.stencils()[s].j != j) break;
      found.push_back(reach.stencils()[s]);
    }
    return found;
  };
  ASSERT_EQ(stencilsOf(5, 12).size(), 2u);  // the upper part is the larger
  const CutStencil upper = stencilsOf(5, 12)[0], lower = stencilsOf(5, 12)[1];
  for (const std::size_t below : {0u, 1u, 6u, 7u, 8u}) EXPECT_EQ(upper.face[below], CutStencil::kHidden);
  for (const std::size_t above : {2u, 3u, 4u, 5u, 9u, 10u, 11u}) EXPECT_EQ(upper.face[above], CutStencil::kMain);
  for (const std::size_t above : {4u, 5u, 9u, 10u, 11u}) EXPECT_EQ(lower.face[above], CutStencil::kHidden);
  for (const std::size_t below : {0u, 1u}) EXPECT_EQ(lower.face[below], CutStencil::kMain);
  for (const std::size_t own : {2u, 3u, 6u, 7u, 8u}) EXPECT_GT(lower.face[own], 0);
  EXPECT_TRUE(stencilsOf(14, 12).empty());
  ASSERT_EQ(stencilsOf(5, 11).size(), 1u);  // its upper faces are those of lower parts
  EXPECT_EQ(stencilsOf(5, 11)[0].part, -1);
  EXPECT_GT(stencilsOf(5, 11)[0].face[4], 0);
  EXPECT_TRUE(stencilsOf(5, 13).empty());  // the main parts of row 12 are its own side
  EXPECT_EQ(cut.cells()[static_cast<std::size_t>(cut.find(10, 12))].partCount, 1u);
}

}  // namespace
}  // namespace froude
