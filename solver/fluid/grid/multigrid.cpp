#include <froude/solver/fluid/grid/multigrid.h>

#include <algorithm>
#include <array>
#include <span>
#include <utility>

#include <froude/base/parallel.h>

namespace froude {
namespace {

constexpr std::size_t kTileBlock = 8;     // tiles a task
constexpr std::size_t kSharedTiles = 32;  // fewer are one task: sooner done than shared
constexpr std::size_t kMostLevels = 28;   // coordinates of cells have 31 bits
// Of what ties four cells to κ = 0, the share that ties their coarse cell: ½ keeps the distance of a straight surface
// in coarse cells, 1 in fine ones.
constexpr float kGroundShare = 0.7f;

// Weights of the sweeps: reciprocals of the roots of Chebyshev's polynomial over those eigenvalues of D⁻¹A, [low, 2],
// that the next level cannot show. Of degree 2 over [1/2, 2] on the finest; below, where cells are few, of degree 4
// over [1/4, 2].
constexpr float kRoot = 0.75f * 0.70710678f;
constexpr std::array<float, 2> kFine{1.0f / (1.25f + kRoot), 1.0f / (1.25f - kRoot)};
constexpr float kOuter = 0.875f * 0.92387953f, kInner = 0.875f * 0.38268343f;
constexpr std::array<float, 4> kCoarse{1.0f / (1.125f + kOuter), 1.0f / (1.125f - kInner), 1.0f / (1.125f + kInner),
                                       1.0f / (1.125f - kOuter)};
std::span<const float> weightsOf(std::size_t level) {
  if (level == 0) return kFine;
  return kCoarse;
}

template <typename Body>
void overTiles(Crew& crew, const GridLevel& level, Body&& body) {
  const std::size_t count = level.grid->size();
  crew.stage(count, count < kSharedTiles ? count : kTileBlock,
             [&](std::size_t begin, std::size_t end) { body(begin + 1, end + 1); });
}

// Added in the order of the tiles: the same bits on any number of threads.
double sumOf(const GridLevel& level) {
  double all = 0.0;
  for (std::size_t t = 1; t < level.tiles(); ++t) all += level.sums[t];
  return all;
}

// By an eighth, as TileGrid's fields.
void growTo(AlignedArray<float>& field, std::size_t places) {
  if (places > field.capacity()) {
    field.clear();
    field.reserve(places + places / 8);
  }
  field.resize(places);
}

std::int32_t halved(std::int32_t period) { return (period + 1) / 2; }

}  // namespace

float Multigrid::firstWeight(std::size_t level) const { return level + 1 < used_ ? weightsOf(level)[0] : 1.0f; }

void Multigrid::build(const TileGrid& grid, const PressureCoefficients& coefficients) {
  coefficients_ = &coefficients;
  if (levels_.empty()) levels_.resize(kMostLevels);
  levels_[0].grid = &grid;
  finish(levels_[0], coefficients.ax, coefficients.ay, coefficients.ground);
  findAnchors();
  used_ = 1;
  while (used_ < kMostLevels && levels_[used_ - 1].coupled) {
    coarsen(levels_[used_ - 1], levels_[used_]);
    if (used_ == 1) joinExtras(levels_[1]);
    finish(levels_[used_], levels_[used_].ax, levels_[used_].ay, levels_[used_].ground);
    ++used_;
  }
}

// The diagonal, and what the loops need beside it.
void Multigrid::finish(GridLevel& level, const AlignedArray<float>& ax, const AlignedArray<float>& ay,
                       const AlignedArray<float>& ground) {
  linkTiles(*level.grid, level.links);
  const bool finest = &level == &levels_[0];
  const std::size_t places = finest ? ground.size() : level.grid->values();
  const std::array<AlignedArray<float>*, 3> empty{&level.r, &level.one, &level.two};
  for (AlignedArray<float>* a : empty) {
    growTo(*a, places);
    std::fill(a->begin() + level.grid->values(), a->end(), 0.0f);
  }
  for (AlignedArray<float>* a : {&level.ar, &level.diagonal, &level.inverse}) {
    growTo(*a, places);
    std::fill_n(a->data(), TileGrid::kCells, 0.0f);
  }
  level.sums.resize(level.tiles());
  const GridAssembly parts{level.links.data(),    ax.data(),           ay.data(), ground.data(), level.ar.data(),
                           level.diagonal.data(), level.inverse.data()};
  parallelFor(level.grid->size(), kTileBlock, [&](std::size_t begin, std::size_t end) {
    loops_->assemble(parts, level.sums.data(), begin + 1, end + 1);
    for (AlignedArray<float>* a : empty)
      std::fill_n(a->data() + (begin + 1) * TileGrid::kCells, (end - begin) * TileGrid::kCells, 0.0f);
  });
  level.coupled = sumOf(level) > 0.0;
  if (finest) addEdges();
  level.matrix = {level.links.data(),    ax.data(),           level.ar.data(), ay.data(),
                  level.diagonal.data(), level.inverse.data()};
}

// Into the finest level's diagonal.
void Multigrid::addEdges() {
  GridLevel& level = levels_[0];
  const auto invert = [&](std::size_t k) {
    level.inverse[k] = level.diagonal[k] > 0.0f ? 1.0f / level.diagonal[k] : 0.0f;
  };
  for (std::size_t k = level.grid->values(); k < level.diagonal.size(); ++k) {
    level.diagonal[k] = coefficients_->ground[k];
    invert(k);
  }
  const auto add = [&](std::size_t k, float coefficient) {
    level.diagonal[k] += coefficient;
    invert(k);
    if (k >= level.grid->values() || !(level.inverse[k] > 0.0f)) return;
    TileLinks& link = level.links[k / TileGrid::kCells];  // whose rows may have had no other unknown
    const auto row = static_cast<std::int32_t>(k % TileGrid::kCells / 16);
    link.first = link.end == 0 ? row : std::min(link.first, row);
    link.end = std::max(link.end, row + 1);
  };
  for (const PressureEdge& edge : coefficients_->edges) {
    add(edge.a, edge.coefficient);
    add(edge.b, edge.coefficient);
    level.coupled = true;
  }
}

void Multigrid::coarsen(GridLevel& fine, GridLevel& coarse) {
  const TileGrid& grid = *fine.grid;
  indices_.clear();
  for (std::size_t t = 1; t <= grid.size(); ++t) indices_.push_back({grid.tile(t).at.x >> 1, grid.tile(t).at.y >> 1});
  std::sort(indices_.begin(), indices_.end());
  const auto count = static_cast<std::size_t>(std::unique(indices_.begin(), indices_.end()) - indices_.begin());
  const TilePeriod period{halved(grid.period().x), halved(grid.period().y)};
  coarse.own.build({indices_.data(), count}, period);
  coarse.grid = &coarse.own;
  for (AlignedArray<float>* a : {&coarse.ax, &coarse.ay, &coarse.ground}) coarse.own.clear(*a);
  fine.parents.resize(fine.tiles());
  for (std::size_t t = 1; t < fine.tiles(); ++t) {
    const TileIndex at = grid.tile(t).at;
    fine.parents[t].place = coarse.own.find(at.x >> 1, at.y >> 1) * static_cast<std::uint32_t>(TileGrid::kCells) +
                            static_cast<std::uint32_t>((at.y & 1) * 128 + (at.x & 1) * 8);
  }
  const float* ground = &fine == &levels_[0] ? coefficients_->ground.data() : fine.ground.data();
  const GridCoarsening parts{fine.matrix.ax, fine.matrix.ay,   ground,           fine.parents.data(),
                             kGroundShare,   coarse.ax.data(), coarse.ay.data(), coarse.ground.data()};
  parallelFor(grid.size(), kTileBlock,
              [&](std::size_t begin, std::size_t end) { loops_->coarsen(parts, begin + 1, end + 1); });
  // What is its own neighbour is coupled to nothing.
  if (period.x == 1) coarse.own.clear(coarse.ax);
  if (period.y == 1) coarse.own.clear(coarse.ay);
}

// An extra unknown is corrected with the cell of the grid to which it is coupled most, or with that of a neighbour.
void Multigrid::findAnchors() {
  const std::size_t base = finest().grid->values();
  anchors_.clear();
  anchors_.resize(extra());
  if (anchors_.empty()) return;
  AlignedArray<float>& most = levels_[0].two;  // free for now
  for (const PressureEdge& edge : coefficients_->edges) {
    const auto weigh = [&](std::uint32_t e, std::uint32_t cell) {
      if (e < base || cell >= base || edge.coefficient <= most[e]) return;
      most[e] = edge.coefficient;
      anchors_[e - base] = cell;
    };
    weigh(edge.a, edge.b);
    weigh(edge.b, edge.a);
  }
  for (bool found = true; found;) {
    found = false;
    for (const PressureEdge& edge : coefficients_->edges) {
      if (edge.a < base || edge.b < base) continue;
      std::uint32_t &a = anchors_[edge.a - base], &b = anchors_[edge.b - base];
      if ((a == 0) == (b == 0)) continue;
      a = b = std::max(a, b);
      found = true;
    }
  }
  std::fill(most.begin() + base, most.end(), 0.0f);
}

// Edges join the coarse cells that hold their ends, where these are neighbours.
void Multigrid::joinExtras(GridLevel& coarse) const {
  const GridLevel& fine = levels_[0];
  const std::size_t base = fine.grid->values();
  const auto cellOf = [&](std::size_t place) {
    return place < base ? place : static_cast<std::size_t>(anchors_[place - base]);
  };
  for (std::size_t e = 0; e < anchors_.size(); ++e) {
    if (anchors_[e] != 0) coarse.ground[parentOf(anchors_[e])] += coefficients_->ground[base + e];
  }
  for (const PressureEdge& edge : coefficients_->edges) {
    const std::size_t a = cellOf(edge.a), b = cellOf(edge.b);
    if (a == 0 || b == 0) continue;
    const std::size_t from = parentOf(a), to = parentOf(b);
    const auto at = coarse.own.cell(from);
    const float share = 0.5f * edge.coefficient;
    if (coarse.own.place(at[0] - 1, at[1]) == to) coarse.ax[from] += share;
    if (coarse.own.place(at[0] + 1, at[1]) == to) coarse.ax[to] += share;
    if (coarse.own.place(at[0], at[1] - 1) == to) coarse.ay[from] += share;
    if (coarse.own.place(at[0], at[1] + 1) == to) coarse.ay[to] += share;
  }
}

double Multigrid::apply(Crew& crew, const float* x, float* q) {
  GridLevel& level = finest();
  overTiles(crew, level,
            [&](std::size_t b, std::size_t e) { loops_->apply(level.matrix, x, q, level.sums.data(), b, e); });
  double product = sumOf(level);
  for (std::size_t k = level.grid->values(); k < coefficients_->ground.size(); ++k) {
    q[k] = level.diagonal[k] * x[k];
    product += static_cast<double>(q[k]) * static_cast<double>(x[k]);
  }
  for (const PressureEdge& edge : coefficients_->edges) {
    q[edge.a] -= edge.coefficient * x[edge.b];
    q[edge.b] -= edge.coefficient * x[edge.a];
    product -=
        2.0 * static_cast<double>(edge.coefficient) * static_cast<double>(x[edge.a]) * static_cast<double>(x[edge.b]);
  }
  return product;
}

void Multigrid::residual(Crew& crew, const float* b, const float* x, float* r) {
  GridLevel& level = finest();
  overTiles(crew, level,
            [&](std::size_t begin, std::size_t end) { loops_->residual(level.matrix, b, x, r, begin, end); });
  for (std::size_t k = level.grid->values(); k < coefficients_->ground.size(); ++k) {
    r[k] = level.inverse[k] > 0.0f ? b[k] - level.diagonal[k] * x[k] : 0.0f;
  }
  for (const PressureEdge& edge : coefficients_->edges) {
    r[edge.a] += edge.coefficient * x[edge.b];
    r[edge.b] += edge.coefficient * x[edge.a];
  }
}

// Returns r·out if `sum`.
double Multigrid::smooth(Crew& crew, GridLevel& level, const float* r, const float* x, float weight, float* out,
                         bool sum) {
  double* sums = sum ? level.sums.data() : nullptr;
  overTiles(crew, level,
            [&](std::size_t b, std::size_t e) { loops_->smooth(level.matrix, r, x, weight, out, sums, b, e); });
  double product = sum ? sumOf(level) : 0.0;
  if (&level != &levels_[0]) return product;
  const auto add = [&](std::size_t k, float value) {
    const float change = weight * level.inverse[k] * value;
    out[k] += change;
    product += static_cast<double>(r[k]) * static_cast<double>(change);
  };
  for (std::size_t k = level.grid->values(); k < coefficients_->ground.size(); ++k) {
    out[k] = (1.0f - weight) * x[k];
    product += static_cast<double>(r[k]) * static_cast<double>(out[k]);
    add(k, r[k]);
  }
  for (const PressureEdge& edge : coefficients_->edges) {
    add(edge.a, edge.coefficient * x[edge.b]);
    add(edge.b, edge.coefficient * x[edge.a]);
  }
  return product;
}

const float* Multigrid::cycle(Crew& crew, const float* r, double& product) { return visit(crew, 0, r, &product); }

// The first sweep's result is in level.one.
const float* Multigrid::visit(Crew& crew, std::size_t k, const float* r, double* product) {
  GridLevel& level = levels_[k];
  float *one = level.one.data(), *two = level.two.data();
  if (k + 1 == used_) {  // nothing is coupled: the sweep with weight 1 has solved it
    if (product != nullptr) {
      *product = 0.0;
      for (std::size_t i = 0; i < level.inverse.size(); ++i) {
        *product += static_cast<double>(r[i]) * static_cast<double>(one[i]);
      }
    }
    return one;
  }
  const std::span<const float> weights = weightsOf(k);
  for (std::size_t i = 1; i < weights.size(); ++i) {
    smooth(crew, level, r, one, weights[i], two, false);
    std::swap(one, two);
  }
  correct(crew, k, r, one);
  for (std::size_t i = weights.size(); i-- > 0;) {
    const double sum = smooth(crew, level, r, one, weights[i], two, i == 0 && product != nullptr);
    if (i == 0 && product != nullptr) *product = sum;
    std::swap(one, two);
  }
  return one;
}

// Adds to x what the coarser levels make of its residual.
void Multigrid::correct(Crew& crew, std::size_t k, const float* r, float* x) {
  GridLevel &level = levels_[k], &coarse = levels_[k + 1];
  overTiles(crew, level, [&](std::size_t b, std::size_t e) {
    loops_->restrictResidual(level.matrix, r, x, level.parents.data(), coarse.r.data(), b, e);
  });
  if (k == 0) restrictExtras(r, x);
  overTiles(crew, coarse, [&](std::size_t b, std::size_t e) {
    loops_->start(coarse.matrix, coarse.r.data(), firstWeight(k + 1), coarse.one.data(), nullptr, b, e);
  });
  const float* correction = visit(crew, k + 1, coarse.r.data(), nullptr);
  overTiles(crew, level, [&](std::size_t b, std::size_t e) {
    loops_->prolong(level.matrix, correction, level.parents.data(), x, b, e);
  });
  if (k > 0) return;
  for (std::size_t e = 0; e < anchors_.size(); ++e) {
    const std::size_t place = level.grid->values() + e;
    if (anchors_[e] != 0 && level.inverse[place] > 0.0f) x[place] += correction[parentOf(anchors_[e])];
  }
}

// What the edges add to the residual of the cells, and what the extra unknowns have of it, goes to the second level.
void Multigrid::restrictExtras(const float* r, const float* x) {
  const GridLevel& level = levels_[0];
  const std::size_t base = level.grid->values();
  const auto give = [&](std::size_t place, float value) {
    const std::size_t cell = place < base ? place : anchors_[place - base];
    if (cell != 0) levels_[1].r[parentOf(cell)] += value;
  };
  for (std::size_t e = base; e < base + anchors_.size(); ++e) give(e, r[e] - level.diagonal[e] * x[e]);
  for (const PressureEdge& edge : coefficients_->edges) {
    give(edge.a, edge.coefficient * x[edge.b]);
    give(edge.b, edge.coefficient * x[edge.a]);
  }
}

// The place in the second level of a cell of the finest.
std::size_t Multigrid::parentOf(std::size_t cell) const {
  const std::size_t within = cell % TileGrid::kCells;
  return levels_[0].parents[cell / TileGrid::kCells].place + (within / 32) * 16 + within % 16 / 2;
}

std::size_t Multigrid::memoryBytes() const {
  std::size_t bytes = indices_.capacity() * sizeof(TileIndex) + anchors_.capacity() * sizeof(std::uint32_t);
  for (const GridLevel& level : levels_) {
    bytes += level.own.memoryBytes() + level.links.capacity() * sizeof(TileLinks) +
             level.parents.capacity() * sizeof(TileParent) + level.sums.capacity() * sizeof(double);
    for (const AlignedArray<float>* a : {&level.ax, &level.ay, &level.ground, &level.ar, &level.diagonal,
                                         &level.inverse, &level.r, &level.one, &level.two}) {
      bytes += a->capacity() * sizeof(float);
    }
  }
  return bytes;
}

}  // namespace froude
