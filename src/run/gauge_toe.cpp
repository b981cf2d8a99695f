// The toe: connected regions of wet cells, built up from the right until the answer is certain.
#include <algorithm>
#include <cmath>

#include "run/gauge_surface.h"

namespace froude::run {
namespace {

constexpr std::size_t kDropCells = 64;  // 16 dx²

/// Wet cells [begin, end) of one column, and the region they belong to.
struct Run {
  std::int64_t begin, end;
  std::size_t region;
};

/// Regions as a forest: a united region knows its parent, a root knows the sums.
class Regions {
 public:
  struct Region {
    std::size_t parent;
    double reach;  // largest x [m]
    std::size_t cells;
    bool onFloor;
  };

  std::size_t add(double reach, std::size_t cells, bool onFloor) {
    all_.push_back({all_.size(), reach, cells, onFloor});
    return all_.size() - 1;
  }
  std::size_t root(std::size_t region) {
    while (all_[region].parent != region) region = all_[region].parent = all_[all_[region].parent].parent;
    return region;
  }
  std::size_t unite(std::size_t a, std::size_t b) {
    a = root(a);
    b = root(b);
    if (a == b) return a;
    all_[b].parent = a;
    all_[a].reach = std::max(all_[a].reach, all_[b].reach);
    all_[a].cells += all_[b].cells;
    all_[a].onFloor |= all_[b].onFloor;
    return a;
  }
  /// The farthest region on the floor that is no drop; −∞ if there is none yet.
  double best() const {
    double reach = -kInfinity;
    for (std::size_t r = 0; r < all_.size(); ++r)
      if (all_[r].parent == r && all_[r].onFloor && all_[r].cells >= kDropCells) reach = std::max(reach, all_[r].reach);
    return reach;
  }
  /// Where there are only drops: the largest on the floor. NaN if there is none.
  double largestDrop() const {
    double reach = std::nan("");
    std::size_t cells = 0;
    for (std::size_t r = 0; r < all_.size(); ++r)
      if (all_[r].parent == r && all_[r].onFloor && all_[r].cells > cells) {
        reach = all_[r].reach;
        cells = all_[r].cells;
      }
    return reach;
  }
  double reach(std::size_t region) { return all_[root(region)].reach; }

 private:
  std::vector<Region> all_;
};

void uniteNeighbours(std::vector<Run>& runs, const std::vector<Run>& right, Regions& regions) {
  std::size_t k = 0;
  for (Run& run : runs) {
    while (k < right.size() && right[k].end <= run.begin) ++k;
    for (std::size_t n = k; n < right.size() && right[n].begin < run.end; ++n)
      run.region = regions.unite(run.region, right[n].region);
  }
}

}  // namespace

/// φ of whole columns of the window, one after the other; cells far from any particle are −1 unless `everywhere`.
std::vector<float> FluidSurface::columnsOf(std::int64_t first, std::int64_t count, bool everywhere) const {
  std::vector<float> phi(static_cast<std::size_t>(count * rows_), -1.0f);
  std::vector<Vec2> points;
  std::vector<std::size_t> places;
  for (std::int64_t i = 0; i < count; ++i)
    for (std::int64_t j = 0; j < rows_; ++j)
      if (everywhere || active(first + i, j)) {
        points.push_back(node(first + i, j));
        places.push_back(static_cast<std::size_t>(i * rows_ + j));
      }
  const std::vector<float> values = evaluate(points);
  for (std::size_t k = 0; k < values.size(); ++k) phi[places[k]] = values[k];
  return phi;
}

double FluidSurface::toe() const {
  constexpr std::int64_t kLargestBatch = 64;
  if (rows_ == 0 || columns_ == 0) return std::nan("");
  Regions regions;
  std::vector<Run> runs, right;
  std::vector<float> beyond = columnsOf(columns_, 1, true);  // the column to the right of the one at hand
  std::int64_t batch = 4;
  for (std::int64_t end = columns_; end > 0; end -= batch, batch = std::min(2 * batch, kLargestBatch)) {
    batch = std::min(batch, end);
    const std::vector<float> phi = columnsOf(end - batch, batch, false);
    for (std::int64_t i = batch - 1; i >= 0; --i) {
      const float* column = &phi[static_cast<std::size_t>(i * rows_)];
      const double x = node(end - batch + i, 0).x();
      const std::int64_t bottom = bottomRow(x, rows_);
      runs.clear();
      for (std::int64_t j = 0; j < rows_; ++j) {
        if (!(column[j] >= 0.5f)) continue;
        const std::int64_t begin = j;
        double reach = x;
        for (; j < rows_ && column[j] >= 0.5f; ++j) {
          const float next = beyond[static_cast<std::size_t>(j)];
          if (next >= 0.5f || x + h_ <= reach) continue;
          const Vec2 at = node(end - batch + i, j);
          reach = std::max(reach, x + h_ * crossing(at, static_cast<double>(column[j]), at + Vec2(h_, 0.0),
                                                    static_cast<double>(next)));
        }
        runs.push_back({begin, j, regions.add(reach, static_cast<std::size_t>(j - begin), begin == bottom)});
      }
      uniteNeighbours(runs, right, regions);
      std::swap(runs, right);
      beyond.assign(column, column + rows_);

      // Certain once no region that still grows to the left reaches farther: it might yet come down to the floor.
      const double best = regions.best();
      const bool certain =
          std::none_of(right.begin(), right.end(), [&](const Run& r) { return regions.reach(r.region) > best; });
      if (best > -kInfinity && certain) return best;
    }
  }
  return regions.best() > -kInfinity ? regions.best() : regions.largestDrop();
}

}  // namespace froude::run
