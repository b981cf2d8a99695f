// What polygons leave open of a box, by Clipper's sweep over whole numbers; and how the parts of cut cells hang
// together.
#pragma once

#include <algorithm>
#include <numeric>
#include <polyclipping/clipper.hpp>
#include <vector>

#include <froude/fields/cut_cells.h>

namespace froude::test {

/// Open regions in units of cells, found on a lattice of 2⁻³² cells.
class CutOracle {
 public:
  explicit CutOracle(const CutGrid& grid) : grid_(grid) {}

  void add(const CutOutline& outline) {
    const Polygon& polygon = *outline.polygon;
    for (std::size_t r = 0; r + 1 < polygon.ringStarts().size(); ++r) {
      ClipperLib::Path path;
      for (std::uint32_t v = polygon.ringStarts()[r]; v < polygon.ringStarts()[r + 1]; ++v) {
        path.push_back(point((outline.place.toWorld(polygon.vertices()[v]) - grid_.origin) / grid_.size));
      }
      if (r == 0) solids_.emplace_back();
      solids_.back().push_back(path);
    }
  }
  /// Everything beyond the sides of the box [m].
  void addWalls(const CutWalls& walls) {
    const Vec2 a = (walls.box.min - grid_.origin) / grid_.size, b = (walls.box.max - grid_.origin) / grid_.size;
    constexpr double kFar = 1000.0;
    if (walls.closed[0]) solids_.push_back({rectangle({-kFar, -kFar}, {a.x(), kFar})});
    if (walls.closed[1]) solids_.push_back({rectangle({b.x(), -kFar}, {kFar, kFar})});
    if (walls.closed[2]) solids_.push_back({rectangle({-kFar, -kFar}, {kFar, a.y()})});
    if (walls.closed[3]) solids_.push_back({rectangle({-kFar, b.y()}, {kFar, kFar})});
  }

  /// A connected open region: its outline and the solids in it.
  struct Region {
    double area = 0.0;  // [cells]
    ClipperLib::Paths rings;
    bool contains(const Vec2& cell, CutOracle& oracle) const {
      bool in = false;
      for (const ClipperLib::Path& ring : rings) in ^= ClipperLib::PointInPolygon(oracle.point(cell), ring) != 0;
      return in;
    }
  };
  /// Of the box low … high [cells], the largest first; specks are left out.
  std::vector<Region> open(const Vec2& low, const Vec2& high, double speck) {
    if (joined_ < solids_.size()) join();
    ClipperLib::Clipper clipper;
    clipper.AddPath(rectangle(low, high), ClipperLib::ptSubject, true);
    clipper.AddPaths(solid_, ClipperLib::ptClip, true);
    clipper.StrictlySimple(true);  // what touches in a point is apart
    ClipperLib::PolyTree tree;
    clipper.Execute(ClipperLib::ctDifference, tree, ClipperLib::pftEvenOdd, ClipperLib::pftEvenOdd);
    std::vector<Region> regions;
    for (ClipperLib::PolyNode* node = tree.GetFirst(); node != nullptr; node = node->GetNext()) {
      if (node->IsHole()) continue;
      Region region;
      region.rings.push_back(node->Contour);
      double area = std::abs(ClipperLib::Area(node->Contour));
      for (const ClipperLib::PolyNode* hole : node->Childs) {
        region.rings.push_back(hole->Contour);
        area -= std::abs(ClipperLib::Area(hole->Contour));
      }
      region.area = area / (kScale * kScale);
      if (region.area > speck) regions.push_back(region);
    }
    std::sort(regions.begin(), regions.end(), [](const Region& a, const Region& b) { return a.area > b.area; });
    return regions;
  }

 private:
  static constexpr double kScale = 4294967296.0;
  static ClipperLib::IntPoint point(const Vec2& x) {
    return {static_cast<ClipperLib::cInt>(std::llround(x.x() * kScale)),
            static_cast<ClipperLib::cInt>(std::llround(x.y() * kScale))};
  }
  static ClipperLib::Path rectangle(const Vec2& a, const Vec2& b) {
    return {point(a), point({b.x(), a.y()}), point(b), point({a.x(), b.y()})};
  }

