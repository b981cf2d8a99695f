#include <froude/solver/fluid/grid/face_field.h>

#include <algorithm>

#include <froude/base/crew.h>
#include <froude/base/parallel.h>

namespace froude {
namespace {

constexpr std::int32_t kSide = TileGrid::kSide;
constexpr std::size_t kCells = TileGrid::kCells;
constexpr std::size_t kTileBlock = 4;     // tiles a task
constexpr std::size_t kFrontBlock = 32;   // tiles a task of a layer
constexpr std::size_t kUsefulTiles = 64;  // below, one thread goes through layers quicker
// How much of a tile is known.
constexpr std::uint8_t kNothing = 0, kPart = 1, kAll = 2;

std::uint8_t extentOf(const std::uint16_t* rows, const TileLinks& link) {
  const std::uint32_t columns = (2u << link.lane) - 1u;
  std::uint32_t some = 0, all = columns;
  for (std::int32_t j = 0; j < link.rows; ++j) {
    some |= rows[j];
    all &= rows[j];
  }
  return some == 0 ? kNothing : all == columns ? kAll : kPart;
}

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

void FaceField::collect(const ParticleTiles& particles, const GridParticles& columns, SimdTarget simd) {
  tiles_ = &particles.tiles();
  simd_ = simd;
  const TransferLoops& loops = transferLoops(simd);
  linkTiles(*tiles_, links_);
  const TileGrid& tiles = *tiles_;
  for (FaceComponent* c : {&x, &y}) {
    for (AlignedArray<float>* field : {&c->weight, &c->value, &c->change, &c->shift, &c->open, &c->solved, &c->known})
      tiles.fit(*field);
  }
  tiles.fit(node);
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
      for (AlignedArray<float>* field : {&c->change, &c->shift, &c->solved})
        std::fill_n(field->data() + at, kCells, 0.0f);
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
  start(fronts_[0], x.value, x.known, x.known.data());
  start(fronts_[1], y.value, y.known, y.known.data());
  goOn(layers);
}

void FaceField::spread(AlignedArray<float> FaceComponent::*field, int layers) {
  start(fronts_[0], x.*field, x.solved, nullptr);
  start(fronts_[1], y.*field, y.solved, nullptr);
  goOn(layers);
}

void FaceField::start(Front& front, AlignedArray<float>& values, const AlignedArray<float>& known, float* reached) {
  const std::size_t count = tiles_->size() + 1;
  front.values = values.data();
  front.reached = reached;
  front.known.resize(count * kSide);
  front.fresh.resize(count * kSide);
  front.extent.resize(count);
  front.moves.resize(count);
  tiles_->fit(front.next);
  front.extent[0] = kNothing;
  const GridLoops& loops = gridLoops(simd_);
  forEachTile(*tiles_, [&](std::size_t t) {
    loops.positive(known.data(), front.known.data(), t, t + 1);
    std::uint16_t* rows = front.known.data() + t * kSide;
    const TileLinks& link = links_[t];
    const auto columns = static_cast<std::uint16_t>((2u << link.lane) - 1u);
    for (std::int32_t j = 0; j < kSide; ++j) rows[j] = j < link.rows ? rows[j] & columns : std::uint16_t{0};
    front.extent[t] = extentOf(rows, link);
  });
}

void FaceField::goOn(int layers) {
  const std::size_t count = tiles_->size();
  Crew::run(count >= kUsefulTiles, [&](Crew& crew) {
    for (int layer = 0; layer < layers; ++layer) {
      for (const auto step : {&FaceField::findLayer, &FaceField::takeLayer}) {
        crew.stage(count, kFrontBlock, [&](std::size_t begin, std::size_t end) {
          for (Front& front : fronts_) {
            for (std::size_t t = begin + 1; t <= end; ++t) (this->*step)(front, t);
          }
        });
      }
    }
  });
}

void FaceField::findLayer(Front& front, std::size_t t) const {
  const TileLinks& link = links_[t];
  front.moves[t] = 0;
  if (front.extent[t] == kAll) return;
  auto beside = [&](std::uint32_t place) { return front.extent[place / kCells] != kNothing; };
  if (front.extent[t] == kNothing && !beside(link.left) && !beside(link.right) && !beside(link.down) &&
      !beside(link.up)) {
    return;
  }
  FrontRows rows;
  if (!findFront(front.known.data(), link, t, rows)) return;
  front.moves[t] = 1;
  std::copy_n(rows.fresh, kSide, front.fresh.data() + t * kSide);
  frontLoops(simd_).means(front.values, link, rows, t, front.next.data());
}

void FaceField::takeLayer(Front& front, std::size_t t) const {
  if (front.moves[t] == 0) return;
  const std::uint16_t* fresh = front.fresh.data() + t * kSide;
  frontLoops(simd_).take(front.next.data(), fresh, t, front.values, front.reached);
  std::uint16_t* rows = front.known.data() + t * kSide;
  for (std::int32_t j = 0; j < kSide; ++j) rows[j] = static_cast<std::uint16_t>(rows[j] | fresh[j]);
  front.extent[t] = extentOf(rows, links_[t]);
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
  std::size_t bytes = sums_.capacity() * sizeof(TileSums) + sumsOf_.capacity() * sizeof(std::uint32_t) +
                      15 * node.capacity() * sizeof(float) + links_.capacity() * sizeof(TileLinks);
  for (const Front& front : fronts_) {
    bytes += (front.known.capacity() + front.fresh.capacity()) * sizeof(std::uint16_t) + front.extent.capacity() +
             front.moves.capacity() + front.next.capacity() * sizeof(float);
  }
  return bytes;
}

}  // namespace froude
