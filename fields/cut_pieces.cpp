#include <froude/fields/cut_pieces.h>

namespace froude::detail {
namespace {

/// Vertices nearer than this to a grid line are on it [cells]: rounding of a pose is not to make slivers.
constexpr double kSnap = 1e-10;

/// The cell to which a vertex at `at` counts along one axis. On a grid line it is the one on the open side of the edge
/// that runs along the line, `openHigh` (−1: none does); where both neighbours are on one side, that; else the higher.
std::int32_t cellOf(double at, double before, double after, int openHigh) {
  const double floor = std::floor(at);
  const auto cell = static_cast<std::int32_t>(floor);
  if (at != floor) return cell;
  if (openHigh >= 0) return openHigh == 1 ? cell : cell - 1;
  return before < at && after < at ? cell - 1 : cell;
}

std::int32_t floorDivide(std::int32_t a, std::int32_t b) { return a / b - (a % b < 0 ? 1 : 0); }

}  // namespace

double snapped(double x) {
  const double line = std::nearbyint(x);
  return std::abs(x - line) < kSnap ? line : x;
}

void CutPieces::clear() {
  pieces_.clear();
  crossings_.clear();
  leftmost_ = lowest_ = highest_ = 0;
}

void CutPieces::place(const CutGrid& grid, const CutOutline& outline) {
  const Polygon& polygon = *outline.polygon;
  const std::size_t count = polygon.vertices().size();
  vertices_.resize(count);
  for (std::size_t v = 0; v < count; ++v) {
    const Vec2 x = (outline.place.toWorld(polygon.vertices()[v]) - grid.origin) / grid.size;
    vertices_[v] = {snapped(x.x()), snapped(x.y()), 0, 0};
  }
  for (std::uint32_t v = 0; v < count; ++v) {
    Vertex& at = vertices_[v];
    const Vertex& before = vertices_[polygon.previous(v)];
    const Vertex& after = vertices_[polygon.next(v)];
    // The open side of an edge is its right.
    int openX = -1, openY = -1;
    if (after.x == at.x && after.y != at.y)
      openX = after.y > at.y ? 1 : 0;
    else if (before.x == at.x && before.y != at.y)
      openX = at.y > before.y ? 1 : 0;
    if (after.y == at.y && after.x != at.x)
      openY = after.x > at.x ? 0 : 1;
    else if (before.y == at.y && before.x != at.x)
      openY = at.x > before.x ? 0 : 1;
    at.i = cellOf(at.x, before.x, after.x, openX);
    at.j = cellOf(at.y, before.y, after.y, openY);
  }
}

void CutPieces::add(const CutGrid& grid, const CutOutline& outline, std::uint32_t number) {
  place(grid, outline);
  for (std::uint32_t e = 0; e < outline.polygon->edgeCount(); ++e) {
    walk(grid, vertices_[e], vertices_[outline.polygon->next(e)], number);
  }
}

// From line to line. Which line is next may be decided wrongly within rounding; the point on it is then moved to the
// corner of the cell, so that each piece stays in its cell and begins where the last one ended.
void CutPieces::walk(const CutGrid& grid, const Vertex& a, const Vertex& b, std::uint32_t number) {
  constexpr auto kLeft = static_cast<std::uint8_t>(CutSide::Left), kRight = static_cast<std::uint8_t>(CutSide::Right),
                 kBottom = static_cast<std::uint8_t>(CutSide::Bottom), kTop = static_cast<std::uint8_t>(CutSide::Top);
  const double dx = b.x - a.x, dy = b.y - a.y;
  const bool right = b.i > a.i, up = b.j > a.j;
  std::int32_t i = a.i, j = a.j;
  CutPiece piece;
  piece.outline = number;
  piece.x0 = a.x - i;
  piece.y0 = a.y - j;
  while (true) {
    const bool sideways = i != b.i, upOrDown = j != b.j;
    const double lineX = right ? i + 1 : i, lineY = up ? j + 1 : j;
    const double shareX = !sideways ? kInfinity : dx != 0.0 ? (lineX - a.x) / dx : 0.0;
    const double shareY = !upOrDown ? kInfinity : dy != 0.0 ? (lineY - a.y) / dy : 0.0;
    const bool crossX = sideways && shareX <= shareY;
    const std::int32_t wrapX = grid.periodX > 0 ? floorDivide(i, grid.periodX) : 0;
    const std::int32_t wrapY = grid.periodY > 0 ? floorDivide(j, grid.periodY) : 0;
    piece.key = cutKey(i - wrapX * grid.periodX, j - wrapY * grid.periodY);
    piece.wrapX = static_cast<std::int16_t>(wrapX);
    piece.wrapY = static_cast<std::int16_t>(wrapY);
    if (!sideways && !upOrDown) {
      piece.to = kInside;
      piece.x1 = b.x - i;
      piece.y1 = b.y - j;
      if (piece.x0 != piece.x1 || piece.y0 != piece.y1 || piece.from != kInside) pieces_.push_back(piece);
      return;
    }
    if (crossX) {
      piece.to = right ? kRight : kLeft;
      piece.x1 = right ? 1.0 : 0.0;
      piece.y1 = std::clamp(a.y + shareX * dy - j, 0.0, 1.0);
    } else {
      piece.to = up ? kTop : kBottom;
      piece.x1 = std::clamp(a.x + shareY * dx - i, 0.0, 1.0);
      piece.y1 = up ? 1.0 : 0.0;
      const std::int32_t row = (up ? j + 1 : j);
      const std::int32_t rowWrap = grid.periodY > 0 ? floorDivide(row, grid.periodY) : 0;
      const std::int32_t rise = up ? -1 : 1;
      crossings_.push_back({crossingKey(i - wrapX * grid.periodX, row - rowWrap * grid.periodY), rise});
      // Of an endless row of copies as many are to the left of column 0 as the outline is periods farther left.
      if (wrapX != 0) crossings_.push_back({crossingKey(-1, row - rowWrap * grid.periodY), -wrapX * rise});
    }
    pieces_.push_back(piece);
    piece.from = crossX ? (right ? kLeft : kRight) : (up ? kBottom : kTop);
    piece.x0 = crossX ? (right ? 0.0 : 1.0) : piece.x1;
    piece.y0 = crossX ? piece.y1 : (up ? 0.0 : 1.0);
    (crossX ? i : j) += (crossX ? right : up) ? 1 : -1;
  }
}

void CutPieces::sumCrossings() {
  std::sort(crossings_.begin(), crossings_.end(),
            [](const CutCrossing& a, const CutCrossing& b) { return a.key < b.key; });
  std::size_t kept = 0;
  leftmost_ = lowest_ = std::numeric_limits<std::int32_t>::max();
  highest_ = std::numeric_limits<std::int32_t>::min();
  for (const CutCrossing& crossing : crossings_) {
    const auto j = static_cast<std::int32_t>(static_cast<std::uint32_t>(crossing.key >> 32) ^ 0x80000000u);
    const auto i = static_cast<std::int32_t>(static_cast<std::uint32_t>(crossing.key) ^ 0x80000000u);
    leftmost_ = std::min(leftmost_, i);
    lowest_ = std::min(lowest_, j);
    highest_ = std::max(highest_, j);
    const bool sameRow = kept > 0 && (crossings_[kept - 1].key >> 32) == (crossing.key >> 32);
    const std::int32_t before = sameRow ? crossings_[kept - 1].winding : 0;
    if (!(sameRow && crossings_[kept - 1].key == crossing.key)) ++kept;
    crossings_[kept - 1] = {crossing.key, before + crossing.winding};
  }
  crossings_.resize(kept);
}

std::int32_t CutPieces::windingAt(std::int32_t i, std::int32_t j) const {
  // To the left of all of them, below or above. To the right the sum need not be 0: sides may be periodic.
  if (i <= leftmost_ || j < lowest_ || j > highest_) return 0;
  const std::uint64_t key = crossingKey(i, j);
  const auto behind = std::lower_bound(crossings_.begin(), crossings_.end(), key,
                                       [](const CutCrossing& c, std::uint64_t k) { return c.key < k; });
  if (behind == crossings_.begin() || (std::prev(behind)->key >> 32) != (key >> 32)) return 0;
  return std::prev(behind)->winding;
}

std::size_t CutPieces::memoryBytes() const {
  return pieces_.capacity() * sizeof(CutPiece) + crossings_.capacity() * sizeof(CutCrossing) +
         vertices_.capacity() * sizeof(Vertex);
}

}  // namespace froude::detail
