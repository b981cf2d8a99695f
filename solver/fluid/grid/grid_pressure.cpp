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
constexpr float kNearest = 0.1f;     // of a cell: the free surface is taken to be at least so far from a cell's middle
constexpr double kTolerance = 1e-3;  // share of a cell
constexpr double kRelative = 1e-2;   // of what flows or falls in a sub-step: short ones would not feel their floor
constexpr float kEvenTolerance = 1e-2f;
constexpr int kMostIterations = 60;
// Of what is over-full, taken back in a step, and at most of a cell; of what is lacking inside.
constexpr float kShare = 1.0f, kMostShare = 0.5f, kLackShare = 0.2f;

void forEachTile(const TileGrid& tiles, FunctionRef<void(std::size_t)> visit) {
  parallelFor(tiles.size(), kTileBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin + 1; t <= end; ++t) visit(t);
  });
}

bool isInTile(const CutCell& cell, const Tile& tile) { return cell.i >> 4 == tile.at.x && cell.j >> 4 == tile.at.y; }

}  // namespace

void GridPressure::begin(const CutGrid& grid, const CutCells& cuts, std::span<const Vec2> centers,
                         const ParticleTiles& particles, double full, const FreeBodies* bodies, FaceField& faces) {
  grid_ = grid;
  centers_.assign(centers.begin(), centers.end());
  cuts_ = &cuts;
  tiles_ = &particles.tiles();
  for (AlignedArray<float>* field : {&value_, &right_, &shift_, &area_, &density_, &steepX_, &steepY_})
    tiles_->fit(*field);
  tiles_->fit(kind_);
  wet_.resize(tiles_->size() + 1);
  forEachTile(*tiles_, [&](std::size_t t) { fillTile(t, faces); });
  listCutCells();
  findOpenings(faces);
  open_ = {faces.x.open.data(), faces.y.open.data()};
  findDensity(full, faces);
  findFluid(faces);
  findSurface(faces);
  findWalls(bodies);
}

// What is not listed is open or solid as the cells beside it are that are not listed either.
void GridPressure::fillTile(std::size_t t, FaceField& faces) {
  const Tile& tile = tiles_->tile(t);
  const std::span<const CutCell> cells = cuts_->cells();
  std::size_t next = cuts_->tileBegin(tile.at.x, tile.at.y);
  const std::size_t at = t * kCells;
  for (AlignedArray<float>* field : {&value_, &right_, &shift_}) std::fill_n(field->data() + at, kCells, 0.0f);
  auto fill = [&](std::size_t place, std::size_t count, bool solid) {
    std::fill_n(kind_.data() + place, count, solid ? GridCell::Solid : GridCell::Air);
    for (AlignedArray<float>* field : {&area_, &faces.x.open, &faces.y.open}) {
      std::fill_n(field->data() + place, count, solid ? 0.0f : 1.0f);
    }
  };
  const bool whole = tile.rows == kSide && tile.columns == kSide;
  if (whole && (next == cells.size() || !isInTile(cells[next], tile))) {
    fill(at, kCells, cuts_->solid(tile.at.x * kSide, tile.at.y * kSide));
    return;
  }
  if (!whole) {
    fill(at, kCells, true);
    std::fill_n(kind_.data() + at, kCells, GridCell::Air);
  }
  std::array<std::int8_t, kSide> above;  // of the row before: 0 open, 1 solid, −1 listed
  above.fill(-1);
  for (std::int32_t j = 0; j < tile.rows; ++j) {
    std::int8_t before = -1;
    for (std::int32_t i = 0; i < tile.columns; ++i) {
      const std::int32_t cellI = tile.at.x * kSide + i, cellJ = tile.at.y * kSide + j;
      bool solid = false;
      if (next < cells.size() && cells[next].i == cellI && cells[next].j == cellJ) {
        solid = cells[next].partCount == 0;
        ++next;
        before = above[static_cast<std::size_t>(i)] = -1;
      } else {
        if (before < 0) before = above[static_cast<std::size_t>(i)];
        if (before < 0) before = cuts_->solid(cellI, cellJ) ? 1 : 0;
        above[static_cast<std::size_t>(i)] = before;
        solid = before > 0;
      }
      fill(at + static_cast<std::size_t>(j * kSide + i), 1, solid);
    }
  }
}

