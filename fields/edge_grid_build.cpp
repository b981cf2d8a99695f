// Builds the cells of an EdgeGrid from the top down: a square of cells passes on to its quarters only the edges that
// can be closest there, so that the work follows the boundary, not the area.
#include <froude/fields/edge_grid.h>
#include <froude/fields/edge_sieve.h>
#include <froude/fields/predicates.h>

namespace froude::detail {
namespace {

/// Cells along one side of the squares that are worked on in parallel.
constexpr int kTaskSide = 16;
/// A cell that lists more edges than this is divided once more,
constexpr std::size_t kCrowded = 2;
/// and one that lists more than this into more parts.
constexpr std::size_t kVeryCrowded = 8;
/// Parts that do not shorten the lists to this share of the whole cell's are not kept.
constexpr double kWorthDividing = 0.75;

struct Square {
  int i, j, side;

  Square quarter(int q) const { return {i + (q & 1) * (side / 2), j + (q >> 1) * (side / 2), side / 2}; }
};

/// A square of cells with the edges that it can need, and what the task that fills it has found. Offsets in its codes
/// count from the beginning of its own lists.
struct Piece {
  Square square;
  std::vector<std::uint32_t> candidates;
  std::vector<std::uint32_t> lists;  // from offset 1 on, so that no code of a cell with edges is 0
  std::vector<CellCode> partCodes;
};

float towardsZero(double value) {
  const auto rounded = static_cast<float>(value);
  return std::abs(static_cast<double>(rounded)) > std::abs(value) ? std::nextafter(rounded, 0.0F) : rounded;
}

int squareOver(int nx, int ny) {
  int side = 1;
  while (side < std::max(nx, ny)) side *= 2;
  return side;
}

/// Where the part of each piece begins when all are put one after the other behind `start`.
template <typename Size>
std::vector<std::size_t> startsOf(const std::vector<Piece>& pieces, std::size_t start, const Size& size) {
  std::vector<std::size_t> starts{start};
  for (const Piece& piece : pieces) starts.push_back(starts.back() + size(piece));
  return starts;
}

}  // namespace

class EdgeGridBuilder {
 public:
  explicit EdgeGridBuilder(EdgeGrid& grid) : g_(grid), reach_(g_.band_ * kBandMargin + g_.rounding_) {}

  /// False if the codes of the cells have no room for so many lists; the cells must be larger then.
  bool build() {
    buildCoarse();  // signs within rounding are decided with its lists
    g_.codes_.assign(g_.cellCount() + 1, 0);
    g_.clearance_.assign(g_.cellCount() + 1, std::numeric_limits<float>::infinity());
    std::vector<Piece> pieces = piecesOf(squareOver(g_.nx_, g_.ny_),
                                         [this](EdgeSieve& sieve, const Square& s, std::size_t begin, std::size_t end) {
                                           const bool deep = !keepNearest(sieve, s, begin, end);
                                           if (deep) markDeep(s);
                                           return !deep;
                                         });
    parallelFor(pieces.size(), 1, [&](std::size_t k, std::size_t) { fill(pieces[k]); });
    if (!join(pieces)) return false;
    spreadClearance();
    return true;
  }

 private:
  /// A hair larger than the cells, so that a point that rounding puts into a neighbour still finds its edges.
  Box boxOf(const Square& s, double cell) const {
    const Vec2 corner = g_.box_.min + Vec2(s.i, s.j) * cell;
    return Box{corner, corner + Vec2(s.side, s.side) * cell}.grown(1e-6 * g_.cell_);
  }

  bool keepNearest(EdgeSieve& sieve, const Square& s, std::size_t begin, std::size_t end) const {
    return sieve.keepNearest(boxOf(s, g_.cell_), begin, end, {reach_, s.side == 1 || !g_.oneOutline()});
  }

  /// Squares of at most kTaskSide cells that keep any edges. `keep` sieves for a square and says whether to go on.
  template <typename Keep>
  std::vector<Piece> piecesOf(int side, const Keep& keep) const {
    EdgeSieve sieve(g_);
    for (std::uint32_t e = 0; e < g_.edges_.size(); ++e) sieve.stack().push_back(e);
    std::vector<Piece> pieces;
    collect(sieve, {0, 0, side}, 0, sieve.stack().size(), keep, &pieces);
    return pieces;
  }

