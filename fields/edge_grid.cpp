#include <froude/fields/edge_grid.h>

#include <froude/base/assert.h>
#include <froude/fields/edge_grid_nearest.h>
#include <froude/fields/predicates.h>

namespace froude::detail {

namespace {

/// Feeds edges, grouped by source, to a Nearest.
template <typename Nearest, typename Accept>
void visitBySource(Nearest& nearest, std::span<const GridEdge> edges, std::span<const std::uint32_t> list,
                   const Accept& accept) {
  std::size_t i = 0;
  while (i < list.size()) {
    const std::uint32_t source = edges[list[i]].source;
    const bool wanted = accept(source);
    for (; i < list.size() && edges[list[i]].source == source; ++i) {
      if (wanted) nearest.consider(list[i]);
    }
    if (wanted) nearest.closeSource(source);
  }
}

}  // namespace

FieldSample EdgeGrid::sample(const Vec2& p) const {
  if (!inGrid(p)) return freeOutside() ? bound(p, lowerBound(p)) : sampleExact(p);
  const std::span<const std::uint32_t> candidates = nearestAt(p);
  if (candidates.empty()) return bound(p, clearance_[cellOf(p)]);
  Nearest closest{*this, p};
  visitBySource(closest, edges_, candidates, [](std::uint32_t) { return true; });
  FROUDE_ASSERT(closest.any);
  // Beyond its reach a cell knows of one outline but not of others.
  const double reach = kBandMargin * band_;
  if (!oneOutline() && std::abs(closest.best) > reach * reach) return bound(p, std::copysign(reach, closest.best));
  return makeSample(p, closest.bestEdge, closest.best < 0.0);
}

double EdgeGrid::distance(const Vec2& p, bool* exact) const {
  *exact = false;
  if (!inGrid(p)) return lowerBound(p);
  const std::span<const std::uint32_t> candidates = nearestAt(p);
  if (candidates.empty()) return clearance_[cellOf(p)];
  *exact = true;
  double inside = kInfinity;
  double outside = kInfinity;
  if (oneOutline()) {
    // As Nearest, but without a branch that depends on the point.
    for (const std::uint32_t index : candidates) {
      const GridEdge& e = edges_[index];
      const Vec2 arm = p - e.a;
      const double along = e.direction.dot(arm);
      const double left = cross(e.direction, arm);
      const bool vertex = along < 0.0;
      const double square = along > e.length ? kInfinity : (vertex ? arm.squaredNorm() : left * left);
      const bool within = vertex ? e.convexStart == 0 : left > 0.0;
      inside = std::min(inside, within ? square : kInfinity);
      outside = std::min(outside, within ? kInfinity : square);
    }
  }
  const double nearer = std::min(inside, outside);
  const double gap = inside - outside;
  const double rounding = rounding_ * rounding_;
  if (!(gap * gap > 4.0 * rounding * std::max(nearer, rounding)) || !(nearer > rounding) || nearer == kInfinity) {
    const FieldSample s = sample(p);
    *exact = s.exact;
    return s.distance;
  }
  return std::copysign(std::sqrt(nearer), gap);
}

FieldSample EdgeGrid::sampleExact(const Vec2& p) const {
  if (inGrid(p)) {
    const FieldSample near = sample(p);
    if (near.exact) return near;
    // Inside several outlines the deepest one counts, which need not be the nearest.
    if (sealed_ && (oneOutline() || near.distance > 0.0)) return searchRings(p, near.distance);
  }
  Nearest closest{*this, p};
  for (std::uint32_t source = 0; source + 1 < sourceStarts_.size(); ++source) {
    for (std::uint32_t i = sourceStarts_[source]; i < sourceStarts_[source + 1]; ++i) closest.consider(i);
    closest.closeSource(source);
  }
  if (!closest.any) return bound(p, kInfinity);
  return makeSample(p, closest.bestEdge, closest.best < 0.0);
}

FieldSample EdgeGrid::sampleAccepted(const Vec2& p, FunctionRef<bool(std::uint32_t)> accepts) const {
  Nearest closest{*this, p};
  const bool deep = !inGrid(p) || sample(p).distance < -band_;
  if (deep) {
    // An accepted outline may hold p deeper than the band, where no list knows it.
    for (std::uint32_t source = 0; source + 1 < sourceStarts_.size(); ++source) {
      if (!accepts(source)) continue;
      for (std::uint32_t i = sourceStarts_[source]; i < sourceStarts_[source + 1]; ++i) closest.consider(i);
      closest.closeSource(source);
    }
  } else {
    closest.limit = (kBandMargin * band_) * (kBandMargin * band_);
    visitBySource(closest, edges_, within(p), accepts);
  }
  if (!closest.any) return bound(p, deep ? kInfinity : std::max(band_, lowerBound(p)));
  return makeSample(p, closest.bestEdge, closest.best < 0.0);
}

double EdgeGrid::lowerBound(const Vec2& p) const {
  if (inGrid(p)) return clearance_[cellOf(p)];
  if (!freeOutside()) return sampleExact(p).distance;
  const Vec2 out = (outlines_.min - p).cwiseMax(p - outlines_.max).cwiseMax(0.0);
  return out.norm() * (1.0 - 1e-15);
}

void EdgeGrid::forEachEdgeNear(const Vec2& p, double radius, FunctionRef<void(std::uint32_t)> visit) const {
  FROUDE_ASSERT(radius <= band_);
  const double reach = radius * radius;
  if (inGrid(p)) {
    for (const std::uint32_t i : within(p)) {
      if (squaredDistance(edges_[i], p) <= reach) visit(i);
    }
  } else if (!freeOutside()) {
    for (std::uint32_t i = 0; i < edges_.size(); ++i) {
      if (squaredDistance(edges_[i], p) <= reach) visit(i);
    }
  }
}

bool EdgeGrid::contains(std::uint32_t source, const Vec2& p) const {
  const std::span<const GridEdge> outline(edges_.data() + sourceStarts_[source],
                                          edges_.data() + sourceStarts_[source + 1]);
  if (walls_ && source == 0) {
    return std::any_of(outline.begin(), outline.end(),
                       [&](const GridEdge& e) { return orientation(e.a, e.b, p) >= 0; });
  }
  bool inside = false;
  for (const GridEdge& e : outline) {
    if (p == e.b) return true;
    if ((e.a.y() > p.y()) == (e.b.y() > p.y())) {
      if (e.a.y() == p.y() && e.b.y() == p.y() && onSegment(e.a, e.b, p)) return true;
      continue;
    }
    const int side = orientation(e.a, e.b, p);
    if (side == 0) return true;
    if ((side > 0) == (e.b.y() > e.a.y())) inside = !inside;
  }
  return inside;
}

std::size_t EdgeGrid::memoryBytes() const {
  return edges_.capacity() * sizeof(GridEdge) + clearance_.capacity() * sizeof(float) +
         (next_.capacity() + sourceStarts_.capacity() + codes_.capacity() + partCodes_.capacity() + lists_.capacity() +
          coarseListOf_.capacity() + coarseLists_.capacity()) *
             sizeof(std::uint32_t);
}

FieldSample EdgeGrid::bound(const Vec2& p, double clearance) const {
  FieldSample sample;
  sample.distance = clearance;
  sample.closest = p;
  return sample;
}

/// Cells in growing squares round p until no farther cell can hold a nearer edge. p is in the grid, outside every band.
FieldSample EdgeGrid::searchRings(const Vec2& p, double clearance) const {
  const int ci = column(p.x());
  const int cj = row(p.y());
  double best = kInfinity;
  std::uint32_t bestEdge = 0;
  const auto visitCell = [&](int i, int j) {
    if (i < 0 || i >= nx_ || j < 0 || j >= ny_) return;
    for (const std::uint32_t e :
         nearest(static_cast<std::size_t>(j) * static_cast<std::size_t>(nx_) + static_cast<std::size_t>(i))) {
      // A vertex is the start of its edge; the end of an edge is left to its successor, which is as near.
      if (edges_[e].direction.dot(p - edges_[e].a) > edges_[e].length) continue;
      const double square = squaredDistance(edges_[e], p);
      if (square < best) best = square, bestEdge = e;
    }
  };
  const int last = std::max(nx_, ny_);
  // A cell of ring r reaches out to (r + 1) diagonals.
  int ring =
      std::isfinite(clearance) ? std::max(0, static_cast<int>(0.7 * std::abs(clearance) * inverseCell_) - 1) : last;
  for (; ring < last && best > (ring - 1) * (ring - 1) * cell_ * cell_; ++ring) {
    for (int k = -ring; k <= ring; ++k) {
      visitCell(ci + k, cj - ring);
      visitCell(ci + k, cj + ring);
    }
    for (int k = 1 - ring; k < ring; ++k) {
      visitCell(ci - ring, cj + k);
      visitCell(ci + ring, cj + k);
    }
  }
  if (best == kInfinity) return bound(p, clearance);
  return makeSample(p, bestEdge, clearance < 0.0);
}

FieldSample EdgeGrid::makeSample(const Vec2& p, std::uint32_t index, bool inside) const {
  if (p == edges_[index].b && next_[index] >= 0) index = static_cast<std::uint32_t>(next_[index]);
  const GridEdge& e = edges_[index];
  FieldSample sample;
  sample.exact = true;
  sample.edge = static_cast<std::int32_t>(index);
  const Vec2 arm = p - e.a;
  const double sign = inside ? -1.0 : 1.0;
  if (e.direction.dot(arm) < 0.0) {
    const double distance = arm.norm();
    sample.feature = FeatureKind::StartVertex;
    sample.closest = e.a;
    sample.distance = sign * distance;
    // Closer than this even the direction is lost to underflow.
    if (distance > 1e-150) {
      sample.normal = arm * (sign / distance);
      return sample;
    }
  } else {
    double left = cross(e.direction, arm);
    if (std::abs(left) <= rounding_ && orientation(e.a, e.b, p) == 0) left = 0.0;
    sample.feature = arm == Vec2(0.0, 0.0) ? FeatureKind::StartVertex : FeatureKind::Edge;
    sample.distance = sign * std::abs(left);
    sample.normal = e.normal();
    sample.closest = p - sample.distance * sample.normal;
    if (sample.feature == FeatureKind::Edge) return sample;
  }
  const Vec2 before = e.previous >= 0 ? edges_[static_cast<std::size_t>(e.previous)].normal() : e.normal();
  const Vec2 both = before + e.normal();
  const double length = both.norm();
  sample.normal = length > 1e-6 ? Vec2(both / length) : e.normal();
  return sample;
}

}  // namespace froude::detail
