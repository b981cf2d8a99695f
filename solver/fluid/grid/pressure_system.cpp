#include <froude/solver/fluid/grid/pressure_system.h>

#include <algorithm>
#include <cmath>

#include <froude/base/assert.h>
#include <froude/base/parallel.h>
#include <froude/solver/fluid/grid/closed_regions.h>
#include <froude/solver/fluid/grid/multigrid.h>
#include <froude/solver/fluid/grid/pressure_fallback.h>

namespace froude {
namespace {

constexpr std::size_t kTileBlock = 8;  // tiles a task
// Of the largest κ: what five terms in single precision cannot tell from zero.
constexpr float kRounding = 1e-6f;
constexpr std::size_t kUsefulTiles = 64;  // below, one thread is quicker

void clearInParallel(AlignedArray<float>& field) {
  constexpr std::size_t kBlock = 16384;
  parallelFor(field.size(), kBlock,
              [&](std::size_t begin, std::size_t end) { std::fill(field.begin() + begin, field.begin() + end, 0.0f); });
}

}  // namespace

void PressureCoefficients::fromWeights(const TileGrid& grid, const GridCell* kind, const float* wx, const float* wy,
                                       std::size_t extra) {
  edges.clear();
  grid.clear(ax);
  grid.clear(ay);
  ground.clear();
  ground.resize(grid.values() + extra);
  const auto visit = [&](std::size_t cell, std::size_t other, float weight, float* coupling) {
    const bool wet = kind[cell] == GridCell::Fluid, beyond = kind[other] == GridCell::Fluid;
    if (coupling != nullptr && wet && beyond) *coupling = weight;
    if (wet && kind[other] == GridCell::Air) ground[cell] += weight;
  };
  parallelFor(grid.size(), kTileBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin + 1; t < end + 1; ++t) {
      const Tile& tile = grid.tile(t);
      const auto lane = static_cast<std::size_t>(tile.columns - 1), rows = static_cast<std::size_t>(tile.rows);
      const std::size_t left =
          tile.left * TileGrid::kCells + static_cast<std::size_t>(grid.tile(tile.left).columns - 1);
      const std::size_t down =
          tile.down * TileGrid::kCells + 16 * static_cast<std::size_t>(grid.tile(tile.down).rows - 1);
      for (std::size_t j = 0; j < rows; ++j) {
        for (std::size_t i = 0; i <= lane; ++i) {
          const std::size_t k = t * TileGrid::kCells + 16 * j + i;
          if (kind[k] != GridCell::Fluid) continue;
          const std::size_t right = i == lane ? tile.right * TileGrid::kCells + 16 * j : k + 1;
          const std::size_t up = j == rows - 1 ? tile.up * TileGrid::kCells + i : k + 16;
          visit(k, i == 0 ? left + 16 * j : k - 1, wx[k], &ax[k]);
          visit(k, right, wx[right], nullptr);
          visit(k, j == 0 ? down + i : k - 16, wy[k], &ay[k]);
          visit(k, up, wy[up], nullptr);
        }
      }
    }
  });
}

struct PressureSystem::Data {
  explicit Data(SimdTarget target) : loops(&gridLoops(target)), levels(*loops) {}

  double apply(Crew& crew);
  void findResidual(Crew& crew, const float* b, const float* kappa);
  float largestResidual(Crew& crew);
  float advance(Crew& crew, double step, float* kappa);
  void addBodies(const float* x, float sign, float* to, double* product) const;
  PressureReport iterate(Crew& crew, float* kappa, const Limits& limits);

  const GridLoops* loops;
  Multigrid levels;
  ClosedRegions regions;
  const TileGrid* grid = nullptr;
  const PressureCoefficients* coefficients = nullptr;
  std::span<const PressureBody> bodies;
  AlignedArray<float> r, p, q;
};

PressureSystem::PressureSystem(SimdTarget target) : data_(std::make_unique<Data>(target)) {}
PressureSystem::~PressureSystem() = default;
PressureSystem::PressureSystem(PressureSystem&&) noexcept = default;
PressureSystem& PressureSystem::operator=(PressureSystem&&) noexcept = default;

void PressureSystem::prepare(const TileGrid& grid, const PressureCoefficients& coefficients,
                             std::span<const PressureBody> bodies) {
  Data& d = *data_;
  FROUDE_ASSERT(coefficients.ground.size() >= grid.values());
  d.grid = &grid;
  d.coefficients = &coefficients;
  d.bodies = bodies;
  d.levels.build(grid, coefficients);
  d.regions.find(*d.loops, grid, coefficients, d.levels.finest().inverse.data(), bodies);
  for (AlignedArray<float>* a : {&d.r, &d.p, &d.q}) {
    a->resize(coefficients.ground.size());
    clearInParallel(*a);
  }
}

// to += sign·Jᵀ·mobility·J x; product += x·(that) if wanted.
void PressureSystem::Data::addBodies(const float* x, float sign, float* to, double* product) const {
  const AlignedArray<float>& inverse = levels.finest().inverse;
  for (const PressureBody& body : bodies) {
    std::array<double, 3> push{0.0, 0.0, 0.0};
    for (const PressureBody::Entry& e : body.entries) {
      for (std::size_t c = 0; c < 3; ++c) push[c] += static_cast<double>(e.j[c]) * static_cast<double>(x[e.place]);
    }
    std::array<float, 3> answer;
    for (std::size_t c = 0; c < 3; ++c) {
      const double moved = static_cast<double>(body.mobility[c]) * push[c];
      answer[c] = sign * static_cast<float>(moved);
      if (product != nullptr) *product += moved * push[c];
    }
    for (const PressureBody::Entry& e : body.entries) {
      if (inverse[e.place] > 0.0f) to[e.place] += e.j[0] * answer[0] + e.j[1] * answer[1] + e.j[2] * answer[2];
    }
  }
}