void GridPressure::listCutCells() {
  listed_.clear();
  partial_.assign(tiles_->size() + 1, 0);
  const std::span<const CutCell> cells = cuts_->cells();
  for (std::size_t t = 1; t <= tiles_->size(); ++t) {
    const Tile& tile = tiles_->tile(t);
    for (std::size_t next = cuts_->tileBegin(tile.at.x, tile.at.y); next < cells.size() && isInTile(cells[next], tile);
         ++next) {
      const std::int32_t i = cells[next].i - tile.at.x * kSide, j = cells[next].j - tile.at.y * kSide;
      if (i >= tile.columns || j >= tile.rows) continue;
      const std::size_t place = t * kCells + static_cast<std::size_t>(j * kSide + i);
      listed_.push_back({static_cast<std::uint32_t>(next), static_cast<std::uint32_t>(place)});
    }
  }
}

void GridPressure::findOpenings(FaceField& faces) {
  for (const Listed& l : listed_) {
    const CutCell& cell = cuts_->cells()[l.cut];
    double area = 0.0;
    for (std::uint32_t p = cell.part; p < cell.part + cell.partCount; ++p) area += cuts_->parts()[p].area;
    area_[l.place] = static_cast<float>(area);
    if (area_[l.place] > 0.0f && area_[l.place] < 1.0f) {
      const Tile& tile = tiles_->tile(l.place / kCells);
      partial_[l.place / kCells] = 1;
      for (const std::uint32_t beside :
           {tile.left, tile.right, tile.down, tile.up, tile.downLeft, tile.downRight, tile.upLeft, tile.upRight}) {
        partial_[beside] = 1;
      }
    }
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
    float* density = density_.data() + t * kCells;
    for (std::int32_t j = 0; j < kSide; ++j) {
      const float *n = node.row(j), *above = node.row(j + 1);
      const float *down = area.row(j - 1), *here = area.row(j), *up = area.row(j + 1);
      float row[kSide];
      for (std::int32_t i = 0; i < kSide; ++i) {
        const float held = (n[i] + n[i + 1]) + (above[i] + above[i + 1]);
        auto across = [i](const float* r) { return (r[i - 1] + r[i + 1]) + 2.0f * r[i]; };
        const float room = quarter * ((across(down) + across(up)) + 2.0f * across(here));
        row[i] = held / (room > 0.0f ? room : 1.0f);
      }
      const GridCell* kind = kind_.data() + t * kCells + j * kSide;
      for (std::int32_t i = 0; i < kSide; ++i) density[j * kSide + i] = kind[i] == GridCell::Solid ? 0.0f : row[i];
    }
  });
}

// Where a wall cuts a cell, particles stay off the corners of what is open: cells around it are asked too, or water
// along a wall would have holes without pressure.
void GridPressure::findFluid(const FaceField& faces) {
  forEachTile(*tiles_, [&](std::size_t t) {
    wet_[t] = 0;
    const float* own = density_.data() + t * kCells;
    float most = 0.0f;
    for (std::size_t c = 0; c < kCells; ++c) most = std::max(most, own[c]);
    if (most < kSurface && partial_[t] == 0) return;
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
        if (filled < kSurface || !reached) continue;
        kind_[place] = GridCell::Fluid;
        wet_[t] = 1;
      }
    }
  });
}

// Where density passes a half between a cell of fluid and one of air: F. Gibou et al., J. Comput. Phys. 176, 2002.
void GridPressure::findSurface(FaceField& faces) {
  coefficients_.fromWeights(*tiles_, kind_.data(), faces.x.open.data(), faces.y.open.data());
  forEachTile(*tiles_, [&](std::size_t t) {
    std::fill_n(steepX_.data() + t * kCells, kCells, 1.0f);
    std::fill_n(steepY_.data() + t * kCells, kCells, 1.0f);
    const Tile& tile = tiles_->tile(t);
    if (wet_[t] == 0 && wet_[tile.left] == 0 && wet_[tile.down] == 0) return;
    TileHalo density;
    tiles_->loadHalo(density_.data(), t, density);
    for (std::int32_t j = 0; j < tile.rows; ++j) {
      for (std::int32_t i = 0; i < tile.columns; ++i) {
        const std::size_t place = t * kCells + static_cast<std::size_t>(j * kSide + i);
        auto face = [&](FaceComponent& c, AlignedArray<float>& steep, std::size_t beside, float besideDensity) {
          if (c.open[place] == 0.0f) return;
          const bool here = kind_[place] == GridCell::Fluid, there = kind_[beside] == GridCell::Fluid;
          if (here || there) c.solved[place] = 1.0f;
          if (here == there) return;
          const float in = here ? density.value(i, j) : besideDensity, out = here ? besideDensity : density.value(i, j);
          const float way = out < kSurface ? std::max(kNearest, (in - kSurface) / (in - out)) : 1.0f;
          steep[place] = 1.0f / way;
        };
        const std::size_t left =
            i > 0 ? place - 1
                  : tile.left * kCells + static_cast<std::size_t>(j * kSide + tiles_->tile(tile.left).columns - 1);
        const std::size_t down =
            j > 0 ? place - kSide
                  : tile.down * kCells + static_cast<std::size_t>((tiles_->tile(tile.down).rows - 1) * kSide + i);
        face(faces.x, steepX_, left, density.value(i - 1, j));
        face(faces.y, steepY_, down, density.value(i, j - 1));
      }
    }
  });
  groundSurface(faces);
}

