#include <froude/solver/fluid/wall_layer.h>

#include <array>

#include <froude/base/parallel.h>
#include <froude/solver/fluid/kernel.h>

namespace froude {

namespace {

constexpr float kMostFilled = 0.6f;  // a particle with more wall around it has no one wall to go along
// A particle with more wall round it than this, by walls that face each other, is a film that is not resolved (the gap
// is narrower than about 0.8 of a spacing). One row of particles can not give way to what shuts the gap.
constexpr float kFilm = 0.5f;
constexpr double kOpposed = 0.5;           // of the walls' gradients' lengths is left of their sum
constexpr double kSmallestDistance = 0.1;  // [dx] to a wall that a particle sticks to; it moves with it then
constexpr double kLongestMiter = 4.0;      // of the recession, at needles

Vec2 outwardNormal(const WallEdge& e) { return rightNormal(e.b - e.a).normalized(); }

// Moves each edge into its solid by the recession, edges that share a vertex together. Those that look away from the
// particle are dropped unless `all` are asked for. Returns how many are left.
std::size_t recede(std::span<WallEdge> edges, double recession, bool all) {
  std::array<Vec2, kMaxWallEdges> startShift, endShift;
  for (std::size_t i = 0; i < edges.size(); ++i) startShift[i] = endShift[i] = -recession * outwardNormal(edges[i]);
  for (std::size_t i = 0; i < edges.size(); ++i) {
    for (std::size_t j = 0; j < edges.size(); ++j) {
      if (i == j || edges[i].owner != edges[j].owner || edges[i].b != edges[j].a) continue;
      const Vec2 n = outwardNormal(edges[i]), m = outwardNormal(edges[j]);
      const double along = 1.0 + n.dot(m);  // the miter is (n + m)/along long
      const Vec2 shift = -recession * (n + m) / std::max(along, 2.0 / (kLongestMiter * kLongestMiter));
      endShift[i] = shift;
      startShift[j] = shift;
    }
  }
  // Which faces look at the particle is decided where they stand: a thin plate's far face would recede past the near
  // one.
  std::size_t front = 0;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    if (!all && cross(edges[i].a, edges[i].b) >= 0.0) continue;
    edges[front++] = {edges[i].a + startShift[i], edges[i].b + endShift[i], edges[i].owner};
  }
  return front;
}

}  // namespace

void WallLayer::build(const Obstacles& obstacles, const SoftWalls* soft, const CellGrid& grid,
                      std::span<const double> x, std::span<const double> y) {
  const std::size_t n = x.size();
  lambda_.resize(n);
  gradientX_.resize(n);
  gradientY_.resize(n);
  tangent_.resize(n);
  offset_.resize(n);
  used_ = blockCount(n);
  if (blocks_.size() < used_) blocks_.resize(used_);
  const double support = kernel::kSupport * spacing_;
  parallelFor(n, [&](std::size_t begin, std::size_t end) {
    Block& block = blocks_[begin / kBlockSize];
    block.links.reserve(kBlockSize / 4);  // at once, so that a splash on a wall allocates next to nothing
    block.words.reserve(kBlockSize / 4);
    block.links.clear();
    block.words.clear();
    block.films.clear();
    for (AlignedArray<float>* a : {&lambda_, &gradientX_, &gradientY_, &tangent_}) {
      std::fill(a->begin() + begin, a->begin() + end, 0.0f);
    }
    std::fill(offset_.begin() + begin, offset_.begin() + end, -1);
    auto visit = [&](std::size_t i) { integrate(obstacles, soft, grid, x, y, static_cast<std::uint32_t>(i), block); };
    if (soft == nullptr) {
      forEachWithin(
          obstacles, x, y, begin, end, [&](std::size_t) { return support; }, visit);
      return;
    }
    for (std::size_t i = begin; i < end; ++i) {
      if (soft->mayBeNear({x[i], y[i]}) || obstacles.clearance({x[i], y[i]}) <= support) visit(i);
    }
  });

  // Each block's words go behind those of the blocks before it.
  any_ = anyHidden_ = false;
  std::size_t total = 0;
  for (std::size_t b = 0; b < used_; ++b) {
    any_ = any_ || !blocks_[b].links.empty();
    total += blocks_[b].words.size();
  }
  if (total == 0) return;
  anyHidden_ = true;
  words_.resize(total);
  std::size_t base = 0;
  for (std::size_t b = 0; b < used_; ++b) {
    const AlignedArray<std::uint64_t>& words = blocks_[b].words;
    if (words.empty()) continue;
    std::copy(words.begin(), words.end(), words_.data() + base);
    for (std::size_t i = b * kBlockSize; i < std::min(n, (b + 1) * kBlockSize); ++i) {
      if (offset_[i] >= 0) offset_[i] += static_cast<std::int32_t>(base);
    }
    base += words.size();
  }
}

