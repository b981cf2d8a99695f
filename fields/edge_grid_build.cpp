// Builds the cells of an EdgeGrid from the top down: a square of cells passes on to its quarters only the edges that
// can be closest there, so that the work follows the boundary, not the area.
#include <array>

#include <froude/fields/edge_grid.h>
#include <froude/fields/edge_grid_nearest.h>
#include <froude/fields/predicates.h>

namespace froude::detail {
namespace {

using Corners = std::array<Vec2, 4>;
using Squares = std::array<double, 4>;  // squared distances of something to the corners of a box

Corners cornersOf(const Box& box) {
  return {box.min, Vec2(box.max.x(), box.min.y()), box.max, Vec2(box.min.x(), box.max.y())};
}

struct Reach {
  double least;     // distance of the box's nearest point to the edge
  double most;      // of its farthest: the distance to a convex set is convex, so that is a corner
  Squares squares;  // of the corners to the edge
};

Reach reachOf(const GridEdge& e, const Box& box) {
  const Corners corners = cornersOf(box);
  Reach reach{};
  for (std::size_t k = 0; k < 4; ++k) reach.squares[k] = squaredDistance(e, corners[k]);
  double least = *std::min_element(reach.squares.begin(), reach.squares.end());
  for (const Vec2& end : {e.a, e.b}) {
    const Vec2 out = (box.min - end).cwiseMax(end - box.max).cwiseMax(0.0);
    least = std::min(least, out.squaredNorm());
  }
  if (least > 0.0 && least < box.size().squaredNorm()) {
    // Passing through without an end inside: it must cross a diagonal.
    if (segmentContact(e.a, e.b, corners[0], corners[2]) != SegmentContact::None ||
        segmentContact(e.a, e.b, corners[1], corners[3]) != SegmentContact::None) {
      least = 0.0;
    }
  }
  reach.least = std::sqrt(least);
  reach.most = std::sqrt(*std::max_element(reach.squares.begin(), reach.squares.end()));
  return reach;
}

Vec2 closestPoint(const GridEdge& e, const Vec2& p) {
  return e.a + std::clamp(e.direction.dot(p - e.a), 0.0, e.length) * e.direction;
}

/// Tells which edges can be closest to some point of a box. For two points p and q, |x − p|² − |x − q|² is linear in x,
/// so if at all corners an edge is farther than q, each of its points is, everywhere in the box. The points q tried are
/// those of the outline that are closest to the corners and to the centre.
class Rivals {
 public:
  Rivals(std::span<const GridEdge> edges, std::span<const std::uint32_t> candidates, std::span<const Reach> reaches,
         const Box& box, double rounding)
      : margin_(rounding) {
    const Corners corners = cornersOf(box);
    std::array<std::size_t, 5> winner{};
    Squares best;
    best.fill(kInfinity);
    double center = kInfinity;
    for (std::size_t k = 0; k < reaches.size(); ++k) {
      for (std::size_t c = 0; c < 4; ++c) {
        if (reaches[k].squares[c] < best[c]) best[c] = reaches[k].squares[c], winner[c] = k;
      }
      const double square = squaredDistance(edges[candidates[k]], box.center());
      if (square < center) center = square, winner[4] = k;
    }
    for (std::size_t c = 0; c < 5; ++c) {
      const Vec2 q = closestPoint(edges[candidates[winner[c]]], c < 4 ? corners[c] : box.center());
      for (std::size_t k = 0; k < 4; ++k) squares_[c][k] = (corners[k] - q).squaredNorm();
    }
  }

  bool beat(const Reach& reach) const {
    return std::any_of(squares_.begin(), squares_.end(), [&](const Squares& q) {
      for (std::size_t k = 0; k < 4; ++k) {
        if (reach.squares[k] <= q[k] * (1.0 + 1e-12) + margin_ * (std::sqrt(q[k]) + margin_)) return false;
      }
      return true;
    });
  }

 private:
  double margin_;
  std::array<Squares, 5> squares_;
};

float towardsZero(double value) {
  const auto rounded = static_cast<float>(value);
  return std::abs(static_cast<double>(rounded)) > std::abs(value) ? std::nextafter(rounded, 0.0F) : rounded;
}

}  // namespace

class EdgeGridBuilder {
 public:
  explicit EdgeGridBuilder(EdgeGrid& grid) : g_(grid) {
    const std::size_t cells = static_cast<std::size_t>(g_.nx_) * static_cast<std::size_t>(g_.ny_);
    g_.listOf_.assign(cells, 0);
    g_.clearance_.assign(cells, std::numeric_limits<float>::infinity());
    g_.lists_.assign(1, 0);
    g_.coarseLists_.assign(1, 0);
    g_.coarseListOf_.assign(static_cast<std::size_t>(g_.coarseNx_) * static_cast<std::size_t>(g_.coarseNy_), 0);
  }

