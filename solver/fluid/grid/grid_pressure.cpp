#include <froude/solver/fluid/grid/grid_pressure.h>

#include <algorithm>
#include <array>

#include <froude/base/parallel.h>

namespace froude {
namespace {

constexpr std::int32_t kSide = TileGrid::kSide;
constexpr std::size_t kCells = TileGrid::kCells;
constexpr std::size_t kTileBlock = 4;  // tiles a task
constexpr float kSurface = 0.5f;       // density at the free surface
constexpr float kNearest = 0.1f;  // of a cell: the free surface is taken to be at least so far from a cell's middle
constexpr float kTolerance = 1e-3f, kEvenTolerance = 1e-2f;  // share of a cell
constexpr int kMostIterations = 60;
// Of what is over-full, taken back in a step, and at most of a cell; of what is lacking inside.
constexpr float kShare = 1.0f, kMostShare = 0.5f, kLackShare = 0.2f;

void forEachTile(const TileGrid& tiles, FunctionRef<void(std::size_t)> visit) {
  parallelFor(tiles.size(), kTileBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin + 1; t <= end; ++t) visit(t);
  });
}

}  // namespace

void GridPressure::begin(const CutGrid& grid, const CutCells& cuts, std::span<const Vec2> centers,
                         const ParticleTiles& particles, double full, FaceField& faces) {
  grid_ = grid;
  centers_.assign(centers.begin(), centers.end());
  cuts_ = &cuts;
  tiles_ = &particles.tiles();
  tiles_->clear(kind_);
  tiles_->clear(value_);
  tiles_->clear(right_);
  tiles_->clear(shift_);
  tiles_->clear(area_);
  tiles_->clear(density_);
  tiles_->clear(steepX_);
  tiles_->clear(steepY_);
  listed_.clear();
  for (std::size_t t = 1; t <= tiles_->size(); ++t) fillTile(t, faces);
  findOpenings(faces);
  open_ = {faces.x.open.data(), faces.y.open.data()};
  findDensity(full, faces);
  findFluid(faces);
  findSurface(faces);
}

// What is not listed is open or solid as the cells beside it are that are not listed either.
void GridPressure::fillTile(std::size_t t, FaceField& faces) {
  const Tile& tile = tiles_->tile(t);
  const std::span<const CutCell> cells = cuts_->cells();
  std::size_t next = cuts_->tileBegin(tile.at.x, tile.at.y);
  const std::size_t at = t * kCells;
  std::array<std::int8_t, kSide> above;  // of the row before: 0 open, 1 solid, −1 listed
  above.fill(-1);
  for (std::int32_t j = 0; j < tile.rows; ++j) {
    std::int8_t before = -1;
    for (std::int32_t i = 0; i < tile.columns; ++i) {
      const std::int32_t cellI = tile.at.x * kSide + i, cellJ = tile.at.y * kSide + j;
      const std::size_t place = at + static_cast<std::size_t>(j * kSide + i);
      bool solid = false;
      if (next < cells.size() && cells[next].i == cellI && cells[next].j == cellJ) {
        solid = cells[next].partCount == 0;
        listed_.push_back({static_cast<std::uint32_t>(next), static_cast<std::uint32_t>(place)});
        ++next;
        before = above[static_cast<std::size_t>(i)] = -1;
      } else {
        if (before < 0) before = above[static_cast<std::size_t>(i)];
        if (before < 0) before = cuts_->solid(cellI, cellJ) ? 1 : 0;
        above[static_cast<std::size_t>(i)] = before;
        solid = before > 0;
      }
      kind_[place] = solid ? GridCell::Solid : GridCell::Air;
      area_[place] = solid ? 0.0f : 1.0f;
      faces.x.open[place] = faces.y.open[place] = solid ? 0.0f : 1.0f;
    }
  }
}

