#include <froude/fields/cut_list.h>

namespace froude::detail {
namespace {

constexpr std::array<CutSide, 4> kSides{CutSide::Left, CutSide::Right, CutSide::Bottom, CutSide::Top};

CutSide opposite(CutSide side) { return static_cast<CutSide>(static_cast<std::uint8_t>(side) ^ 1u); }

std::int32_t wrapped(std::int32_t i, std::int32_t period) {
  if (period <= 0) return i;
  return i < 0 ? i + period : i >= period ? i - period : i;
}

std::span<const CutOpening> openingsOf(const CutSource& source, CutSide side) {
  const CutRecord& record = source.get();
  const CutOpening* begin = source.store->openings.data() + record.opening;
  const CutOpening* const end = begin + record.openingCount;
  while (begin != end && begin->side != side) ++begin;
  const CutOpening* last = begin;
  while (last != end && last->side == side) ++last;
  return {begin, last};
}

}  // namespace

void CutList::build(const CutGrid& grid, std::span<const CutSource> sources) {
  grid_ = grid;
  cells.clear();
  parts.clear();
  joints.clear();
  walls.clear();
  edges.clear();
  for (const CutSource& source : sources) addCell(source);
  indexTiles();
  std::size_t tile = 0;
  for (std::uint32_t c = 0; c < cells.size(); ++c) {
    while (tiles_[tile].key != cutTile(sources[c].key)) ++tile;
    if (cells[c].partCount > 0) joinCell(c, tile, sources);
  }
  nameEdges();
}

void CutList::addCell(const CutSource& source) {
  CutCell cell;
  cell.i = cutColumn(source.key);
  cell.j = cutRow(source.key);
  cell.part = static_cast<std::uint32_t>(parts.size());
  if (source.store != nullptr) {
    const CutRecord& record = source.get();
    cell.partCount = record.areaCount;
    std::uint32_t w = record.wall;
    for (std::uint32_t p = 0; p < record.areaCount; ++p) {
      CutPart part;
      part.area = source.store->areas[record.area + p];
      part.cell = static_cast<std::uint32_t>(cells.size());
      part.wall = static_cast<std::uint32_t>(walls.size());
      for (; w < record.wall + record.wallCount && source.store->walls[w].part == p; ++w) {
        walls.push_back(source.store->walls[w].wall);
      }
      part.wallCount = static_cast<std::uint32_t>(walls.size()) - part.wall;
      parts.push_back(part);
    }
  }
  cells.push_back(cell);
}

void CutList::indexTiles() {
  std::size_t count = 0;
  for (std::size_t c = 0; c < cells.size(); ++c) {
    const std::uint64_t key = cutKey(cells[c].i, cells[c].j);
    if (count == 0 || tiles_[count - 1].key != cutTile(key)) {
      if (count == tiles_.size()) tiles_.emplace_back();
      tiles_[count].key = cutTile(key);
      tiles_[count].cell.fill(-1);
      ++count;
    }
    tiles_[count - 1].cell[key & 255u] = static_cast<std::int32_t>(c);
  }
  tiles_.resize(count);
}

std::int32_t CutList::tileOf(std::uint64_t key) const {
  const auto at = std::lower_bound(tiles_.begin(), tiles_.end(), cutTile(key),
                                   [](const Tile& tile, std::uint64_t k) { return tile.key < k; });
  if (at == tiles_.end() || at->key != cutTile(key)) return -1;
  return static_cast<std::int32_t>(at - tiles_.begin());
}

std::int32_t CutList::find(std::int32_t i, std::int32_t j) const {
  const std::uint64_t key = cutKey(i, j);
  const std::int32_t tile = tileOf(key);
  return tile < 0 ? -1 : tiles_[static_cast<std::size_t>(tile)].cell[key & 255u];
}

void CutList::joinCell(std::uint32_t c, std::size_t tile, std::span<const CutSource> sources) {
  CutCell& cell = cells[c];
  pairs_.clear();
  std::array<std::int32_t, 4> beyond{};
  for (CutSide side : kSides) {
    const std::int32_t dx = side == CutSide::Left ? -1 : side == CutSide::Right ? 1 : 0;
    const std::int32_t dy = side == CutSide::Bottom ? -1 : side == CutSide::Top ? 1 : 0;
    const std::int32_t i = wrapped(cell.i + dx, grid_.periodX), j = wrapped(cell.j + dy, grid_.periodY);
    const auto s = static_cast<std::size_t>(side);
    const std::uint64_t key = cutKey(i, j);
    beyond[s] = cutTile(key) == tiles_[tile].key ? tiles_[tile].cell[key & 255u] : find(i, j);
    pairSide(c, side, beyond[s], sources);
  }
  for (std::uint32_t p = 0; p < cell.partCount; ++p) {
    CutPart& part = parts[cell.part + p];
    part.joint = static_cast<std::uint32_t>(joints.size());
    for (const Pair& pair : pairs_) {
      if (pair.own == p) joints.push_back({pair.side, pair.other, -1, pair.length});
    }
    part.jointCount = static_cast<std::uint32_t>(joints.size()) - part.joint;
  }
  for (const Pair& pair : pairs_) {
    const auto s = static_cast<std::size_t>(pair.side);
    const bool listed = beyond[s] >= 0;
    const bool mainBeyond =
        !listed || static_cast<std::uint32_t>(pair.other) == cells[static_cast<std::size_t>(beyond[s])].part;
    if (pair.own == 0 && mainBeyond)
      cell.open[s] = pair.length;
    else
      addEdge(cell, pair, listed);
  }
}

// Openings of two cells on both sides of their common side, each in order; where both are open, they join.
void CutList::pairSide(std::uint32_t c, CutSide side, std::int32_t beyond, std::span<const CutSource> sources) {
  const std::span<const CutOpening> own = openingsOf(sources[c], side);
  if (beyond < 0) {
    for (const CutOpening& o : own) addPair({side, o.part, -1, o.to - o.from});
    return;
  }
  const auto b = static_cast<std::size_t>(beyond);
  if (cells[b].partCount == 0) return;
  const std::span<const CutOpening> other = openingsOf(sources[b], opposite(side));
  for (std::size_t p = 0, q = 0; p < own.size() && q < other.size();) {
    const double length = std::min(own[p].to, other[q].to) - std::max(own[p].from, other[q].from);
    if (length > 0.0) addPair({side, own[p].part, static_cast<std::int32_t>(cells[b].part + other[q].part), length});
    if (own[p].to < other[q].to)
      ++p;
    else
      ++q;
  }
}

void CutList::addPair(const Pair& pair) {
  for (Pair& known : pairs_) {
    if (known.side == pair.side && known.own == pair.own && known.other == pair.other) {
      known.length += pair.length;
      return;
    }
  }
  pairs_.push_back(pair);
}

// Each once: from the cell that owns the face, or from the other where the owner is not listed.
void CutList::addEdge(const CutCell& cell, const Pair& pair, bool listedBeyond) {
  const bool vertical = pair.side == CutSide::Left || pair.side == CutSide::Right;
  const auto own = static_cast<std::int32_t>(cell.part + pair.own);
  if (pair.side == CutSide::Left || pair.side == CutSide::Bottom) {
    edges.push_back({cell.i, cell.j, vertical, pair.other, own, pair.length});
  } else if (!listedBeyond) {
    const std::int32_t i = vertical ? wrapped(cell.i + 1, grid_.periodX) : cell.i;
    const std::int32_t j = vertical ? cell.j : wrapped(cell.j + 1, grid_.periodY);
    edges.push_back({i, j, vertical, own, -1, pair.length});
  }
}

// Joints learn which edge they are, on both sides of it.
void CutList::nameEdges() {
  for (std::size_t e = 0; e < edges.size(); ++e) {
    const CutEdge& edge = edges[e];
    auto name = [&](std::int32_t own, std::int32_t other, CutSide side) {
      if (own < 0) return;
      const CutPart& part = parts[static_cast<std::size_t>(own)];
      for (std::uint32_t k = part.joint; k < part.joint + part.jointCount; ++k) {
        if (joints[k].side == side && joints[k].part == other) joints[k].edge = static_cast<std::int32_t>(e);
      }
    };
    name(edge.a, edge.b, edge.vertical ? CutSide::Right : CutSide::Top);
    name(edge.b, edge.a, edge.vertical ? CutSide::Left : CutSide::Bottom);
  }
}

std::size_t CutList::memoryBytes() const {
  return cells.capacity() * sizeof(CutCell) + parts.capacity() * sizeof(CutPart) +
         joints.capacity() * sizeof(CutJoint) + walls.capacity() * sizeof(CutWall) +
         edges.capacity() * sizeof(CutEdge) + tiles_.capacity() * sizeof(Tile);
}

}  // namespace froude::detail