  void build() {
    int side = 1;
    while (side < std::max(g_.nx_, g_.ny_)) side *= 2;
    candidates_.resize(g_.edges_.size());
    for (std::uint32_t i = 0; i < g_.edges_.size(); ++i) candidates_[i] = i;
    const std::size_t all = candidates_.size();
    divideNearest({0, 0, side}, 0, all);
    spreadClearance();
    candidates_.resize(all);
    lastList_ = 0;
    side = 1;
    while (side < std::max(g_.coarseNx_, g_.coarseNy_)) side *= 2;
    divideWithin({0, 0, side}, 0, all);
    g_.lists_.shrink_to_fit();
    g_.coarseLists_.shrink_to_fit();
  }

 private:
  struct Square {
    int i, j, side;
  };
  /// The edges of one source that a square keeps: a range of candidates_.
  struct Group {
    std::size_t begin, end;
    double least, most;  // distance of any point of the square to the outline
    bool inside;         // the whole square is, if least > 0
  };

  /// A hair larger than the cells, so that a point that rounding puts into a neighbour still finds its edges.
  Box boxOf(const Square& s, double cell) const {
    const Vec2 corner = g_.box_.min + Vec2(s.i, s.j) * cell;
    return Box{corner, corner + Vec2(s.side, s.side) * cell}.grown(1e-6 * cell);
  }

  /// Candidates [begin, end) are what the square's parent kept. Leaves candidates_ as it was.
  void divideNearest(const Square& s, std::size_t begin, std::size_t end) {
    if (s.i >= g_.nx_ || s.j >= g_.ny_) return;
    const std::size_t mark = candidates_.size();
    const std::size_t groupMark = groups_.size();
    const bool deep = !keepNearest(boxOf(s, g_.cell_), begin, end);
    if (deep) {
      markDeep(s);
    } else if (candidates_.size() > mark) {
      if (s.side == 1) {
        storeCell(s, mark, groupMark);
      } else {
        const std::size_t kept = candidates_.size();
        const int half = s.side / 2;
        for (int q = 0; q < 4; ++q) {
          divideNearest({s.i + (q & 1) * half, s.j + (q >> 1) * half, half}, mark, kept);
        }
      }
    }
    candidates_.resize(mark);
    groups_.resize(groupMark);
  }

  /// Appends the edges that may be closest to a point of `box`, source by source, and their groups. False if the whole
  /// box is inside one of them, deeper than the band.
  bool keepNearest(const Box& box, std::size_t begin, std::size_t end) {
    const std::size_t groupMark = groups_.size();
    double upper = kInfinity;  // no point of the box is farther than this from its nearest source
    while (begin < end) {
      const std::uint32_t source = g_.edges_[candidates_[begin]].source;
      std::size_t groupEnd = begin;
      double least = kInfinity;
      double most = kInfinity;
      reaches_.clear();
      for (; groupEnd < end && g_.edges_[candidates_[groupEnd]].source == source; ++groupEnd) {
        reaches_.push_back(reachOf(g_.edges_[candidates_[groupEnd]], box));
        least = std::min(least, reaches_.back().least);
        most = std::min(most, reaches_.back().most);
      }
      const bool inside = least > 0.0 && centerInside(box.center(), begin, groupEnd);
      if (least > reach()) {
        if (inside) return false;
      } else {
        const std::size_t first = candidates_.size();
        keepUnbeaten(box, begin, most);
        groups_.push_back({first, candidates_.size(), least, most, inside});
        upper = std::min(upper, most);
      }
      begin = groupEnd;
    }
    dropDominated(groupMark, upper);
    return true;
  }

  /// Appends those of the candidates from `begin` on, whose reaches_ are known, that can be closest in the box.
  void keepUnbeaten(const Box& box, std::size_t begin, double most) {
    const std::span<const std::uint32_t> group(candidates_.data() + begin, reaches_.size());
    const Rivals rivals(g_.edges_, group, reaches_, box, g_.rounding_);
    for (std::size_t k = 0; k < reaches_.size(); ++k) {
      if (reaches_[k].least > most * (1.0 + 1e-12) + g_.rounding_ || rivals.beat(reaches_[k])) continue;
      candidates_.push_back(candidates_[begin + k]);
    }
  }

