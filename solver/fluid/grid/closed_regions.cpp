#include <froude/solver/fluid/grid/closed_regions.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include <froude/base/parallel.h>

namespace froude {
namespace {

constexpr std::size_t kTileBlock = 32;  // tiles a task
constexpr std::uint32_t kNone = ~std::uint32_t{0};
// Share of a body's entries in a region that may be left over from a closed outline, for which they add up to nothing.
constexpr double kNothing = 1e-4;

}  // namespace

void ClosedRegions::find(const GridLoops& loops, const TileGrid& grid, const PressureCoefficients& coefficients,
                         const float* inverse, std::span<const PressureBody> bodies) {
  findBits(loops, grid, coefficients, inverse);
  findRuns(grid, coefficients, inverse);
  joinRows(grid);
  for (const PressureEdge& edge : coefficients.edges) {
    if (edge.coefficient > 0.0f) join(runOf(edge.a), runOf(edge.b));
  }
  for (std::uint32_t run = 0; run < runs_.size(); ++run) {
    if (grounded_[run] != 0) grounded_[root(run)] = 1;
  }
  groundBodies(bodies);
  listRegions();
}

void ClosedRegions::findBits(const GridLoops& loops, const TileGrid& grid, const PressureCoefficients& coefficients,
                             const float* inverse) {
  for (AlignedArray<std::uint16_t>* bits : {&known_, &left_, &down_, &ground_}) bits->resize(16 * grid.size() + 16);
  parallelFor(grid.size() + 1, kTileBlock, [&](std::size_t begin, std::size_t end) {
    loops.positive(inverse, known_.data(), begin, end);
    loops.positive(coefficients.ax.data(), left_.data(), begin, end);
    loops.positive(coefficients.ay.data(), down_.data(), begin, end);
    loops.positive(coefficients.ground.data(), ground_.data(), begin, end);
  });
}

void ClosedRegions::findRuns(const TileGrid& grid, const PressureCoefficients& coefficients, const float* inverse) {
  runs_.clear();
  grounded_.clear();
  const std::size_t rows = grid.size() * 16 + 16;
  rowFirst_.resize(rows);
  rowStarts_.resize(rows);
  for (std::size_t row = 0; row < rows; ++row) {
    const std::uint32_t known = known_[row], linked = left_[row] & ~1u;
    std::uint32_t starts = known & ~(linked & (known << 1));
    rowFirst_[row] = static_cast<std::uint32_t>(runs_.size());
    rowStarts_[row] = static_cast<std::uint16_t>(starts);
    if (starts == 0) continue;
    const std::uint32_t ground = ground_[row];
    while (starts != 0) {
      const auto begin = static_cast<std::uint32_t>(std::countr_zero(starts));
      starts &= starts - 1;
      const std::uint32_t stop = starts | ~known;  // where the run has ended
      const auto end = static_cast<std::uint32_t>(std::countr_zero(stop & ~((2u << begin) - 1)));
      runs_.push_back({static_cast<std::uint32_t>(16 * row) + begin, end - begin});
      grounded_.push_back((ground & ((1u << end) - (1u << begin))) != 0 ? 1 : 0);
    }
  }
  extraBase_ = grid.values();
  extraFirst_ = static_cast<std::uint32_t>(runs_.size());
  for (std::size_t k = extraBase_; k < coefficients.ground.size(); ++k) {
    runs_.push_back({static_cast<std::uint32_t>(k), inverse[k] > 0.0f ? 1u : 0u});
    grounded_.push_back(coefficients.ground[k] > 0.0f ? 1 : 0);
  }
  parent_.resize(runs_.size());
  for (std::uint32_t run = 0; run < runs_.size(); ++run) parent_[run] = run;
}

std::uint32_t ClosedRegions::runOf(std::size_t place) const {
  if (place >= extraBase_) return extraFirst_ + static_cast<std::uint32_t>(place - extraBase_);
  const std::uint32_t before = rowStarts_[place / 16] & ((2u << (place % 16)) - 1);
  return rowFirst_[place / 16] + static_cast<std::uint32_t>(std::popcount(before)) - 1;
}

std::uint32_t ClosedRegions::root(std::uint32_t run) {
  while (parent_[run] != run) {
    parent_[run] = parent_[parent_[run]];
    run = parent_[run];
  }
  return run;
}

// The smaller number becomes the root, so that it is a region's first run.
void ClosedRegions::join(std::uint32_t a, std::uint32_t b) {
  a = root(a);
  b = root(b);
  if (a == b) return;
  parent_[std::max(a, b)] = std::min(a, b);
}

void ClosedRegions::joinRows(const TileGrid& grid) {
  for (std::size_t t = 1; t <= grid.size(); ++t) {
    const Tile& tile = grid.tile(t);
    for (std::size_t j = 0; j < 16; ++j) {
      const std::size_t row = 16 * t + j;
      if (rowStarts_[row] == 0) continue;
      const std::size_t left = 16 * (16 * tile.left + j) + static_cast<std::size_t>(grid.tile(tile.left).columns - 1);
      if ((left_[row] & 1u) != 0) join(runOf(16 * row), runOf(left));
      const std::size_t below =
          j > 0 ? row - 1 : 16 * tile.down + static_cast<std::size_t>(grid.tile(tile.down).rows - 1);
      const std::uint32_t linked = down_[row];
      // Once for each pair of runs: where a column left of this one joins the same two, nothing is new.
      const std::uint32_t starts = rowStarts_[row] | rowStarts_[below];
      for (std::uint32_t fresh = linked & ~((linked << 1) & ~starts); fresh != 0; fresh &= fresh - 1) {
        const auto i = static_cast<std::size_t>(std::countr_zero(fresh));
        join(runOf(16 * row + i), runOf(16 * below + i));
      }
    }
  }
}

// A free body on which a constant pressure of the region has an effect, says where zero is, or ties it to the pressure
// on its other sides.
void ClosedRegions::groundBodies(std::span<const PressureBody> bodies) {
  for (const PressureBody& body : bodies) {
    push_.clear();
    push_.resize(4 * runs_.size());
    for (const PressureBody::Entry& entry : body.entries) {
      const std::size_t to = 4 * static_cast<std::size_t>(root(runOf(entry.place)));
      for (std::size_t c = 0; c < 3; ++c) {
        push_[to + c] += static_cast<double>(entry.j[c]);
        push_[to + 3] = std::max(push_[to + 3], static_cast<double>(std::abs(entry.j[c])));
      }
    }
    for (const PressureBody::Entry& entry : body.entries) {
      const std::uint32_t region = root(runOf(entry.place));
      const double* push = push_.data() + 4 * static_cast<std::size_t>(region);
      for (std::size_t c = 0; c < 3; ++c) {
        if (body.mobility[c] > 0.0f && std::abs(push[c]) > kNothing * push[3]) grounded_[region] = 1;
      }
    }
  }
}

void ClosedRegions::listRegions() {
  region_.resize(runs_.size());
  pieces_.clear();
  sizes_.clear();
  firsts_.clear();
  for (std::uint32_t run = 0; run < runs_.size(); ++run) {
    const std::uint32_t r = root(run);
    if (r == run) {
      region_[run] = kNone;
      if (grounded_[run] == 0 && runs_[run].length > 0) {
        region_[run] = static_cast<std::uint32_t>(sizes_.size());
        sizes_.push_back(0.0);
        firsts_.push_back(runs_[run].place);
      }
    }
    if (region_[r] == kNone) continue;
    pieces_.push_back({runs_[run].place, runs_[run].length, region_[r]});
    sizes_[region_[r]] += static_cast<double>(runs_[run].length);
  }
}

float ClosedRegions::removeMeans(float* field) const {
  if (sizes_.empty()) return 0.0f;
  sums_.clear();
  sums_.resize(sizes_.size());
  for (const Piece& piece : pieces_) {
    float sum = 0.0f;  // of at most 16
    for (std::uint32_t k = 0; k < piece.length; ++k) sum += field[piece.place + k];
    sums_[piece.region] += static_cast<double>(sum);
  }
  double most = 0.0;
  for (std::size_t r = 0; r < sizes_.size(); ++r) {
    sums_[r] /= sizes_[r];
    most = std::max(most, std::abs(sums_[r]));
  }
  for (const Piece& piece : pieces_) {
    for (std::uint32_t k = 0; k < piece.length; ++k) field[piece.place + k] -= static_cast<float>(sums_[piece.region]);
  }
  return static_cast<float>(most);
}

}  // namespace froude