double PressureSystem::Data::apply(Crew& crew) {
  double product = levels.apply(crew, p.data(), q.data());
  addBodies(p.data(), 1.0f, q.data(), &product);
  return product;
}

void PressureSystem::Data::findResidual(Crew& crew, const float* b, const float* kappa) {
  levels.residual(crew, b, kappa, r.data());
  addBodies(kappa, -1.0f, r.data(), nullptr);
}

// Also makes the first sweep of the cycle to come.
float PressureSystem::Data::largestResidual(Crew& crew) {
  GridLevel& level = levels.finest();
  const float weight = levels.firstWeight();
  crew.stage(grid->size(), kTileBlock, [&](std::size_t begin, std::size_t end) {
    loops->start(level.matrix, r.data(), weight, level.one.data(), level.sums.data(), begin + 1, end + 1);
  });
  double most = 0.0;
  for (std::size_t t = 1; t < level.tiles(); ++t) most = std::max(most, level.sums[t]);
  for (std::size_t k = grid->values(); k < r.size(); ++k) {
    level.one[k] = weight * level.inverse[k] * r[k];
    most = std::max(most, static_cast<double>(std::abs(r[k])));
  }
  return static_cast<float>(most);
}

// κ += step·p, r −= step·q, and the first sweep of the next cycle. Returns the largest residual.
float PressureSystem::Data::advance(Crew& crew, double step, float* kappa) {
  GridLevel& level = levels.finest();
  const auto along = static_cast<float>(step);
  const float weight = levels.firstWeight();
  crew.stage(grid->size(), kTileBlock, [&](std::size_t begin, std::size_t end) {
    loops->advance(level.matrix, along, p.data(), q.data(), kappa, r.data(), weight, level.one.data(),
                   level.sums.data(), begin + 1, end + 1);
  });
  double most = 0.0;
  for (std::size_t t = 1; t < level.tiles(); ++t) most = std::max(most, level.sums[t]);
  for (std::size_t k = grid->values(); k < r.size(); ++k) {
    kappa[k] += along * p[k];
    r[k] -= along * q[k];
    level.one[k] = weight * level.inverse[k] * r[k];
    most = std::max(most, static_cast<double>(std::abs(r[k])));
  }
  return static_cast<float>(most);
}

// Preconditioned conjugate gradients from the residual r, whose first sweep is made.
PressureReport PressureSystem::Data::iterate(Crew& crew, float* kappa, const Limits& limits) {
  PressureReport report;
  report.residual = largestResidual(crew);
  double before = 0.0;
  while (!(report.residual <= limits.tolerance) && report.iterations < limits.iterations) {
    double product = 0.0;
    const float* z = levels.cycle(crew, r.data(), product);
    const auto share = static_cast<float>(report.iterations == 0 ? 0.0 : product / before);
    before = product;
    crew.stage(grid->size(), kTileBlock, [&](std::size_t begin, std::size_t end) {
      loops->direct(levels.finest().matrix, z, share, p.data(), begin + 1, end + 1);
    });
    for (std::size_t k = grid->values(); k < r.size(); ++k) p[k] = z[k] + share * p[k];
    const double curvature = apply(crew);
    if (!(curvature > 0.0) || !std::isfinite(product)) break;
    report.residual = advance(crew, product / curvature, kappa);
    ++report.iterations;
  }
  report.converged = report.residual <= limits.tolerance;
  return report;
}

PressureReport PressureSystem::solve(const float* b, float* kappa, const Limits& limits) {
  Data& d = *data_;
  PressureReport report;
  const AlignedArray<float>& inverse = d.levels.finest().inverse;
  d.loops->clean(d.levels.finest().matrix, kappa, 0, d.grid->size() + 1);
  for (std::size_t k = d.grid->values(); k < inverse.size(); ++k) kappa[k] = inverse[k] > 0.0f ? kappa[k] : 0.0f;
  clearInParallel(d.p);
  float source = 0.0f;
  Crew::run(d.grid->size() >= kUsefulTiles, [&](Crew& crew) {
    d.findResidual(crew, b, kappa);
    source = d.regions.removeMeans(d.r.data());
    report = d.iterate(crew, kappa, limits);
  });
  if (!report.converged) {
    float most = 0.0f;
    for (std::size_t k = 0; k < inverse.size(); ++k) most = std::max(most, std::abs(kappa[k]));
    report.converged = report.residual <= kRounding * most;
  }
  if (!report.converged) {
    d.q.assign({b, inverse.size()});
    for (std::size_t k = 0; k < inverse.size(); ++k) d.q[k] = inverse[k] > 0.0f ? d.q[k] : 0.0f;
    d.regions.removeMeans(d.q.data());
    report.fallback = true;
    report.converged = solvePressureByFallback(*d.grid, *d.coefficients, d.bodies, d.regions, inverse.data(),
                                               d.q.data(), limits.tolerance, kappa);
    Crew::run(false, [&](Crew& crew) {
      d.findResidual(crew, d.q.data(), kappa);
      report.residual = d.largestResidual(crew);
    });
  }
  d.regions.removeMeans(kappa);
  report.closedRegions = d.regions.count();
  report.closedSource = source;
  return report;
}

std::size_t PressureSystem::memoryBytes() const {
  const Data& d = *data_;
  return d.levels.memoryBytes() + (d.r.capacity() + d.p.capacity() + d.q.capacity()) * sizeof(float);
}

}  // namespace froude