// What the steepness of its free faces adds to a cell's ground.
void GridPressure::groundSurface(const FaceField& faces) {
  forEachTile(*tiles_, [&](std::size_t t) {
    if (wet_[t] == 0) return;
    const Tile& tile = tiles_->tile(t);
    for (std::int32_t j = 0; j < tile.rows; ++j) {
      for (std::int32_t i = 0; i < tile.columns; ++i) {
        const std::size_t place = t * kCells + static_cast<std::size_t>(j * kSide + i);
        if (kind_[place] != GridCell::Fluid || coefficients_.ground[place] == 0.0f) continue;
        const std::size_t right =
            i + 1 < tile.columns ? place + 1 : tile.right * kCells + static_cast<std::size_t>(j * kSide);
        const std::size_t up = j + 1 < tile.rows ? place + kSide : tile.up * kCells + static_cast<std::size_t>(i);
        // Between two cells of fluid the steepness is 1.
        const float more =
            (faces.x.open[place] * (steepX_[place] - 1.0f) + faces.x.open[right] * (steepX_[right] - 1.0f)) +
            (faces.y.open[place] * (steepY_[place] - 1.0f) + faces.y.open[up] * (steepY_[up] - 1.0f));
        coefficients_.addGround(place, static_cast<double>(more));
      }
    }
  });
}

// The pressure of a cell is that of its middle; to the wall it goes on as it does between the cell and those of fluid
// beside it, or what lies between there and the wall would be weightless.
// Free bodies feel that of the middle: what pushes them is what they push, and with the far side of a thin layer in it
// layers that they press out were flung.
void GridPressure::findWalls(const FreeBodies* bodies) {
  walls_.clear();
  for (const Listed& l : listed_) {
    if (kind_[l.place] != GridCell::Fluid) continue;
    const CutCell& cell = cuts_->cells()[l.cut];
    const CutPart& part = cuts_->parts()[cell.part];
    const std::size_t right = tiles_->place(cell.i + 1, cell.j), up = tiles_->place(cell.i, cell.j + 1);
    const std::size_t beside[2][2] = {{tiles_->place(cell.i - 1, cell.j), right},
                                      {tiles_->place(cell.i, cell.j - 1), up}};
    const float open[2][2] = {{open_[0][l.place], right >= kCells ? open_[0][right] : 0.0f},
                              {open_[1][l.place], up >= kCells ? open_[1][up] : 0.0f}};
    for (std::uint32_t w = part.wall; w < part.wall + part.wallCount; ++w) {
      const CutWall& wall = cuts_->walls()[w];
      const double square = wall.normal.squaredNorm();
      if (square == 0.0) continue;
      const Vec2 center = wall.body < 0 ? grid_.origin : centers_[static_cast<std::size_t>(wall.body)];
      Wall found{
          w, static_cast<std::uint32_t>(l.place), center, center + wall.moment / square * rightNormal(wall.normal), {}};
      const bool free = bodies != nullptr && bodies->isFree(wall.body);
      Vec2 normal = wall.normal;
      double moment = wall.moment;
      for (int axis = 0; axis < 2; ++axis) {
        bool wet[2];
        for (int side = 0; side < 2; ++side) {
          wet[side] = open[axis][side] > 0.0f && kind_[beside[axis][side]] == GridCell::Fluid;
        }
        const double share = wet[0] && wet[1] ? 0.5 : 1.0;
        for (int side = 0; side < 2; ++side) {
          if (!wet[side] || free) continue;
          const double outwards = side == 0 ? -share : share;
          const Vec2 more = outwards * wall.spread.row(axis).transpose();
          const double turn = outwards * (wall.middle[axis] - 0.5) * wall.moment;
          found.pressure.add(beside[axis][side], more, turn);
          normal -= more;
          moment -= turn;
        }
      }
      found.pressure.add(l.place, normal, moment);
      walls_.push_back(found);
    }
  }
}