  /// A source that lies outside the box and farther than another's farthest point is nowhere the nearest.
  void dropDominated(std::size_t groupMark, double upper) {
    if (groups_.size() < groupMark + 2) return;
    std::size_t to = groups_[groupMark].begin;
    std::size_t kept = groupMark;
    for (std::size_t g = groupMark; g < groups_.size(); ++g) {
      Group group = groups_[g];
      if (!group.inside && group.least > upper * (1.0 + 1e-12) + g_.rounding_) continue;
      const std::size_t first = to;
      for (std::size_t k = group.begin; k < group.end; ++k) candidates_[to++] = candidates_[k];
      group.begin = first;
      group.end = to;
      groups_[kept++] = group;
    }
    groups_.resize(kept);
    candidates_.resize(to);
  }

  bool centerInside(const Vec2& center, std::size_t begin, std::size_t end) const {
    EdgeGrid::Nearest nearest{g_, center};
    for (std::size_t k = begin; k < end; ++k) nearest.consider(candidates_[k]);
    nearest.closeSource(g_.edges_[candidates_[begin]].source);
    return nearest.any && nearest.best < 0.0;
  }

  void storeCell(const Square& s, std::size_t mark, std::size_t groupMark) {
    const std::size_t cell = cellIndex(s.i, s.j);
    g_.listOf_[cell] = storeList(g_.lists_, mark);
    double outside = kInfinity;
    double depth = 0.0;
    for (std::size_t k = groupMark; k < groups_.size(); ++k) {
      if (groups_[k].inside) depth = std::max(depth, groups_[k].least);
      outside = std::min(outside, groups_[k].least);
    }
    g_.clearance_[cell] = towardsZero(depth > 0.0 ? -depth : outside);
  }

  /// Neighbouring cells often keep the same edges: the last list is used again where it fits.
  std::uint32_t storeList(std::vector<std::uint32_t>& lists, std::size_t mark) {
    const std::size_t count = candidates_.size() - mark;
    if (count == 0) return 0;
    if (lastList_ > 0 && lastList_ < lists.size() && lists[lastList_] == count &&
        std::equal(candidates_.begin() + static_cast<std::ptrdiff_t>(mark), candidates_.end(),
                   lists.begin() + lastList_ + 1)) {
      return lastList_;
    }
    lastList_ = static_cast<std::uint32_t>(lists.size());
    lists.push_back(static_cast<std::uint32_t>(count));
    lists.insert(lists.end(), candidates_.begin() + static_cast<std::ptrdiff_t>(mark), candidates_.end());
    return lastList_;
  }

  void markDeep(const Square& s) {
    for (int j = s.j; j < std::min(s.j + s.side, g_.ny_); ++j) {
      for (int i = s.i; i < std::min(s.i + s.side, g_.nx_); ++i) {
        g_.clearance_[cellIndex(i, j)] = -std::numeric_limits<float>::infinity();
      }
    }
  }

  /// Far cells get the band + the distance to the nearest cell that has a list. The octagonal distance of two sweeps
  /// never exceeds 1.0824 times the Euclidean one of the centres, and cells are closer than their centres by at most a
  /// diagonal.
  void spreadClearance() {
    const int nx = g_.nx_;
    const int ny = g_.ny_;
    constexpr float kFar = 1e9F;
    constexpr float kDiagonal = 1.41421356F;
    std::vector<float> steps(g_.listOf_.size());
    for (std::size_t c = 0; c < steps.size(); ++c) steps[c] = g_.listOf_[c] != 0 ? 0.0F : kFar;
    const float border = g_.sealed_ ? kFar : 1.0F;  // outside an unsealed box there may be anything
    const auto at = [&](int i, int j) {
      return i < 0 || i >= nx || j < 0 || j >= ny ? border - 1.0F : steps[cellIndex(i, j)];
    };
    const auto relax = [&](int i, int j, int dir) {
      float& here = steps[cellIndex(i, j)];
      here = std::min({here, at(i - dir, j) + 1.0F, at(i, j - dir) + 1.0F, at(i - 1, j - dir) + kDiagonal,
                       at(i + 1, j - dir) + kDiagonal});
    };
    for (int j = 0; j < ny; ++j) {
      for (int i = 0; i < nx; ++i) relax(i, j, 1);
    }
    for (int j = ny - 1; j >= 0; --j) {
      for (int i = nx - 1; i >= 0; --i) relax(i, j, -1);
    }
    for (std::size_t c = 0; c < steps.size(); ++c) {
      if (g_.listOf_[c] != 0) continue;
      const double cells = std::max(0.0, steps[c] * 0.923 - 1.4143);
      const double far = steps[c] >= 0.5F * kFar ? kInfinity : g_.band_ * kBandMargin + cells * g_.cell_;
      g_.clearance_[c] = towardsZero(std::copysign(far, static_cast<double>(g_.clearance_[c])));
    }
  }

