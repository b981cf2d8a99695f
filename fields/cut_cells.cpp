#include <froude/fields/cut_cells.h>

#include <froude/base/assert.h>
#include <froude/base/parallel.h>
#include <froude/fields/cut_list.h>

namespace froude {
namespace {

using detail::CutPiece;

constexpr std::uint32_t kWalls = 4;  // numbers of outlines that are walls of the domain, by side

/// Walls stand this far beyond the open sides of the box [cells]: what is still simulated there meets them.
constexpr std::int32_t kBeyond = 8;

constexpr std::size_t kCellsPerTask = 64;

/// Of a wall: the cell on its open side that it is in, and where.
struct WallLine {
  std::int32_t cell = 0;
  double at = 0.0;
};

}  // namespace

struct CutCells::Data {
  /// A cell that a moving outline touches or covers.
  struct Task {
    std::size_t source = 0;                  // in sources
    std::ptrdiff_t fixed = -1, moving = -1;  // cell of the layer; −1: none
    std::int32_t winding = 0;
  };

  CutGrid grid;
  CutWalls walls;
  std::array<WallLine, 4> lines;
  std::array<std::int32_t, 4> covered{0, 0, -1, -1};
  std::uint64_t version = 0;

  detail::CutLayer fixed, moving;
  std::size_t outlinePieces = 0;  // of the fixed layer; those of the walls follow
  std::vector<detail::CutOwner> owners;
  std::size_t fixedOwners = 0;
  std::vector<detail::CutSource> fixedCells, sources;  // of the fixed layer alone, of all
  std::vector<Task> tasks;
  detail::CutList list;