// The share of each cell that would flow out in the step, less what walls push in.
void GridPressure::findDivergence(const StepContext& context, const FaceField& faces) {
  const auto perSize = static_cast<float>(dt_ / grid_.size);
  forEachTile(*tiles_, [&](std::size_t t) {
    if (wet_[t] == 0) return;
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
  for (const Wall& w : walls_) {
    const CutWall& wall = cuts_->walls()[w.wall];
    if (!bodies_.isFree(wall.body)) {
      const double in = context.obstacles.velocityAt(wall.body, w.at).dot(wall.normal);
      right_[w.place] += static_cast<float>(dt_ / grid_.size * in);
      continue;
    }
    for (const WallPressure::Share& share : w.pressure.shares()) {
      right_[share.place] += static_cast<float>(dt_ / grid_.size * bodies_.add(wall.body, share));
    }
  }
}

PressureReport GridPressure::project(const StepContext& context, double density, FaceField& faces,
                                     std::span<const Wrench> drag) {
  const PressureReport report = solve(context, density, faces, drag);
  bodies_.settle(value_.data());
  return report;
}

PressureReport GridPressure::foresee(const StepContext& context, double density, FaceField& faces) {
  return solve(context, density, faces, {});
}

PressureReport GridPressure::solve(const StepContext& context, double density, FaceField& faces,
                                   std::span<const Wrench> drag) {
  dt_ = context.dt;
  bodies_.begin(context.freeBodies, density, grid_.size, dt_, drag);
  findDivergence(context, faces);
  if (!system_) system_.emplace(context.simd);
  system_->prepare(*tiles_, coefficients_, bodies_.system());
  const double way = dt_ * std::max(context.maxSpeed, dt_ * context.acceleration) / grid_.size;
  const auto tolerance = static_cast<float>(std::min(kTolerance, kRelative * way));
  const PressureReport report = system_->solve(right_.data(), value_.data(), {tolerance, kMostIterations});
  const auto speed = static_cast<float>(grid_.size / dt_);
  findJumps(value_, speed, faces.x.solved.data(), faces.y.solved.data(), faces.x.change.data(), faces.y.change.data());
  forEachTile(*tiles_, [&](std::size_t t) {
    for (FaceComponent* c : {&faces.x, &faces.y}) {
      for (std::size_t place = t * kCells; place < (t + 1) * kCells; ++place) c->value[place] += c->change[place];
    }
  });
  return report;
}

// Where walls cut cells the room is known less well, and a lack that is none would draw particles in for ever.
void GridPressure::findExcess(std::size_t t) {
  float* right = right_.data() + t * kCells;
  std::fill_n(right, kCells, 0.0f);
  if (wet_[t] == 0) return;
  const float *density = density_.data() + t * kCells, *ground = coefficients_.ground.data() + t * kCells;
  const GridCell* kind = kind_.data() + t * kCells;
  std::array<float, kCells> share;  // of a lack, taken back
  for (std::size_t c = 0; c < kCells; ++c) share[c] = ground[c] == 0.0f ? kLackShare : 0.0f;
  if (partial_[t] != 0) {
    TileHalo area;
    tiles_->loadHalo(area_.data(), t, area);
    for (std::int32_t j = 0; j < kSide; ++j) {
      for (std::int32_t i = 0; i < kSide; ++i) {
        bool exact = true;
        for (std::int32_t r = j - 1; r <= j + 1; ++r) {
          for (std::int32_t a = i - 1; a <= i + 1; ++a)
            exact = exact && (area.value(a, r) == 0.0f || area.value(a, r) == 1.0f);
        }
        if (!exact) share[static_cast<std::size_t>(j * kSide + i)] = 0.0f;
      }
    }
  }
  for (std::size_t c = 0; c < kCells; ++c) {
    const float excess = density[c] - 1.0f;
    const float back = excess > 0.0f ? kShare * std::min(excess, kMostShare) : share[c] * excess;
    right[c] = kind[c] == GridCell::Fluid ? back : 0.0f;
  }
}

PressureReport GridPressure::evenOut(FaceField& faces) {
  forEachTile(*tiles_, [&](std::size_t t) { findExcess(t); });
  const PressureReport report = system_->solve(right_.data(), shift_.data(), {kEvenTolerance, kMostIterations});
  findJumps(shift_, static_cast<float>(grid_.size / dt_), faces.x.solved.data(), faces.y.solved.data(),
            faces.x.shift.data(), faces.y.shift.data());
  return report;
}

// What the jump of κ over each face on which it acts changes there.
void GridPressure::findJumps(const AlignedArray<float>& kappa, float speed, const float* solvedX, const float* solvedY,
                             float* changeX, float* changeY) const {
  forEachTile(*tiles_, [&](std::size_t t) {
    const Tile& tile = tiles_->tile(t);
    if (wet_[t] == 0 && wet_[tile.left] == 0 && wet_[tile.down] == 0) return;
    TileHalo halo;
    tiles_->loadHalo(kappa.data(), t, halo);
    for (std::int32_t j = 0; j < kSide; ++j) {
      const float *k = halo.row(j), *below = halo.row(j - 1);
      const std::size_t at = t * kCells + static_cast<std::size_t>(j * kSide);
      auto row = [&](const float* solved, const AlignedArray<float>& steep, const float* before, float* change) {
        float out[kSide];
        for (std::int32_t i = 0; i < kSide; ++i) {
          const auto place = at + static_cast<std::size_t>(i);
          const float jump = steep[place] * (before[i] - k[i]);
          out[i] = solved[place] > 0.0f ? speed * jump : 0.0f;
        }
        std::copy_n(out, kSide, change + at);
      };
      row(solvedX, steepX_, k - 1, changeX);
      row(solvedY, steepY_, below, changeY);
    }
  });
}

// Over the cell and those around it: single cells are over-full for a step or two wherever drops meet.
std::array<double, 3> GridPressure::compression() const {
  struct Part {
    double most = 0.0, sum = 0.0, count = 0.0, held = 0.0, room = 0.0;
  };
  const Part all = reduceBlocks<Part>(
      kCells * tiles_->size(), {},  // blocks are of whole tiles
      [&](std::size_t begin, std::size_t end) {
        Part part;
        for (std::size_t t = begin / kCells + 1; t <= end / kCells; ++t) {
          if (wet_[t] == 0) continue;
          TileHalo density, area;
          tiles_->loadHalo(density_.data(), t, density);
          tiles_->loadHalo(area_.data(), t, area);
          for (std::int32_t j = 0; j < kSide; ++j) {
            float held[kSide + 2], room[kSide + 2], excess[kSide];  // of three cells above each other
            for (std::int32_t i = -1; i <= kSide; ++i) {
              auto of = [&](std::int32_t r) { return density.row(r)[i] * area.row(r)[i]; };
              held[i + 1] = (of(j - 1) + of(j + 1)) + of(j);
              room[i + 1] = (area.row(j - 1)[i] + area.row(j + 1)[i]) + area.row(j)[i];
            }
            for (std::int32_t i = 0; i < kSide; ++i) {
              const float whole = (room[i] + room[i + 2]) + room[i + 1];
              excess[i] = ((held[i] + held[i + 2]) + held[i + 1]) / (whole > 0.0f ? whole : 1.0f) - 1.0f;
            }
            for (std::int32_t i = 0; i < kSide; ++i) {
              if (kind_[t * kCells + static_cast<std::size_t>(j * kSide + i)] != GridCell::Fluid) continue;
              const double beyond = std::max(0.0, static_cast<double>(excess[i]));
              part.most = std::max(part.most, beyond);
              part.sum += beyond;
              ++part.count;
              part.held += static_cast<double>(density.value(i, j) * area.value(i, j));
              part.room += static_cast<double>(area.value(i, j));
            }
          }
        }
        return part;
      },
      [](const Part& x, const Part& y) {
        return Part{std::max(x.most, y.most), x.sum + y.sum, x.count + y.count, x.held + y.held, x.room + y.room};
      });
  if (all.count == 0.0) return {0.0, 0.0, 0.0};
  return {all.most, all.sum / all.count, all.held / all.room - 1.0};
}

std::size_t GridPressure::memoryBytes() const {
  return kind_.capacity() + (7 * value_.capacity()) * sizeof(float) + listed_.capacity() * sizeof(Listed);
}

}  // namespace froude