  template <typename Keep>
  void collect(EdgeSieve& sieve, const Square& s, std::size_t begin, std::size_t end, const Keep& keep,
               std::vector<Piece>* pieces) const {
    const std::size_t mark = sieve.stack().size();
    if (s.i < g_.nx_ && s.j < g_.ny_ && keep(sieve, s, begin, end) && sieve.stack().size() > mark) {
      const std::size_t kept = sieve.stack().size();
      if (s.side <= kTaskSide) {
        const auto first = sieve.stack().begin() + static_cast<std::ptrdiff_t>(mark);
        pieces->push_back({s, {first, sieve.stack().end()}, {0}, {}});
      } else {
        for (int q = 0; q < 4; ++q) collect(sieve, s.quarter(q), mark, kept, keep, pieces);
      }
    }
    sieve.stack().resize(mark);
    sieve.groups().clear();
  }

  void fill(Piece& piece) {
    EdgeSieve sieve(g_);
    sieve.stack() = piece.candidates;
    const std::size_t all = sieve.stack().size();
    if (piece.square.side == 1) {
      fillSquare(sieve, piece.square, 0, all, piece);
    } else {
      for (int q = 0; q < 4; ++q) fillSquare(sieve, piece.square.quarter(q), 0, all, piece);
    }
  }

  /// Candidates [begin, end) are what the square's parent kept. Leaves the stacks as they were.
  void fillSquare(EdgeSieve& sieve, const Square& s, std::size_t begin, std::size_t end, Piece& piece) {
    if (s.i >= g_.nx_ || s.j >= g_.ny_) return;
    const std::size_t mark = sieve.stack().size();
    const std::size_t groupMark = sieve.groups().size();
    if (!keepNearest(sieve, s, begin, end)) {
      markDeep(s);
    } else if (sieve.stack().size() > mark) {
      if (s.side == 1) {
        storeCell(sieve, s, mark, groupMark, piece);
      } else {
        const std::size_t kept = sieve.stack().size();
        for (int q = 0; q < 4; ++q) fillSquare(sieve, s.quarter(q), mark, kept, piece);
      }
    }
    sieve.stack().resize(mark);
    sieve.groups().resize(groupMark);
  }

  void storeCell(EdgeSieve& sieve, const Square& s, std::size_t mark, std::size_t groupMark, Piece& piece) {
    double outside = kInfinity;
    double depth = 0.0;
    for (std::size_t k = groupMark; k < sieve.groups().size(); ++k) {
      const EdgeSieve::Group& group = sieve.groups()[k];
      if (group.inside) depth = std::max(depth, group.least);
      outside = std::min(outside, group.least);
    }
    const std::size_t cell = cellIndex(s.i, s.j);
    g_.clearance_[cell] = towardsZero(depth > 0.0 ? -depth : outside);
    const bool oneSource = sieve.groups().size() == groupMark + 1;
    const CellCode code = storeList(sieve.stack(), mark, oneSource, piece);
    const std::size_t count = sieve.stack().size() - mark;
    g_.codes_[cell] = oneSource && count > kCrowded ? divideCell(sieve, s, mark, code, piece) : code;
  }

  /// The code of the divided cell, or `whole` if its parts are hardly better off.
  CellCode divideCell(EdgeSieve& sieve, const Square& s, std::size_t mark, CellCode whole, Piece& piece) const {
    const std::size_t count = sieve.stack().size() - mark;
    const std::uint32_t shift = count > kVeryCrowded ? kManyPartsShift : kPartsShift;
    const std::size_t partsMark = piece.partCodes.size();
    const std::size_t listsMark = piece.lists.size();
    piece.partCodes.push_back(whole);
    piece.partCodes.resize(partsMark + 1 + (std::size_t{1} << (2 * shift)));
    Parts parts{s, shift, piece.partCodes.data() + partsMark + 1};
    const std::size_t end = sieve.stack().size();
    for (int q = 0; q < 4; ++q) fillPart(sieve, Square{0, 0, 1 << shift}.quarter(q), mark, end, parts, piece);
    const double mean = static_cast<double>(parts.listed) / static_cast<double>(std::size_t{1} << (2 * shift));
    if (mean > kWorthDividing * static_cast<double>(count)) {
      piece.partCodes.resize(partsMark);
      piece.lists.resize(listsMark);
      return whole;
    }
    return dividedCode(static_cast<std::uint32_t>(partsMark + 1), shift);
  }

  struct Parts {
    Square cell;
    std::uint32_t shift;
    CellCode* codes;
    std::size_t listed = 0;  // edges in the lists of all parts
  };

