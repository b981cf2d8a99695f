#include <froude/solver/fluid/grid/face_field.h>

#include <algorithm>

#include <froude/base/parallel.h>

namespace froude {
namespace {

constexpr std::int32_t kSide = TileGrid::kSide;
constexpr std::size_t kCells = TileGrid::kCells;
constexpr std::size_t kTileBlock = 4;  // tiles a task

void forEachTile(const TileGrid& tiles, FunctionRef<void(std::size_t)> visit) {
  parallelFor(tiles.size(), kTileBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin + 1; t <= end; ++t) visit(t);
  });
}

// To `out` the sums of tile t and what the particles of its neighbours give to it, in a fixed order.
template <typename SumsOf>
void joinSums(const TileGrid& tiles, std::size_t t, const SumsOf& sumsOf, float* out) {
  const Tile& tile = tiles.tile(t);
  const float* own = sumsOf(t);
  for (std::int32_t j = 0; j < kSide; ++j) {
    for (std::int32_t i = 0; i < kSide; ++i) out[j * kSide + i] = own[TileSums::at(i, j)];
  }
  const std::int32_t lastI = tile.columns - 1, lastJ = tile.rows - 1;
  auto addRow = [&](std::uint32_t from, std::int32_t to, std::int32_t fromJ) {
    if (from == 0) return;
    const float* sums = sumsOf(from);
    for (std::int32_t i = 0; i <= lastI; ++i) out[to * kSide + i] += sums[TileSums::at(i, fromJ)];
  };
  auto addColumn = [&](std::uint32_t from, std::int32_t to, std::int32_t fromI) {
    if (from == 0) return;
    const float* sums = sumsOf(from);
    for (std::int32_t j = 0; j <= lastJ; ++j) out[j * kSide + to] += sums[TileSums::at(fromI, j)];
  };
  auto addCorner = [&](std::uint32_t from, std::int32_t toI, std::int32_t toJ, std::int32_t fromI, std::int32_t fromJ) {
    if (from != 0) out[toJ * kSide + toI] += sumsOf(from)[TileSums::at(fromI, fromJ)];
  };
  const std::int32_t leftEnd = tiles.tile(tile.left).columns, downEnd = tiles.tile(tile.down).rows;
  addRow(tile.down, 0, downEnd);
  addRow(tile.up, lastJ, -1);
  addColumn(tile.left, 0, leftEnd);
  addColumn(tile.right, lastI, -1);
  addCorner(tile.downLeft, 0, 0, leftEnd, downEnd);
  addCorner(tile.downRight, lastI, 0, -1, downEnd);
  addCorner(tile.upLeft, 0, lastJ, leftEnd, -1);
  addCorner(tile.upRight, lastI, lastJ, -1, -1);
}

}  // namespace

void FaceField::collect(const ParticleTiles& particles, const GridParticles& columns, const TransferLoops& loops) {
  tiles_ = &particles.tiles();
  const TileGrid& tiles = *tiles_;
  for (FaceComponent* c : {&x, &y}) {
    for (AlignedArray<float>* field : {&c->weight, &c->value, &c->change, &c->shift, &c->open, &c->solved, &c->known})
      tiles.clear(*field);
  }
  tiles.clear(node);
  sumsOf_.assign(tiles.size() + 1, 0);
  std::uint32_t count = 0;
  for (std::size_t t = 1; t <= tiles.size(); ++t) {
    if (!particles.empty(t)) sumsOf_[t] = ++count;
  }
  if (sums_.size() < count + 1) sums_.resize(count + 1);  // the first ones stay zero
  forEachTile(tiles, [&](std::size_t t) {
    if (sumsOf_[t] != 0) loops.give(columns, particles.start(t), sums_[sumsOf_[t]]);
  });
  forEachTile(tiles, [&](std::size_t t) {
    auto join = [&](auto array, float* out) {
      joinSums(
          tiles, t, [&](std::size_t s) -> const float* { return sums_[sumsOf_[s]].*array; }, out);
    };
    const std::size_t at = t * kCells;
    join(&TileSums::uWeight, x.weight.data() + at);
    join(&TileSums::uSum, x.value.data() + at);
    join(&TileSums::vWeight, y.weight.data() + at);
    join(&TileSums::vSum, y.value.data() + at);
    join(&TileSums::node, node.data() + at);
    for (FaceComponent* c : {&x, &y}) {
      for (std::size_t k = at; k < at + kCells; ++k) {
        const bool any = c->weight[k] > 0.0f;
        c->value[k] = any ? c->value[k] / c->weight[k] : 0.0f;
        c->known[k] = any ? 1.0f : 0.0f;
      }
    }
  });
}

void FaceField::add(float byX, float byY) {
  forEachTile(*tiles_, [&](std::size_t t) {
    for (std::size_t k = t * kCells; k < (t + 1) * kCells; ++k) {
      x.value[k] += byX * x.known[k];
      y.value[k] += byY * y.known[k];
    }
  });
}