void WallLayer::integrate(const Obstacles& obstacles, const SoftWalls* soft, const CellGrid& grid,
                          std::span<const double> x, std::span<const double> y, std::uint32_t i, Block& block) {
  std::array<WallEdge, kMaxWallEdges> buffer;
  const double support = kernel::kSupport * spacing_;
  std::size_t n = obstacles.edgesNear({x[i], y[i]}, support, spacing_, filter_, buffer);
  if (soft != nullptr) n = soft->edgesNear({x[i], y[i]}, support, spacing_, filter_, buffer, n);
  if (n == 0) return;
  const std::span<const WallEdge> edges(buffer.data(), n);
  // Only behind a wall that ends within the support radius, on a face that looks away, can a neighbour be. Round a
  // corner of a thick solid neighbours are felt: the two sides are one fluid there, and a pair that appears when the
  // corner no longer hides it is a blow. Whether a pair is hidden depends on its own line, so that both agree.
  bool facesAway = false;
  for (const WallEdge& e : edges) facesAway = facesAway || cross(e.a, e.b) > 0.0;
  const bool thick = facesAway && !anyThin(edges);
  if (facesAway) findHidden(edges, grid, x, y, i, block);
  std::array<WallEdge, kMaxWallEdges> whole;
  const bool drag = obstacles.anySticks();
  if (drag) std::copy_n(buffer.begin(), n, whole.begin());
  const std::size_t front = recede({buffer.data(), n}, recession_, thick);
  std::array<WallShare, kMaxWallEdges> shares;
  const std::size_t owners = thick ? integrateSolids({buffer.data(), front}, shares, kernel_)
                                   : integrateWalls({buffer.data(), front}, shares, kernel_);
  double pulls = 0.0;
  bool within = false;  // a soft body, by whose contacts it is parted; its pressure would throw it
  for (std::size_t k = 0; k < owners; ++k) {
    WallShare& share = shares[k];
    // From within a soft body, which the next contact parts from it, its edges take off what lies beyond them of one.
    if (isSoftOwner(share.owner) && share.lambda < 0.0) share.lambda += 1.0;
    within = within || (isSoftOwner(share.owner) && share.lambda > 0.5);
    pulls += share.gradient.norm();
    lambda_[i] += static_cast<float>(share.lambda);
    gradientX_[i] += static_cast<float>(share.gradient.x());
    gradientY_[i] += static_cast<float>(share.gradient.y());
    WallLink link{i,
                  share.owner,
                  static_cast<float>(share.lambda),
                  static_cast<float>(share.gradient.x()),
                  static_cast<float>(share.gradient.y()),
                  0.0f,
                  0.0f,
                  0.0f};
    if (drag && !isSoftOwner(share.owner) && obstacles.sticks(share.owner)) findDrag({whole.data(), n}, link);
    block.links.push_back(link);
  }
  const bool opposed = std::hypot(gradientX_[i], gradientY_[i]) < kOpposed * pulls;
  if (within || (lambda_[i] > kFilm && opposed)) block.films.push_back(i);
  const float steepness = gradientX_[i] * gradientX_[i] + gradientY_[i] * gradientY_[i];
  if (lambda_[i] < kMostFilled && steepness > 1e-6f) tangent_[i] = lambda_[i] / ((1.0f - lambda_[i]) * steepness);
}

// Behind the wall the velocity goes on linearly, v(x') − v = (v_wall − v)·s/d with s the way along the normal and d the
// distance (Morris et al., J. Comput. Phys. 136 (1997), eq. 24). Morris' viscous term 2ν ∫ (v(x') − v)(−F) over the
// wall is then 2ν (v_wall − v) |∇λ|/d, because F·(x − x') = ∇W.
void WallLayer::findDrag(std::span<const WallEdge> edges, WallLink& link) {
  double nearest = kInfinity;
  Vec2 towards(0.0, 0.0);  // from the wall to the particle, which is the origin
  for (const WallEdge& e : edges) {
    if (e.owner != link.owner || cross(e.a, e.b) >= 0.0) continue;  // looks away
    const Vec2 along = e.b - e.a;
    const double part = std::clamp(-e.a.dot(along) / along.squaredNorm(), 0.0, 1.0);
    const Vec2 point = e.a + part * along;
    if (point.squaredNorm() >= nearest) continue;
    nearest = point.squaredNorm();
    towards = -point;
  }
  const double distance = std::sqrt(nearest);
  if (!(distance < kInfinity)) return;
  const Vec2 normal = distance > 0.0 ? Vec2(towards / distance) : Vec2(0.0, 0.0);
  link.normalX = static_cast<float>(normal.x());
  link.normalY = static_cast<float>(normal.y());
  link.drag = std::hypot(link.gradientX, link.gradientY) / static_cast<float>(std::max(distance, kSmallestDistance));
}

void WallLayer::findHidden(std::span<const WallEdge> edges, const CellGrid& grid, std::span<const double> x,
                           std::span<const double> y, std::uint32_t i, Block& block) {
  const std::size_t first = block.words.size();
  bool found = false;
  const double scale = 1.0 / spacing_;
  // The cell in which the sort put it, not one computed again: the pair loops walk the same runs.
  grid.forEachRun(grid.cells()[grid.order()[i]], [&](const CellRun& run) {
    for (std::uint32_t begin = run.begin; begin < run.end; begin += 64) {
      std::uint64_t visible = ~0ull;
      for (std::uint32_t j = begin; j < std::min(run.end, begin + 64); ++j) {
        const Vec2 p = Vec2(x[j] + run.shiftX - x[i], y[j] + run.shiftY - y[i]) * scale;
        if (j == i || p.squaredNorm() >= kernel::kSupport * kernel::kSupport) continue;
        if (!hiddenByThin(edges, p)) continue;
        visible &= ~(1ull << (j - begin));
        found = true;
      }
      block.words.push_back(visible);
    }
  });
  if (found) {
    offset_[i] = static_cast<std::int32_t>(first);
  } else {
    block.words.resize(first);
  }
}

std::size_t WallLayer::memoryBytes() const {
  std::size_t bytes =
      (lambda_.capacity() + gradientX_.capacity() + gradientY_.capacity() + tangent_.capacity() + offset_.capacity()) *
          4 +
      words_.capacity() * 8;
  for (const Block& b : blocks_) bytes += b.links.capacity() * sizeof(WallLink) + b.words.capacity() * 8;
  return bytes;
}

}  // namespace froude