  /// Square `s` in parts of the cell; the candidates are [begin, end) of the stack. However far a part is, it keeps its
  /// nearest edges.
  void fillPart(EdgeSieve& sieve, const Square& s, std::size_t begin, std::size_t end, Parts& parts,
                Piece& piece) const {
    const double size = g_.cell_ / (1 << parts.shift);
    const Vec2 corner = g_.box_.min + Vec2(parts.cell.i, parts.cell.j) * g_.cell_ + Vec2(s.i, s.j) * size;
    const Box box = Box{corner, corner + Vec2(s.side, s.side) * size}.grown(1e-6 * g_.cell_);
    const std::size_t mark = sieve.stack().size();
    const std::size_t groupMark = sieve.groups().size();
    sieve.keepNearest(box, begin, end, {kInfinity, false});
    const std::size_t count = sieve.stack().size() - mark;
    if (s.side == 1 || count <= kCrowded) {
      const CellCode code = storeList(sieve.stack(), mark, true, piece);
      for (int j = s.j; j < s.j + s.side; ++j) {
        for (int i = s.i; i < s.i + s.side; ++i) parts.codes[(j << parts.shift) + i] = code;
      }
      parts.listed += count * static_cast<std::size_t>(s.side * s.side);
    } else {
      for (int q = 0; q < 4; ++q) fillPart(sieve, s.quarter(q), mark, mark + count, parts, piece);
    }
    sieve.stack().resize(mark);
    sieve.groups().resize(groupMark);
  }

  /// Stores the stack from `mark` on, unless it stands somewhere already: edges that follow each other, as most do, in
  /// the list of all edges, and what the neighbour keeps at the end of the last list.
  CellCode storeList(const std::vector<std::uint32_t>& stack, std::size_t mark, bool oneSource, Piece& piece) const {
    const std::size_t count = stack.size() - mark;
    const bool counted = oneSource && count <= kMostListed;
    if (counted && stack.back() - stack[mark] == count - 1)
      return listCode(stack[mark], static_cast<std::uint32_t>(count));
    const auto first = stack.begin() + static_cast<std::ptrdiff_t>(mark);
    std::vector<std::uint32_t>& lists = piece.lists;
    if (counted && lists.size() > count &&
        std::equal(first, stack.end(), lists.end() - static_cast<std::ptrdiff_t>(count))) {
      return ownCode(lists.size() - count, count);
    }
    const std::size_t offset = lists.size();
    if (!counted) lists.push_back(static_cast<std::uint32_t>(count));
    lists.insert(lists.end(), first, stack.end());
    return ownCode(offset, counted ? count : 0);
  }

  /// Code of a list of the piece itself, until `join` knows where it goes: behind all edges.
  CellCode ownCode(std::size_t offset, std::size_t count) const {
    return listCode(static_cast<std::uint32_t>(g_.edges_.size() + offset), static_cast<std::uint32_t>(count));
  }