void GridPressure::findOpenings(FaceField& faces) {
  for (const Listed& l : listed_) {
    const CutCell& cell = cuts_->cells()[l.cut];
    double area = 0.0;
    for (std::uint32_t p = cell.part; p < cell.part + cell.partCount; ++p) area += cuts_->parts()[p].area;
    area_[l.place] = static_cast<float>(area);
    faces.x.open[l.place] = static_cast<float>(cell.open[0]);
    faces.y.open[l.place] = static_cast<float>(cell.open[2]);
    auto beyond = [&](std::int32_t i, std::int32_t j) {
      if (grid_.periodX > 0 && i == grid_.periodX) i = 0;
      if (grid_.periodY > 0 && j == grid_.periodY) j = 0;
      return tiles_->place(i, j);
    };
    const std::size_t right = beyond(cell.i + 1, cell.j), up = beyond(cell.i, cell.j + 1);
    if (right >= kCells) faces.x.open[right] = static_cast<float>(cell.open[1]);
    if (up >= kCells) faces.y.open[up] = static_cast<float>(cell.open[3]);
  }
}

// Tents around the corners of a cell, together: what particles fill of what is open there.
void GridPressure::findDensity(double full, const FaceField& faces) {
  const auto quarter = static_cast<float>(0.25 * full);
  forEachTile(*tiles_, [&](std::size_t t) {
    TileHalo node, area;
    tiles_->loadHalo(faces.node.data(), t, node);
    tiles_->loadHalo(area_.data(), t, area);
    for (std::int32_t j = 0; j < kSide; ++j) {
      for (std::int32_t i = 0; i < kSide; ++i) {
        const std::size_t place = t * kCells + static_cast<std::size_t>(j * kSide + i);
        if (kind_[place] == GridCell::Solid) continue;
        const float held =
            (node.value(i, j) + node.value(i + 1, j)) + (node.value(i, j + 1) + node.value(i + 1, j + 1));
        auto row = [&](std::int32_t r) {
          return (area.value(i - 1, r) + area.value(i + 1, r)) + 2.0f * area.value(i, r);
        };
        const float room = quarter * ((row(j - 1) + row(j + 1)) + 2.0f * row(j));
        density_[place] = held / room;
      }
    }
  });
}

// Where a wall cuts a cell, particles stay off the corners of what is open: cells around it are asked too, or water
// along a wall would have holes without pressure.
void GridPressure::findFluid(const FaceField& faces) {
  forEachTile(*tiles_, [&](std::size_t t) {
    TileHalo density, area, knownX, knownY;
    tiles_->loadHalo(density_.data(), t, density);
    tiles_->loadHalo(area_.data(), t, area);
    tiles_->loadHalo(faces.x.known.data(), t, knownX);
    tiles_->loadHalo(faces.y.known.data(), t, knownY);
    for (std::int32_t j = 0; j < kSide; ++j) {
      for (std::int32_t i = 0; i < kSide; ++i) {
        const std::size_t place = t * kCells + static_cast<std::size_t>(j * kSide + i);
        if (kind_[place] == GridCell::Solid) continue;
        float filled = density.value(i, j);
        if (area.value(i, j) < 1.0f) {
          float held = 0.0f, room = 0.0f;
          for (std::int32_t b = j - 1; b <= j + 1; ++b) {
            for (std::int32_t a = i - 1; a <= i + 1; ++a) {
              held += std::min(1.0f, density.value(a, b)) * area.value(a, b);
              room += area.value(a, b);
            }
          }
          filled = std::max(filled, held / room);
        }
        const bool reached =
            knownX.value(i, j) + knownX.value(i + 1, j) + knownY.value(i, j) + knownY.value(i, j + 1) == 4.0f;
        if (filled >= kSurface && reached) kind_[place] = GridCell::Fluid;
      }
    }
  });
}

