// The outline of the fluid: which vertices of the discs' circles are not covered, and what pulls there.
#include <froude/solver/fluid/surface_tension.h>

#include <array>

#include <froude/base/parallel.h>
#include <froude/solver/fluid/lattice.h>

namespace froude {
namespace {
// Measurements: docs/decisions/solver-surface-tension.md.
constexpr double kStep = 0.2;   // of √(ρ dx³/σ); a row of particles would be unstable from 1, drops are from 0.35
constexpr double kLeast = 0.5;  // of that root: discs that part are not held for ever more strongly
// Without it, energy that position-only corrections give to the skin, pull by pull, grows until it boils.
constexpr double kCalm = 0.03;  // kinematic viscosity, of √(σ dx/ρ)
// A particle is beside a void as large as a disc only if its density or the slope of it says so.
constexpr float kFull = 0.97f, kSkew = 0.1f;
constexpr std::size_t kCellBlock = 128;  // cells a task

// The tension of a straight row, in units of what the energy gives a length: the gradient of the arcs between two discs
// is 1/√(1 − d²/4). d² = 2/√3 on the hexagonal lattice that a fluid under pressure takes; with Wendland's kernel rows
// at a surface are closer, measured for supports of 2 to 4 spacings. `ratio`: unit over spacing.
double rowShare(double ratio, kernel::Kind kernel) {
  if (kernel == kernel::Kind::Blend) return 0.84338;
  const double d = std::max(0.4, 1.1 - 0.6 * (ratio - 1.0)) / ratio;
  return std::sqrt(1.0 - 0.25 * d * d);
}

}  // namespace

SurfaceTension::SurfaceTension(const FluidDef& def, double unit, double volume, kernel::Kind kernel)
    : tension_(def.surfaceTension),
      density_(def.density),
      spacing_(def.spacing),
      wetting_(std::cos(def.contactAngle)),
      unit_(unit),
      share_(rowShare(unit / def.spacing, kernel)),
      volume_(static_cast<float>(volume)),
      filter_{def.group, def.collidesWith} {}

double SurfaceTension::longestStep() const {
  return kStep * std::sqrt(density_ * spacing_ * spacing_ * spacing_ / tension_);
}

double SurfaceTension::viscosity() const { return any() ? kCalm * std::sqrt(tension_ * spacing_ / density_) : 0.0; }

void SurfaceTension::find(const StepContext& context, const PairFrame& frame, const WallLayer& walls,
                          std::span<const double> x, std::span<const double> y) {
  findSurface(context, frame, walls);
  blocks_.resize(blockCount(frame.cells.size(), kCellBlock));
  const std::span<const std::uint32_t> start = frame.grid->cellStart();
  parallelFor(frame.cells.size(), kCellBlock, [&](std::size_t begin, std::size_t end) {
    Block& block = blocks_[begin / kCellBlock];
    block.pulls.clear();
    block.walls.clear();
    std::array<WallEdge, kMaxWallEdges> buffer;
    for (std::size_t c = begin; c < end; ++c) {
      const std::uint32_t cell = frame.cells[c];
      for (std::uint32_t i = start[cell]; i < start[cell + 1]; ++i) {
        if (!atSurface(walls, i)) continue;
        gather(frame, cell, i, block.near);
        std::size_t n = 0;
        if (walls.any() && walls.lambda()[i] > 0.0f) {
          n = context.obstacles.edgesNear({x[i], y[i]}, unit_, unit_, filter_, {buffer.data(), buffer.size()});
        }
        const std::span<const WallEdge> edges(buffer.data(), n);
        pullPairs(i, edges, block);
        pullWalls(i, edges, block);
      }
    }
  });
}

void SurfaceTension::findSurface(const StepContext& context, const PairFrame& frame, const WallLayer& walls) {
  const std::size_t n = frame.grid->size();
  for (AlignedArray<float>* a : {&filled_, &skewX_, &skewY_, &squares_, &xx_, &xy_, &yy_}) a->resize(n);
  const MomentLoop loop{
      walls.any() ? walls.lambda() : nullptr, filled_.data(), skewX_.data(), skewY_.data(), squares_.data(),
      {xx_.data(), xy_.data(), yy_.data()}};
  const PairLoops& loops = pairLoops(context.simd);
  parallelFor(frame.cells.size(), kCellBlock,
              [&](std::size_t begin, std::size_t end) { loops.moments(frame, loop, begin, end); });
}

bool SurfaceTension::atSurface(const WallLayer& walls, std::uint32_t i) const {
  const float lambda = walls.any() ? walls.lambda()[i] : 0.0f;
  float x = volume_ * skewX_[i], y = volume_ * skewY_[i];
  if (walls.any()) {
    x += walls.gradientX()[i];
    y += walls.gradientY()[i];
  }
  return volume_ * (filled_[i] - lambda) + lambda < kFull || x * x + y * y > kSkew * kSkew;
}

// In the order of the cells, so that a rounding never depends on who asks.
void SurfaceTension::gather(const PairFrame& frame, std::uint32_t cell, std::uint32_t i, std::vector<Neighbour>& near) {
  constexpr double kUnit = 1.0 / lattice::kUnitsPerSpacing;
  near.clear();
  std::int32_t word = frame.hidden.offset != nullptr ? frame.hidden.offset[i] : -1;
  frame.grid->forEachRun(cell, [&](const CellRun& run) {
    const std::int32_t shiftX = run.shiftX > 0.0 ? frame.periodX : run.shiftX < 0.0 ? -frame.periodX : 0;
    const std::int32_t shiftY = run.shiftY > 0.0 ? frame.periodY : run.shiftY < 0.0 ? -frame.periodY : 0;
    for (std::uint32_t j = run.begin; j < run.end; ++j) {
      const std::uint32_t k = j - run.begin;
      if (j == i) continue;
      if (word >= 0 && (frame.hidden.words[static_cast<std::uint32_t>(word) + k / 64] >> (k % 64) & 1) == 0) continue;
      const Vec2 at(kUnit * lattice::difference(frame.x[j], lattice::difference(frame.x[i], shiftX)),
                    kUnit * lattice::difference(frame.y[j], lattice::difference(frame.y[i], shiftY)));
      if (at.squaredNorm() < 4.0) near.push_back({j, at});
    }
    if (word >= 0) word += static_cast<std::int32_t>((run.end - run.begin + 63) / 64);
  });
}

// Inside another disc, or behind a wall. `own`: the wall that the place is on.
bool SurfaceTension::covered(const Vec2& at, std::span<const Neighbour> near, std::uint32_t but,
                             std::span<const WallEdge> edges, const WallEdge* own) {
  for (const Neighbour& k : near) {
    if (k.particle != but && (k.at - at).squaredNorm() < 1.0) return true;
  }
  for (const WallEdge& e : edges) {
    if (&e != own && hidesPoint(e, at)) return true;
  }
  return false;
}

// A pair is found from its first particle alone, so that both are pulled alike whatever the rounding.
void SurfaceTension::pullPairs(std::uint32_t i, std::span<const WallEdge> edges, Block& block) const {
  for (const Neighbour& j : block.near) {
    if (j.particle < i) continue;
    const double d2 = j.at.squaredNorm();
    if (!(d2 > 0.0)) continue;
    const double d = std::sqrt(d2), half = std::sqrt(1.0 - 0.25 * d2);
    const Vec2 along = j.at / d, across = leftNormal(along);
    int vertices = 0;
    for (const double side : {-half, half}) {
      if (!covered(0.5 * j.at + side * across, block.near, j.particle, edges, nullptr)) ++vertices;
    }
    if (vertices == 0) continue;
    const Vec2 pull = share_ * vertices / std::max(half, kLeast) * along;
    block.pulls.push_back({i, j.particle, pull});
  }
}

// At a distance h the wall hides an arc, which grows as the disc comes nearer, and the chord is wet: gradients of both.
void SurfaceTension::pullWalls(std::uint32_t i, std::span<const WallEdge> edges, Block& block) const {
  for (const WallEdge& e : edges) {
    const Vec2 along = (e.b - e.a).normalized(), normal = rightNormal(along);
    const double h = -normal.dot(e.a);
    if (h <= 0.0 || h >= 1.0) continue;
    const double half = std::sqrt(1.0 - h * h), bound = std::max(half, kLeast);
    const double from = e.a.dot(along), to = e.b.dot(along);
    for (const double side : {-half, half}) {
      if (side < from || side > to) continue;
      const Vec2 at = side * along - h * normal;
      if (covered(at, block.near, i, edges, &e)) continue;
      const Vec2 outward = side > 0.0 ? along : Vec2(-along);
      block.walls.push_back({i, e.owner, wetting_ * outward - (share_ + wetting_ * h) / bound * normal, at});
    }
  }
}

std::size_t SurfaceTension::memoryBytes() const {
  std::size_t bytes = 7 * filled_.capacity() * sizeof(float);
  for (const Block& b : blocks_) {
    bytes += b.pulls.capacity() * sizeof(Pull) + b.walls.capacity() * sizeof(WallPull) +
             b.near.capacity() * sizeof(Neighbour);
  }
  return bytes;
}

}  // namespace froude