  std::int32_t wallWinding(std::int32_t i, std::int32_t j) const {
    return (walls.closed[0] && i <= lines[0].cell ? 1 : 0) + (walls.closed[1] && i > lines[1].cell ? 1 : 0) +
           (walls.closed[2] && j <= lines[2].cell ? 1 : 0) + (walls.closed[3] && j > lines[3].cell ? 1 : 0);
  }
  std::int32_t fixedWinding(std::int32_t i, std::int32_t j) const {
    return wallWinding(i, j) + fixed.pieces.windingAt(i, j);
  }
  void placeWalls();
  void cover(const std::array<std::int32_t, 4>& range);
  void addWallPieces();
  void cutFixed();
  void findTasks();
  void cutMoving();
  void build();
};

CutCells::CutCells() : data_(std::make_unique<Data>()) {}
CutCells::~CutCells() = default;
CutCells::CutCells(CutCells&&) noexcept = default;
CutCells& CutCells::operator=(CutCells&&) noexcept = default;

void CutCells::setFixed(const CutGrid& grid, std::span<const CutOutline> outlines, const CutWalls& walls) {
  Data& d = *data_;
  d.grid = grid;
  d.walls = walls;
  d.placeWalls();
  d.owners.assign(kWalls, detail::CutOwner{-1, grid.origin});
  d.fixed.pieces.clear();
  for (const CutOutline& outline : outlines) {
    d.fixed.pieces.add(grid, outline, static_cast<std::uint32_t>(d.owners.size()));
    d.owners.push_back({outline.body, outline.center});
  }
  d.fixedOwners = d.owners.size();
  d.fixed.pieces.sumCrossings();
  d.outlinePieces = d.fixed.pieces.pieces().size();
  d.covered = {0, 0, -1, -1};
  d.moving.pieces.clear();
  d.cutFixed();
  d.sources = d.fixedCells;
  d.build();
}

void CutCells::update(const std::array<std::int32_t, 4>& range, std::span<const CutOutline> moving) {
  Data& d = *data_;
  const auto& c = d.covered;
  const bool anyWall = std::find(d.walls.closed.begin(), d.walls.closed.end(), true) != d.walls.closed.end();
  const bool grow = anyWall && (range[0] < c[0] || range[1] < c[1] || range[2] > c[2] || range[3] > c[3]);
  if (grow) {
    d.cover(range);
    d.cutFixed();
  }
  const bool were = !d.moving.pieces.pieces().empty();
  d.moving.pieces.clear();
  d.owners.resize(d.fixedOwners);
  for (const CutOutline& outline : moving) {
    d.moving.pieces.add(d.grid, outline, static_cast<std::uint32_t>(d.owners.size()));
    d.owners.push_back({outline.body, outline.center});
  }
  const bool are = !d.moving.pieces.pieces().empty();
  if (!(grow || were || are)) return;
  if (are)
    d.cutMoving();
  else
    d.sources = d.fixedCells;
  d.build();
}

std::uint64_t CutCells::version() const { return data_->version; }
std::span<const CutCell> CutCells::cells() const { return data_->list.cells; }
std::span<const CutPart> CutCells::parts() const { return data_->list.parts; }
std::span<const CutJoint> CutCells::joints() const { return data_->list.joints; }
std::span<const CutWall> CutCells::walls() const { return data_->list.walls; }
std::span<const CutEdge> CutCells::edges() const { return data_->list.edges; }

std::size_t CutCells::tileBegin(std::int32_t tileX, std::int32_t tileY) const {
  const std::uint64_t key = detail::cutKey(tileX * 16, tileY * 16);
  const auto& all = data_->sources;
  return static_cast<std::size_t>(
      std::lower_bound(all.begin(), all.end(), key,
                       [](const detail::CutSource& s, std::uint64_t k) { return s.key < k; }) -
      all.begin());
}

std::int32_t CutCells::find(std::int32_t i, std::int32_t j) const { return data_->list.find(i, j); }

bool CutCells::solid(std::int32_t i, std::int32_t j) const {
  return data_->fixedWinding(i, j) + data_->moving.pieces.windingAt(i, j) > 0;
}

std::uint32_t CutCells::partAt(std::uint32_t cell, const Vec2& x) const {
  const Data& d = *data_;
  const CutCell& c = d.list.cells[cell];
  FROUDE_ASSERT(c.partCount > 0);
  if (c.partCount == 1) return c.part;
  Vec2 local = (x - d.grid.origin) / d.grid.size - Vec2(c.i, c.j);
  if (d.grid.periodX > 0) local.x() -= d.grid.periodX * std::nearbyint((local.x() - 0.5) / d.grid.periodX);
  if (d.grid.periodY > 0) local.y() -= d.grid.periodY * std::nearbyint((local.y() - 0.5) / d.grid.periodY);
  const detail::CutSource& source = d.sources[cell];
  const detail::CutRecord& record = source.get();
  double nearest = kInfinity;
  std::uint32_t part = 0;
  for (std::uint32_t s = record.slab; s < record.slab + record.slabCount; ++s) {
    const detail::CutSlab& slab = source.store->slabs[s];
    if (slab.part >= c.partCount) continue;
    const double y = std::clamp(local.y(), slab.y0, slab.y1);
    const double share = (y - slab.y0) / (slab.y1 - slab.y0);
    const double left = slab.left0 + share * (slab.left1 - slab.left0);
    const double right = slab.right0 + share * (slab.right1 - slab.right0);
    const double dx = local.x() - std::clamp(local.x(), left, std::max(left, right)), dy = local.y() - y;
    const double squared = dx * dx + dy * dy;
    if (squared < nearest) {
      nearest = squared;
      part = slab.part;
    }
  }
  return c.part + part;
}

std::size_t CutCells::memoryBytes() const {
  const Data& d = *data_;
  return sizeof d + d.fixed.memoryBytes() + d.moving.memoryBytes() + d.list.memoryBytes() +
         (d.fixedCells.capacity() + d.sources.capacity()) * sizeof(detail::CutSource) +
         d.tasks.capacity() * sizeof(Data::Task) + d.owners.capacity() * sizeof(detail::CutOwner);
}

void CutCells::Data::placeWalls() {
  for (std::size_t side = 0; side < 4; ++side) {
    const bool sideways = side < 2, low = side % 2 == 0;
    const Vec2& corner = low ? walls.box.min : walls.box.max;
    const double x =
        detail::snapped((sideways ? corner.x() - grid.origin.x() : corner.y() - grid.origin.y()) / grid.size);
    if (!walls.closed[side]) continue;
    const double cell = low ? std::floor(x) : std::ceil(x) - 1.0;
    lines[side] = {static_cast<std::int32_t>(cell), x - cell};
  }
}

// More than is asked for, so that a fluid that spreads does not come here each step.
void CutCells::Data::cover(const std::array<std::int32_t, 4>& range) {
  std::array<std::int32_t, 4> wide = range;
  if (covered[0] <= covered[2]) {
    for (std::size_t k = 0; k < 2; ++k) {
      wide[k] = std::min(wide[k], covered[k]);
      wide[k + 2] = std::max(wide[k + 2], covered[k + 2]);
    }
  }
  for (std::size_t k = 0; k < 2; ++k) {
    const std::int32_t margin = std::max(16, (wide[k + 2] - wide[k]) / 2);
    wide[k] -= margin;
    wide[k + 2] += margin;
  }
  covered = wide;
}

void CutCells::Data::addWallPieces() {
  constexpr auto kLeft = static_cast<std::uint8_t>(CutSide::Left), kRight = static_cast<std::uint8_t>(CutSide::Right),
                 kBottom = static_cast<std::uint8_t>(CutSide::Bottom), kTop = static_cast<std::uint8_t>(CutSide::Top);
  fixed.pieces.truncate(outlinePieces);
  for (std::uint32_t side = 0; side < 4; ++side) {
    if (!walls.closed[side]) continue;
    const bool sideways = side < 2;  // the wall runs along y
    const std::int32_t period = sideways ? grid.periodY : grid.periodX;
    const double low = sideways ? walls.box.min.y() - grid.origin.y() : walls.box.min.x() - grid.origin.x();
    const double high = sideways ? walls.box.max.y() - grid.origin.y() : walls.box.max.x() - grid.origin.x();
    const auto first = static_cast<std::int32_t>(std::floor(low / grid.size)) - kBeyond;
    const auto last = static_cast<std::int32_t>(std::ceil(high / grid.size)) + kBeyond;
    const std::int32_t begin = period > 0 ? 0 : std::max(first, covered[sideways ? 1 : 0]);
    const std::int32_t end = period > 0 ? period - 1 : std::min(last, covered[sideways ? 3 : 2]);
    const std::int32_t cell = lines[side].cell;
    if (cell < covered[sideways ? 0 : 1] || cell > covered[sideways ? 2 : 3]) continue;
    const double at = lines[side].at;
    for (std::int32_t k = begin; k <= end; ++k) {
      CutPiece piece;
      piece.outline = side;
      piece.key = sideways ? detail::cutKey(cell, k) : detail::cutKey(k, cell);
      // The solid is on the left of the way.
      const bool forwards = side == 0 || side == 3;
      const double from = forwards ? 0.0 : 1.0, to = 1.0 - from;
      piece.x0 = sideways ? at : from;
      piece.y0 = sideways ? from : at;
      piece.x1 = sideways ? at : to;
      piece.y1 = sideways ? to : at;
      const std::uint8_t lowSide = sideways ? kBottom : kLeft, highSide = sideways ? kTop : kRight;
      piece.from = forwards ? lowSide : highSide;
      piece.to = forwards ? highSide : lowSide;
      fixed.pieces.add(piece);
    }
  }
}

void CutCells::Data::cutFixed() {
  addWallPieces();
  fixed.sort();
  const std::size_t count = fixed.cellCount();
  fixed.prepareStores(blockCount(count, kCellsPerTask));
  fixedCells.resize(count);
  parallelFor(count, kCellsPerTask, [&](std::size_t begin, std::size_t end) {
    detail::CutStore& store = fixed.store(begin / kCellsPerTask);
    for (std::size_t c = begin; c < end; ++c) {
      const std::uint64_t key = fixed.keyOf(c);
      store.cutter.cut(grid, fixed.piecesOf(c), fixedWinding(detail::cutColumn(key), detail::cutRow(key)), owners);
      fixedCells[c] = {key, &store, store.keep()};
    }
  });
}

// All cells of both layers; those that moving outlines touch or cover are to be cut anew.
void CutCells::Data::findTasks() {
  tasks.clear();
  sources.clear();
  const std::size_t nf = fixed.cellCount(), nm = moving.cellCount();
  for (std::size_t f = 0, m = 0; f < nf || m < nm;) {
    const std::uint64_t key =
        m == nm || (f < nf && fixed.keyOf(f) < moving.keyOf(m)) ? fixed.keyOf(f) : moving.keyOf(m);
    const bool isFixed = f < nf && fixed.keyOf(f) == key, isMoving = m < nm && moving.keyOf(m) == key;
    const std::int32_t i = detail::cutColumn(key), j = detail::cutRow(key);
    const std::int32_t winding = moving.pieces.windingAt(i, j);
    if (isMoving) {
      tasks.push_back({sources.size(), isFixed ? static_cast<std::ptrdiff_t>(f) : -1, static_cast<std::ptrdiff_t>(m),
                       winding + fixedWinding(i, j)});
    }
    if (isMoving || winding > 0)
      sources.push_back({key, nullptr, 0});
    else
      sources.push_back(fixedCells[f]);
    f += isFixed ? 1 : 0;
    m += isMoving ? 1 : 0;
  }
}

void CutCells::Data::cutMoving() {
  moving.pieces.sumCrossings();
  moving.sort();
  findTasks();
  moving.prepareStores(blockCount(tasks.size(), kCellsPerTask));
  parallelFor(tasks.size(), kCellsPerTask, [&](std::size_t begin, std::size_t end) {
    detail::CutStore& store = moving.store(begin / kCellsPerTask);
    for (std::size_t t = begin; t < end; ++t) {
      const Task& task = tasks[t];
      std::span<const CutPiece> pieces = moving.piecesOf(static_cast<std::size_t>(task.moving));
      if (task.fixed >= 0) {
        const std::span<const CutPiece> others = fixed.piecesOf(static_cast<std::size_t>(task.fixed));
        store.gathered.assign(others.begin(), others.end());
        store.gathered.insert(store.gathered.end(), pieces.begin(), pieces.end());
        pieces = store.gathered;
      }
      store.cutter.cut(grid, pieces, task.winding, owners);
      sources[task.source].store = &store;
      sources[task.source].record = store.keep();
    }
  });
}

void CutCells::Data::build() {
  list.build(grid, sources);
  ++version;
}

}  // namespace froude