void FaceField::extrapolate(int layers) {
  for (int layer = 0; layer < layers; ++layer) {
    extrapolateLayer(x.value, x.known);
    extrapolateLayer(y.value, y.known);
  }
}

void FaceField::spread(AlignedArray<float> FaceComponent::*field, int layers) {
  for (FaceComponent* c : {&x, &y}) {
    reached_.resize(tiles_->values());
    std::copy_n(c->solved.data(), tiles_->values(), reached_.data());
    for (int layer = 0; layer < layers; ++layer) extrapolateLayer(c->*field, reached_);
  }
}

void FaceField::extrapolateLayer(AlignedArray<float>& values, AlignedArray<float>& knowns) {
  const TileGrid& tiles = *tiles_;
  nextValue_.resize(tiles.values());
  nextKnown_.resize(tiles.values());
  active_.assign(tiles.size() + 1, 0);
  forEachTile(tiles, [&](std::size_t t) {
    const float* known = knowns.data() + t * kCells;
    bool any = false;
    for (std::size_t k = 0; k < kCells; ++k) any = any || known[k] == 0.0f;
    if (!any) return;
    active_[t] = 1;
    TileHalo value, weight;
    tiles.loadHalo(values.data(), t, value);
    tiles.loadHalo(knowns.data(), t, weight);
    float* to = nextValue_.data() + t * kCells;
    float* toKnown = nextKnown_.data() + t * kCells;
    for (std::int32_t j = 0; j < kSide; ++j) {
      const float *v = value.row(j), *w = weight.row(j), *vu = value.row(j + 1), *wu = weight.row(j + 1),
                  *vd = value.row(j - 1), *wd = weight.row(j - 1);
      for (std::int32_t i = 0; i < kSide; ++i) {
        const float count = (w[i - 1] + w[i + 1]) + (wd[i] + wu[i]);
        const float sum = (v[i - 1] + v[i + 1]) + (vd[i] + vu[i]);
        const bool fresh = w[i] == 0.0f && count > 0.0f;
        to[j * kSide + i] = fresh ? sum / count : v[i];
        toKnown[j * kSide + i] = fresh ? 1.0f : w[i];
      }
    }
  });
  forEachTile(tiles, [&](std::size_t t) {
    if (active_[t] == 0) return;
    const std::size_t at = t * kCells;
    std::copy_n(nextValue_.data() + at, kCells, values.data() + at);
    std::copy_n(nextKnown_.data() + at, kCells, knowns.data() + at);
  });
}

void FaceField::fillWindow(std::size_t t, const AlignedArray<float>& u, const AlignedArray<float>& v,
                           TileWindow& window) const {
  constexpr std::int32_t kMargin = TileWindow::kMargin;
  const TileGrid& tiles = *tiles_;
  const Tile& tile = tiles.tile(t);
  const TilePeriod period = tiles.period();
  const std::int32_t firstI = tile.at.x * kSide, firstJ = tile.at.y * kSide;
  auto nearSeam = [&](std::int32_t first, std::int32_t length) {
    return length > 0 && (first < kMargin || first + kSide + kMargin > length);
  };
  if (nearSeam(firstI, period.x) || nearSeam(firstJ, period.y)) {
    auto wrapped = [](std::int32_t i, std::int32_t length) { return length > 0 ? (i % length + length) % length : i; };
    for (std::int32_t j = -kMargin; j < kSide + kMargin; ++j) {
      for (std::int32_t i = -kMargin; i < kSide + kMargin; ++i) {
        const std::size_t from = tiles.place(wrapped(firstI + i, period.x), wrapped(firstJ + j, period.y));
        window.u[TileWindow::at(i, j)] = u[from];
        window.v[TileWindow::at(i, j)] = v[from];
      }
    }
    return;
  }
  const std::uint32_t at[3][3] = {{tile.downLeft, tile.down, tile.downRight},
                                  {tile.left, static_cast<std::uint32_t>(t), tile.right},
                                  {tile.upLeft, tile.up, tile.upRight}};
  auto copy = [&](const AlignedArray<float>& field, float* out) {
    for (std::int32_t j = -kMargin; j < kSide + kMargin; ++j) {
      const std::uint32_t* row = at[(j + kSide) / kSide];
      const std::size_t line = static_cast<std::size_t>((j + kSide) % kSide) * kSide;
      float* to = out + TileWindow::at(-kMargin, j);
      std::copy_n(field.data() + row[0] * kCells + line + kSide - kMargin, kMargin, to);
      std::copy_n(field.data() + row[1] * kCells + line, kSide, to + kMargin);
      std::copy_n(field.data() + row[2] * kCells + line, kMargin, to + kMargin + kSide);
    }
  };
  copy(u, window.u);
  copy(v, window.v);
}

std::size_t FaceField::memoryBytes() const {
  return sums_.capacity() * sizeof(TileSums) + sumsOf_.capacity() * sizeof(std::uint32_t) +
         (11 * node.capacity() + nextValue_.capacity() + nextKnown_.capacity()) * sizeof(float);
}

}  // namespace froude