  /// Puts the pieces one after the other.
  bool join(std::vector<Piece>& pieces) {
    const auto lists = startsOf(pieces, std::max<std::size_t>(1, g_.edges_.size()),
                                [](const Piece& piece) { return piece.lists.size(); });
    const auto parts = startsOf(pieces, 0, [](const Piece& piece) { return piece.partCodes.size(); });
    if (lists.back() > kListOffsetMask || parts.back() > kFirstPartMask) return false;
    g_.lists_.assign(lists.back() + 1, 0);  // one entry behind the last, for loops that read in pairs
    for (std::uint32_t e = 0; e < g_.edges_.size(); ++e) g_.lists_[e] = e;
    g_.partCodes_.resize(parts.back());
    parallelFor(pieces.size(), 1, [&](std::size_t k, std::size_t) {
      const Piece& piece = pieces[k];
      const auto listBase = static_cast<std::uint32_t>(lists[k]);
      const auto edgeCount = static_cast<std::uint32_t>(g_.edges_.size());
      const auto partBase = static_cast<std::uint32_t>(parts[k]);
      const auto moved = [&](CellCode code) {
        if (isDivided(code)) return code + partBase;
        return listOffset(code) < edgeCount ? code : code + (listBase - edgeCount);
      };
      std::copy(piece.lists.begin(), piece.lists.end(), g_.lists_.begin() + listBase);
      std::transform(piece.partCodes.begin(), piece.partCodes.end(), g_.partCodes_.begin() + partBase, moved);
      const Square& s = piece.square;
      for (int j = s.j; j < std::min(s.j + s.side, g_.ny_); ++j) {
        for (int i = s.i; i < std::min(s.i + s.side, g_.nx_); ++i) {
          CellCode& code = g_.codes_[cellIndex(i, j)];
          code = moved(code);
        }
      }
    });
    return true;
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
    // With a border of one cell, so that no cell needs to know whether it stands at the edge. Outside an unsealed box
    // there may be anything.
    const std::size_t stride = static_cast<std::size_t>(nx) + 2;
    std::vector<float> steps(stride * (static_cast<std::size_t>(ny) + 2), g_.sealed_ ? kFar : 0.0F);
    const auto row = [&](int j) { return steps.data() + static_cast<std::size_t>(j + 1) * stride + 1; };
    for (int j = 0; j < ny; ++j) {
      for (int i = 0; i < nx; ++i) row(j)[i] = g_.codes_[cellIndex(i, j)] != 0 ? 0.0F : kFar;
    }
    const auto sweep = [&](int j, int dir) {
      float* here = row(j);
      const float* behind = row(j - dir);
      for (int i = 0; i < nx; ++i) {
        here[i] = std::min(std::min(here[i], behind[i] + 1.0F), std::min(behind[i - 1], behind[i + 1]) + kDiagonal);
      }
      const int first = dir > 0 ? 0 : nx - 1;
      for (int k = 0, i = first; k < nx; ++k, i += dir) here[i] = std::min(here[i], here[i - dir] + 1.0F);
    };
    for (int j = 0; j < ny; ++j) sweep(j, 1);
    for (int j = ny - 1; j >= 0; --j) sweep(j, -1);
    parallelFor(static_cast<std::size_t>(ny), 64, [&](std::size_t begin, std::size_t end) {
      for (auto j = static_cast<int>(begin); j < static_cast<int>(end); ++j) {
        for (int i = 0; i < nx; ++i) {
          const std::size_t c = cellIndex(i, j);
          if (g_.codes_[c] != 0) continue;
          const float far = row(j)[i];
          const double cells = std::max(0.0, static_cast<double>(far) * 0.923 - 1.4143);
          const double clearance = far >= 0.5F * kFar ? kInfinity : g_.band_ * kBandMargin + cells * g_.cell_;
          g_.clearance_[c] = towardsZero(std::copysign(clearance, static_cast<double>(g_.clearance_[c])));
        }
      }
    });
  }

  /// Coarse cells: every edge within reach, of every source.
  void buildCoarse() {
    const double cell = g_.cell_ * g_.coarse_;
    g_.coarseListOf_.assign(static_cast<std::size_t>(g_.coarseNx_) * static_cast<std::size_t>(g_.coarseNy_), 0);
    g_.coarseLists_.assign(1, 0);
    EdgeSieve sieve(g_);
    for (std::uint32_t e = 0; e < g_.edges_.size(); ++e) sieve.stack().push_back(e);
    divideWithin(sieve, {0, 0, squareOver(g_.coarseNx_, g_.coarseNy_)}, 0, cell);
    g_.coarseLists_.shrink_to_fit();
  }

  void divideWithin(EdgeSieve& sieve, const Square& s, std::size_t begin, double cell) {
    if (s.i >= g_.coarseNx_ || s.j >= g_.coarseNy_) return;
    const std::size_t mark = sieve.stack().size();
    sieve.keepWithin(boxOf(s, cell), begin, mark, reach_);
    const std::size_t count = sieve.stack().size() - mark;
    if (count > 0 && s.side == 1) {
      g_.coarseListOf_[static_cast<std::size_t>(s.j) * static_cast<std::size_t>(g_.coarseNx_) +
                       static_cast<std::size_t>(s.i)] = static_cast<std::uint32_t>(g_.coarseLists_.size());
      g_.coarseLists_.push_back(static_cast<std::uint32_t>(count));
      g_.coarseLists_.insert(g_.coarseLists_.end(), sieve.stack().begin() + static_cast<std::ptrdiff_t>(mark),
                             sieve.stack().end());
    } else if (count > 0) {
      for (int q = 0; q < 4; ++q) divideWithin(sieve, s.quarter(q), mark, cell);
    }
    sieve.stack().resize(mark);
  }

  std::size_t cellIndex(int i, int j) const {
    return static_cast<std::size_t>(j) * static_cast<std::size_t>(g_.nx_) + static_cast<std::size_t>(i);
  }

  EdgeGrid& g_;
  const double reach_;
};

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
  GridPlan roomy = plan;
  for (layOut(roomy); !EdgeGridBuilder(*this).build(); layOut(roomy)) roomy.cellSize = 1.5 * cell_;
}

void EdgeGrid::layOut(const GridPlan& plan) {
  band_ = plan.band;
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