// Where density passes a half between a cell of fluid and one of air: F. Gibou et al., J. Comput. Phys. 176, 2002.
void GridPressure::findSurface(const FaceField& faces) {
  coefficients_.fromWeights(*tiles_, kind_.data(), faces.x.open.data(), faces.y.open.data());
  for (std::size_t t = 1; t <= tiles_->size(); ++t) {
    TileHalo density;
    tiles_->loadHalo(density_.data(), t, density);
    const Tile& tile = tiles_->tile(t);
    for (std::int32_t j = 0; j < tile.rows; ++j) {
      for (std::int32_t i = 0; i < tile.columns; ++i) {
        const std::size_t place = t * kCells + static_cast<std::size_t>(j * kSide + i);
        auto face = [&](AlignedArray<float>& steep, const AlignedArray<float>& open, std::size_t beside,
                        float besideDensity) {
          steep[place] = 1.0f;
          if (open[place] == 0.0f) return;
          const bool here = kind_[place] == GridCell::Fluid, there = kind_[beside] == GridCell::Fluid;
          if (here == there) return;
          const float in = here ? density.value(i, j) : besideDensity, out = here ? besideDensity : density.value(i, j);
          const float way = out < kSurface ? std::max(kNearest, (in - kSurface) / (in - out)) : 1.0f;
          steep[place] = 1.0f / way;
          coefficients_.addGround(here ? place : beside, static_cast<double>(open[place] * (steep[place] - 1.0f)));
        };
        const std::size_t left =
            i > 0 ? place - 1
                  : tile.left * kCells + static_cast<std::size_t>(j * kSide + tiles_->tile(tile.left).columns - 1);
        const std::size_t down =
            j > 0 ? place - kSide
                  : tile.down * kCells + static_cast<std::size_t>((tiles_->tile(tile.down).rows - 1) * kSide + i);
        face(steepX_, faces.x.open, left, density.value(i - 1, j));
        face(steepY_, faces.y.open, down, density.value(i, j - 1));
      }
    }
  }
}

// The share of each cell that would flow out in the step, less what walls push in.
void GridPressure::findDivergence(const StepContext& context, const FaceField& faces) {
  const auto perSize = static_cast<float>(dt_ / grid_.size);
  forEachTile(*tiles_, [&](std::size_t t) {
    TileHalo u, v, openX, openY;
    tiles_->loadHalo(faces.x.value.data(), t, u);
    tiles_->loadHalo(faces.y.value.data(), t, v);
    tiles_->loadHalo(faces.x.open.data(), t, openX);
    tiles_->loadHalo(faces.y.open.data(), t, openY);
    for (std::int32_t j = 0; j < kSide; ++j) {
      for (std::int32_t i = 0; i < kSide; ++i) {
        const std::size_t place = t * kCells + static_cast<std::size_t>(j * kSide + i);
        if (kind_[place] != GridCell::Fluid) continue;
        const float out = (openX.value(i + 1, j) * u.value(i + 1, j) - openX.value(i, j) * u.value(i, j)) +
                          (openY.value(i, j + 1) * v.value(i, j + 1) - openY.value(i, j) * v.value(i, j));
        right_[place] = -perSize * out;
      }
    }
  });
  forEachWall(1.0, [&](const CutWall& wall, const Vec2&, const Vec2& at, std::size_t place) {
    const double in = bodies_.isFree(wall.body) ? bodies_.add(wall, static_cast<std::uint32_t>(place))
                                                : context.obstacles.velocityAt(wall.body, at).dot(wall.normal);
    right_[place] += static_cast<float>(dt_ / grid_.size * in);
  });
}

PressureReport GridPressure::project(const StepContext& context, double density, FaceField& faces) {
  dt_ = context.dt;
  bodies_.begin(context.freeBodies, density, grid_.size, dt_);
  findDivergence(context, faces);
  if (!system_) system_.emplace(context.simd);
  system_->prepare(*tiles_, coefficients_, bodies_.system());
  const PressureReport report = system_->solve(right_.data(), value_.data(), {kTolerance, kMostIterations});
  bodies_.settle(value_.data());
  const auto speed = static_cast<float>(grid_.size / dt_);
  forEachJump(value_, [&](int axis, std::size_t place, float jump) {
    FaceComponent& c = axis == 0 ? faces.x : faces.y;
    c.change[place] = speed * jump;
    c.solved[place] = 1.0f;
    c.value[place] += c.change[place];
  });
  return report;
}

