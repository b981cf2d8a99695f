#include <froude/fields/cell_cutter.h>

#include <functional>

namespace froude::detail {
namespace {

/// Narrower than this, what lies between two edges is rounding and not a gap, and two slabs touch in a point [cells].
constexpr double kSlit = 1e-10;

/// What encloses less than this and opens to nothing is rounding too [cells].
constexpr double kPocket = 1e-12;

constexpr std::uint32_t kDropped = 0xffffffffu;

}  // namespace

void CellCutter::cut(const CutGrid& grid, std::span<const CutPiece> pieces, std::int32_t winding,
                     std::span<const CutOwner> owners) {
  sortPieces(pieces);
  addLevels(pieces);
  slabs_.clear();
  parent_.clear();
  flatWalls_.clear();
  ends_.clear();

  outsideSpans(bottom_, winding);
  below_ = outside_;
  std::int32_t atLeft = winding;
  std::size_t passed = 0;
  for (std::size_t k = 0; k + 1 < levels_.size(); ++k) {
    for (; passed < left_.size() && left_[passed].at <= levels_[k]; ++passed) atLeft += left_[passed].rise;
    const std::size_t first = slabs_.size();
    fillSlab(levels_[k], levels_[k + 1], atLeft);
    above_.clear();
    for (std::size_t s = first; s < slabs_.size(); ++s) {
      above_.push_back({slabs_[s].left0, slabs_[s].right0, static_cast<std::int32_t>(s)});
    }
    joinAt(levels_[k], below_, above_);
    below_.clear();
    for (std::size_t s = first; s < slabs_.size(); ++s) {
      below_.push_back({slabs_[s].left1, slabs_[s].right1, static_cast<std::int32_t>(s)});
    }
  }
  for (; passed < left_.size(); ++passed) atLeft += left_[passed].rise;
  outsideSpans(top_, atLeft);
  joinAt(1.0, below_, outside_);

  numberParts();
  addSideOpenings();
  addWalls(grid, pieces, owners);
}

// Steep edges and level ones, and where outlines pass the left, bottom and top side.
void CellCutter::sortPieces(std::span<const CutPiece> pieces) {
  constexpr auto kLeft = static_cast<std::uint8_t>(CutSide::Left), kBottom = static_cast<std::uint8_t>(CutSide::Bottom),
                 kTop = static_cast<std::uint8_t>(CutSide::Top);
  edges_.clear();
  flats_.clear();
  left_.clear();
  bottom_.clear();
  top_.clear();
  for (std::uint32_t p = 0; p < pieces.size(); ++p) {
    const CutPiece& c = pieces[p];
    if (c.y0 < c.y1) edges_.push_back({c.x0, c.y0, c.x1, c.y1, -1, p});
    if (c.y0 > c.y1) edges_.push_back({c.x1, c.y1, c.x0, c.y0, 1, p});
    if (c.y0 == c.y1 && c.x0 != c.x1) {
      flats_.push_back({c.y0, std::min(c.x0, c.x1), std::max(c.x0, c.x1), c.x0 < c.x1, p});
    }
    if (c.from == kLeft) left_.push_back({c.y0, 1});
    if (c.to == kLeft) left_.push_back({c.y1, -1});
    if (c.from == kBottom) bottom_.push_back({c.x0, -1});
    if (c.to == kBottom) bottom_.push_back({c.x1, 1});
    if (c.from == kTop) top_.push_back({c.x0, 1});
    if (c.to == kTop) top_.push_back({c.x1, -1});
  }
  std::sort(left_.begin(), left_.end(), [](const Crossing& a, const Crossing& b) { return a.at < b.at; });
}

void CellCutter::addLevels(std::span<const CutPiece> pieces) {
  levels_.assign({0.0, 1.0});
  for (const Edge& e : edges_) {
    levels_.push_back(e.y0);
    levels_.push_back(e.y1);
  }
  for (const Flat& f : flats_) levels_.push_back(f.y);
  for (const Crossing& c : left_) levels_.push_back(c.at);
  for (std::size_t a = 0; a < edges_.size(); ++a) {
    for (std::size_t b = a + 1; b < edges_.size(); ++b) {
      const Edge &p = edges_[a], &q = edges_[b];
      if (pieces[p.piece].outline == pieces[q.piece].outline) continue;  // simple: no crossings
      const double low = std::max(p.y0, q.y0), high = std::min(p.y1, q.y1);
      if (!(low < high)) continue;
      const double atLow = p.at(low) - q.at(low), atHigh = p.at(high) - q.at(high);
      if (atLow * atHigh < 0.0) levels_.push_back(low + (high - low) * (atLow / (atLow - atHigh)));
    }
  }
  std::sort(levels_.begin(), levels_.end());
  levels_.erase(std::unique(levels_.begin(), levels_.end()), levels_.end());
}

void CellCutter::fillSlab(double y0, double y1, std::int32_t winding) {
  active_.clear();
  for (std::uint32_t e = 0; e < edges_.size(); ++e) {
    if (edges_[e].y0 <= y0 && edges_[e].y1 >= y1) active_.push_back({edges_[e].at(y0), edges_[e].at(y1), e});
  }
  // Where two edges coincide the solid comes first: no slit is between bodies that touch.
  std::sort(active_.begin(), active_.end(), [&](const Active& a, const Active& b) {
    const double p = a.low + a.high, q = b.low + b.high;
    if (p != q) return p < q;
    const std::int32_t riseA = edges_[a.edge].rise, riseB = edges_[b.edge].rise;
    return riseA != riseB ? riseA > riseB : a.edge < b.edge;
  });
  CutSlab slab;
  slab.y0 = y0;
  slab.y1 = y1;
  slab.left0 = slab.left1 = 0.0;
  slab.leftEdge = -1;
  auto close = [&](double right0, double right1, std::int32_t edge) {
    slab.right0 = std::max(right0, slab.left0);
    slab.right1 = std::max(right1, slab.left1);
    slab.rightEdge = edge;
    const bool slit = slab.right0 - slab.left0 <= kSlit && slab.right1 - slab.left1 <= kSlit;
    if (slit && slab.leftEdge >= 0 && edge >= 0) return;
    parent_.push_back(static_cast<std::uint32_t>(slabs_.size()));
    slabs_.push_back(slab);
  };
  for (const Active& a : active_) {
    const std::int32_t before = winding;
    winding += edges_[a.edge].rise;
    if (before <= 0 && winding > 0) close(a.low, a.high, static_cast<std::int32_t>(a.edge));
    if (before > 0 && winding <= 0) {
      slab.left0 = a.low;
      slab.left1 = a.high;
      slab.leftEdge = static_cast<std::int32_t>(a.edge);
    }
  }
  if (winding <= 0) close(1.0, 1.0, -1);
}

// What is open just below the bottom, or just above the top, where the outlines cross it.
void CellCutter::outsideSpans(std::vector<Crossing>& crossings, std::int32_t winding) {
  std::sort(crossings.begin(), crossings.end(),
            [](const Crossing& a, const Crossing& b) { return a.at != b.at ? a.at < b.at : a.rise > b.rise; });
  outside_.clear();
  double from = 0.0;
  for (const Crossing& c : crossings) {
    const std::int32_t before = winding;
    winding += c.rise;
    if (before <= 0 && winding > 0 && c.at > from) outside_.push_back({from, c.at, -1});
    if (before > 0 && winding <= 0) from = c.at;
  }
  if (winding <= 0 && from < 1.0) outside_.push_back({from, 1.0, -1});
}

void CellCutter::joinAt(double y, const std::vector<Span>& below, const std::vector<Span>& above) {
  for (std::size_t a = 0, b = 0; a < below.size() && b < above.size();) {
    const double low = std::max(below[a].low, above[b].low), high = std::min(below[a].high, above[b].high);
    if (below[a].slab >= 0 && above[b].slab >= 0) {
      if (high - low > kSlit) {
        const std::uint32_t p = root(static_cast<std::uint32_t>(below[a].slab));
        const std::uint32_t q = root(static_cast<std::uint32_t>(above[b].slab));
        parent_[std::max(p, q)] = std::min(p, q);
      }
    } else if (high > low) {
      const bool bottom = below[a].slab < 0;
      ends_.push_back({bottom ? CutSide::Bottom : CutSide::Top,
                       static_cast<std::uint32_t>(bottom ? above[b].slab : below[a].slab), low, high});
    }
    if (below[a].high < above[b].high)
      ++a;
    else
      ++b;
  }
  if (flats_.empty()) return;
  addFlatWalls(y, below, above, true);
  addFlatWalls(y, above, below, false);
}

// Of what is open on one side of the level, the stretches that are solid on the other.
void CellCutter::addFlatWalls(double y, const std::vector<Span>& open, const std::vector<Span>& opposite,
                              bool solidAbove) {
  for (const Span& span : open) {
    if (span.slab < 0) continue;
    double from = span.low;
    for (const Span& other : opposite) {
      if (other.high <= from || other.low >= span.high) continue;
      if (other.low > from) wallOnFlats(y, from, other.low, solidAbove, static_cast<std::uint32_t>(span.slab));
      from = std::max(from, other.high);
    }
    if (from < span.high) wallOnFlats(y, from, span.high, solidAbove, static_cast<std::uint32_t>(span.slab));
  }
}

// Whose the wall is: where several level edges coincide, the first one's.
void CellCutter::wallOnFlats(double y, double low, double high, bool solidAbove, std::uint32_t slab) {
  while (low < high) {
    const Flat* covers = nullptr;
    double next = high;
    for (const Flat& f : flats_) {
      if (f.y != y || f.solidAbove != solidAbove || f.high <= low || f.low >= high) continue;
      if (f.low <= low) {
        covers = &f;
        break;
      }
      next = std::min(next, f.low);
    }
    const double end = covers != nullptr ? std::min(high, covers->high) : next;
    if (covers != nullptr) flatWalls_.push_back({y, low, end, solidAbove, slab, covers->piece});
    low = end;
  }
}

std::uint32_t CellCutter::root(std::uint32_t slab) {
  while (parent_[slab] != slab) slab = parent_[slab] = parent_[parent_[slab]];
  return slab;
}

// Parts by size. What has neither area nor an opening is rounding, and is left out.
void CellCutter::numberParts() {
  found_.clear();
  for (std::uint32_t s = 0; s < slabs_.size(); ++s) {
    CutSlab& slab = slabs_[s];
    const std::uint32_t r = root(s);  // never behind s: what is found of it is there already
    if (r == s) {
      slab.part = static_cast<std::uint32_t>(found_.size());
      found_.push_back({0.0, 0.0, 0});
    } else {
      slab.part = slabs_[r].part;
    }
    Found& found = found_[slab.part];
    const double height = slab.y1 - slab.y0;
    found.area += 0.5 * height * ((slab.right0 - slab.left0) + (slab.right1 - slab.left1));
    found.open += (slab.leftEdge < 0 ? height : 0.0) + (slab.rightEdge < 0 ? height : 0.0);
  }
  for (const CutOpening& end : ends_) found_[slabs_[end.part].part].open += end.to - end.from;
  areas_.clear();
  for (std::uint32_t p = 0; p < found_.size(); ++p) {
    Found& found = found_[p];
    found.number = kDropped;
    if (found.area < kPocket && found.open <= kSlit) continue;
    found.number = 0;
    for (std::uint32_t q = 0; q < p; ++q) {
      if (found_[q].number == kDropped) continue;
      ++(found_[q].area >= found.area ? found : found_[q]).number;
    }
    areas_.push_back(found.area);
  }
  std::sort(areas_.begin(), areas_.end(), std::greater<>());
  for (CutSlab& slab : slabs_) slab.part = found_[slab.part].number;
}

void CellCutter::addSideOpenings() {
  openings_.clear();
  auto add = [&](CutSide side, std::uint32_t part, double from, double to) {
    if (part >= areas_.size()) return;
    if (!openings_.empty()) {
      CutOpening& last = openings_.back();
      if (last.side == side && last.part == part && last.to == from) {
        last.to = to;
        return;
      }
    }
    openings_.push_back({side, part, from, to});
  };
  for (const CutSlab& s : slabs_) {
    if (s.leftEdge < 0) add(CutSide::Left, s.part, s.y0, s.y1);
  }
  for (const CutSlab& s : slabs_) {
    if (s.rightEdge < 0) add(CutSide::Right, s.part, s.y0, s.y1);
  }
  for (const CutOpening& o : ends_) add(o.side, slabs_[o.part].part, o.from, o.to);
}

void CellCutter::addWalls(const CutGrid& grid, std::span<const CutPiece> pieces, std::span<const CutOwner> owners) {
  walls_.clear();
  auto add = [&](std::uint32_t part, std::uint32_t piece, const Vec2& middle, const Vec2& normal) {
    if (part >= areas_.size()) return;
    const CutPiece& c = pieces[piece];
    const CutOwner& owner = owners[c.outline];
    const Vec2 cell(cutColumn(c.key) + c.wrapX * grid.periodX, cutRow(c.key) + c.wrapY * grid.periodY);
    const Vec2 arm = grid.origin + grid.size * (cell + middle) - owner.center;
    auto at = std::find_if(walls_.begin(), walls_.end(), [&](const CutPartWall& w) {
      return w.part > part || (w.part == part && w.wall.body >= owner.body);
    });
    if (at == walls_.end() || at->part != part || at->wall.body != owner.body) {
      at = walls_.insert(at, CutPartWall{});
      at->part = part;
      at->wall.body = owner.body;
    }
    at->wall.normal += normal;
    at->wall.moment += cross(arm, normal);
    const double length = normal.norm();
    at->wall.length += length;
    at->wall.middle += length * middle;
    at->wall.spread += (middle - Vec2(0.5, 0.5)) * normal.transpose();
  };
  for (const CutSlab& s : slabs_) {
    if (s.leftEdge >= 0) {
      add(s.part, edges_[static_cast<std::size_t>(s.leftEdge)].piece, 0.5 * Vec2(s.left0 + s.left1, s.y0 + s.y1),
          {s.y1 - s.y0, s.left0 - s.left1});
    }
    if (s.rightEdge >= 0) {
      add(s.part, edges_[static_cast<std::size_t>(s.rightEdge)].piece, 0.5 * Vec2(s.right0 + s.right1, s.y0 + s.y1),
          {s.y0 - s.y1, s.right1 - s.right0});
    }
  }
  for (const FlatWall& f : flatWalls_) {
    add(slabs_[f.slab].part, f.piece, {0.5 * (f.low + f.high), f.y},
        {0.0, f.solidAbove ? f.low - f.high : f.high - f.low});
  }
  for (CutPartWall& w : walls_) {
    if (w.wall.length > 0.0) w.wall.middle /= w.wall.length;
  }
}

}  // namespace froude::detail