  /// Coarse cells: every edge within reach, of every source.
  void divideWithin(const Square& s, std::size_t begin, std::size_t end) {
    if (s.i >= g_.coarseNx_ || s.j >= g_.coarseNy_) return;
    const std::size_t mark = candidates_.size();
    const Box box = boxOf(s, g_.cell_ * g_.coarse_);
    for (std::size_t k = begin; k < end; ++k) {
      if (reachOf(g_.edges_[candidates_[k]], box).least <= reach()) candidates_.push_back(candidates_[k]);
    }
    const std::size_t kept = candidates_.size();
    if (kept > mark) {
      if (s.side == 1) {
        g_.coarseListOf_[static_cast<std::size_t>(s.j) * static_cast<std::size_t>(g_.coarseNx_) +
                         static_cast<std::size_t>(s.i)] = storeList(g_.coarseLists_, mark);
      } else {
        const int half = s.side / 2;
        for (int q = 0; q < 4; ++q) {
          divideWithin({s.i + (q & 1) * half, s.j + (q >> 1) * half, half}, mark, kept);
        }
      }
    }
    candidates_.resize(mark);
  }

  double reach() const { return g_.band_ * kBandMargin + g_.rounding_; }

  std::size_t cellIndex(int i, int j) const {
    return static_cast<std::size_t>(j) * static_cast<std::size_t>(g_.nx_) + static_cast<std::size_t>(i);
  }

  EdgeGrid& g_;
  std::vector<std::uint32_t> candidates_;  // a stack: each level of squares appends what it keeps
  std::vector<Group> groups_;
  std::vector<Reach> reaches_;
  std::uint32_t lastList_ = 0;
};

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

EdgeGrid::EdgeGrid(std::vector<GridEdge> edges, const GridPlan& plan) : edges_(std::move(edges)) {
  next_.assign(edges_.size(), -1);
  for (std::uint32_t i = 0; i < edges_.size(); ++i) {
    GridEdge& e = edges_[i];
    if (i == 0 || e.source != edges_[i - 1].source) sourceStarts_.push_back(i);
    if (e.previous >= 0) {
      GridEdge& before = edges_[static_cast<std::size_t>(e.previous)];
      e.convexStart = before.convexEnd = orientation(before.a, e.a, e.b) > 0 ? 1 : 0;
      next_[static_cast<std::size_t>(e.previous)] = static_cast<std::int32_t>(i);
    }
    outlines_.include(e.a);
    outlines_.include(e.b);
  }
  sourceStarts_.push_back(static_cast<std::uint32_t>(edges_.size()));
  layOut(plan);
  EdgeGridBuilder(*this).build();
}

void EdgeGrid::layOut(const GridPlan& plan) {
  band_ = plan.band;
  farther_ = static_cast<float>(band_ * (kBandMargin + 1e-3));
  sealed_ = plan.sealed;
  const Vec2 size = plan.box.size();
  cell_ = plan.cellSize;
  const auto cells = [&] { return (std::floor(size.x() / cell_) + 1.0) * (std::floor(size.y() / cell_) + 1.0); };
  while (!(cells() <= static_cast<double>(plan.cellLimit))) cell_ *= 1.1;
  nx_ = static_cast<int>(std::floor(size.x() / cell_)) + 1;
  ny_ = static_cast<int>(std::floor(size.y() / cell_)) + 1;
  inverseCell_ = 1.0 / cell_;
  box_ = {plan.box.min, plan.box.min + Vec2(nx_, ny_) * cell_};
  coarse_ = std::clamp(static_cast<int>(std::ceil(band_ / cell_)), 1, std::max(nx_, ny_));
  coarseNx_ = (nx_ + coarse_ - 1) / coarse_;
  coarseNy_ = (ny_ + coarse_ - 1) / coarse_;
  walls_ = plan.walls;
  Box all = box_;
  for (const GridEdge& e : edges_) {
    if (walls_ && e.source == 0)
      continue;  // these reach far out, but are parallel to the axes, so nothing is lost there
    all.include(e.a);
    all.include(e.b);
  }
  scale_ = std::max(all.min.cwiseAbs().maxCoeff(), all.max.cwiseAbs().maxCoeff());
  rounding_ = 0x1p-46 * scale_;
}

}  // namespace froude::detail