  // The rings of each solid are an outline with holes, and so is the union.
  void join() {
    for (; joined_ < solids_.size(); ++joined_) {
      ClipperLib::Clipper clipper;
      clipper.AddPaths(solid_, ClipperLib::ptSubject, true);
      clipper.AddPaths(solids_[joined_], ClipperLib::ptClip, true);
      ClipperLib::Paths sum;
      clipper.Execute(ClipperLib::ctUnion, sum, ClipperLib::pftEvenOdd, ClipperLib::pftEvenOdd);
      solid_ = sum;
    }
  }

  CutGrid grid_;
  std::vector<ClipperLib::Paths> solids_;
  ClipperLib::Paths solid_;  // the first of them together
  std::size_t joined_ = 0;
};

/// What hangs together through open sides in the cells [0, nx) × [0, ny).
class CutRegions {
 public:
  CutRegions(const CutCells& cut, std::int32_t nx, std::int32_t ny) : cut_(cut), nx_(nx), ny_(ny) {
    parent_.resize(cut.parts().size() + static_cast<std::size_t>(nx) * static_cast<std::size_t>(ny));
    std::iota(parent_.begin(), parent_.end(), std::size_t{0});
    area_.resize(parent_.size(), 0.0);
    for (std::int32_t j = 0; j < ny; ++j) {
      for (std::int32_t i = 0; i < nx; ++i) {
        const std::int32_t c = cut.find(i, j);
        if (c >= 0)
          joinParts(cut.cells()[static_cast<std::size_t>(c)]);
        else if (!cut.solid(i, j))
          joinWhole(i, j);
      }
    }
  }

  /// Equal for what hangs together; `part` −1: the wholly open cell (i, j).
  std::size_t label(std::int32_t i, std::int32_t j, std::int32_t part) {
    return root(part >= 0 ? static_cast<std::size_t>(part) : whole(i, j));
  }
  bool inside(std::int32_t i, std::int32_t j) const { return i >= 0 && i < nx_ && j >= 0 && j < ny_; }

  /// The largest first [cells].
  std::vector<double> areas() {
    std::vector<double> sums(parent_.size(), 0.0);
    for (std::size_t a = 0; a < parent_.size(); ++a) sums[root(a)] += area_[a];
    std::sort(sums.begin(), sums.end(), std::greater<>());
    while (!sums.empty() && sums.back() == 0.0) sums.pop_back();
    return sums;
  }

 private:
  std::size_t root(std::size_t a) {
    while (parent_[a] != a) a = parent_[a] = parent_[parent_[a]];
    return a;
  }
  std::size_t whole(std::int32_t i, std::int32_t j) const {
    return cut_.parts().size() + static_cast<std::size_t>(j) * static_cast<std::size_t>(nx_) +
           static_cast<std::size_t>(i);
  }
  void joinWhole(std::int32_t i, std::int32_t j) {
    area_[whole(i, j)] = 1.0;
    for (const auto& [x, y] : {std::pair{i + 1, j}, std::pair{i, j + 1}}) {
      if (inside(x, y) && cut_.find(x, y) < 0 && !cut_.solid(x, y)) parent_[root(whole(i, j))] = root(whole(x, y));
    }
  }
  void joinParts(const CutCell& cell) {
    for (std::size_t p = cell.part; p < cell.part + cell.partCount; ++p) {
      const CutPart& part = cut_.parts()[p];
      area_[p] = part.area;
      for (const CutJoint& joint : cut_.joints().subspan(part.joint, part.jointCount)) {
        const std::int32_t x = cell.i + (joint.side == CutSide::Right ? 1 : joint.side == CutSide::Left ? -1 : 0);
        const std::int32_t y = cell.j + (joint.side == CutSide::Top ? 1 : joint.side == CutSide::Bottom ? -1 : 0);
        if (!inside(x, y)) continue;
        parent_[root(p)] = root(joint.part >= 0 ? static_cast<std::size_t>(joint.part) : whole(x, y));
      }
    }
  }

  const CutCells& cut_;
  std::int32_t nx_, ny_;
  std::vector<std::size_t> parent_;
  std::vector<double> area_;
};

inline std::vector<double> connectedAreas(const CutCells& cut, std::int32_t nx, std::int32_t ny) {
  return CutRegions(cut, nx, ny).areas();
}

}  // namespace froude::test