PressureReport GridPressure::evenOut(FaceField& faces) {
  forEachTile(*tiles_, [&](std::size_t t) {
    TileHalo density, area;
    tiles_->loadHalo(density_.data(), t, density);
    tiles_->loadHalo(area_.data(), t, area);
    for (std::int32_t j = 0; j < kSide; ++j) {
      for (std::int32_t i = 0; i < kSide; ++i) {
        const std::size_t place = t * kCells + static_cast<std::size_t>(j * kSide + i);
        right_[place] = 0.0f;
        if (kind_[place] != GridCell::Fluid) continue;
        // Where walls cut cells the room is known less well, and a lack that is none would draw particles in for ever.
        bool exact = true;
        for (std::int32_t r = j - 1; r <= j + 1; ++r) {
          for (std::int32_t a = i - 1; a <= i + 1; ++a)
            exact = exact && (area.value(a, r) == 0.0f || area.value(a, r) == 1.0f);
        }
        const bool inside = coefficients_.ground[place] == 0.0f && exact;
        const float excess = density.value(i, j) - 1.0f;
        right_[place] = excess > 0.0f ? kShare * std::min(excess, kMostShare) : inside ? kLackShare * excess : 0.0f;
      }
    }
  });
  const PressureReport report = system_->solve(right_.data(), shift_.data(), {kEvenTolerance, kMostIterations});
  const auto speed = static_cast<float>(grid_.size / dt_);
  forEachJump(shift_, [&](int axis, std::size_t place, float jump) {
    FaceComponent& c = axis == 0 ? faces.x : faces.y;
    c.shift[place] = speed * jump;
  });
  return report;
}

template <typename Visit>
void GridPressure::forEachJump(const AlignedArray<float>& kappa, Visit&& visit) const {
  forEachTile(*tiles_, [&](std::size_t t) {
    TileHalo k;
    tiles_->loadHalo(kappa.data(), t, k);
    const Tile& tile = tiles_->tile(t);
    const GridCell* own = kind_.data() + t * kCells;
    const GridCell* leftTile = kind_.data() + tile.left * kCells;
    const GridCell* downTile = kind_.data() + tile.down * kCells;
    const std::int32_t leftEnd = tiles_->tile(tile.left).columns - 1, downEnd = tiles_->tile(tile.down).rows - 1;
    for (std::int32_t j = 0; j < tile.rows; ++j) {
      for (std::int32_t i = 0; i < tile.columns; ++i) {
        const auto c = static_cast<std::size_t>(j * kSide + i);
        const std::size_t place = t * kCells + c;
        const GridCell left = i > 0 ? own[c - 1] : leftTile[j * kSide + leftEnd];
        const GridCell down = j > 0 ? own[c - kSide] : downTile[downEnd * kSide + i];
        const bool fluid = own[c] == GridCell::Fluid;
        if ((fluid || left == GridCell::Fluid) && open_[0][place] > 0.0f) {
          visit(0, place, steepX_[place] * (k.value(i - 1, j) - k.value(i, j)));
        }
        if ((fluid || down == GridCell::Fluid) && open_[1][place] > 0.0f) {
          visit(1, place, steepY_[place] * (k.value(i, j - 1) - k.value(i, j)));
        }
      }
    }
  });
}

// Over the cell and those around it: single cells are over-full for a step or two wherever drops meet.
std::array<double, 2> GridPressure::compression() const {
  struct Part {
    double most = 0.0, sum = 0.0, count = 0.0;
  };
  const Part all = reduceBlocks<Part>(
      tiles_->size(), {},
      [&](std::size_t begin, std::size_t end) {
        Part part;
        for (std::size_t t = begin + 1; t <= end; ++t) {
          TileHalo density, area;
          tiles_->loadHalo(density_.data(), t, density);
          tiles_->loadHalo(area_.data(), t, area);
          for (std::int32_t j = 0; j < kSide; ++j) {
            for (std::int32_t i = 0; i < kSide; ++i) {
              const std::size_t place = t * kCells + static_cast<std::size_t>(j * kSide + i);
              if (kind_[place] != GridCell::Fluid) continue;
              float held = 0.0f, room = 0.0f;
              for (std::int32_t b = j - 1; b <= j + 1; ++b) {
                for (std::int32_t a = i - 1; a <= i + 1; ++a) {
                  held += density.value(a, b) * area.value(a, b);
                  room += area.value(a, b);
                }
              }
              const double excess = std::max(0.0, static_cast<double>(held / room) - 1.0);
              part.most = std::max(part.most, excess);
              part.sum += excess;
              ++part.count;
            }
          }
        }
        return part;
      },
      [](const Part& x, const Part& y) {
        return Part{std::max(x.most, y.most), x.sum + y.sum, x.count + y.count};
      });
  return {all.most, all.count > 0.0 ? all.sum / all.count : 0.0};
}

std::size_t GridPressure::memoryBytes() const {
  return kind_.capacity() + (7 * value_.capacity()) * sizeof(float) + listed_.capacity() * sizeof(Listed);
}

}  // namespace froude
