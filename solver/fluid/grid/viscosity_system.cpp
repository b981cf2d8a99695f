#include <froude/solver/fluid/grid/viscosity_system.h>

#include <algorithm>
#include <cmath>

#include <froude/base/assert.h>
#include <froude/base/parallel.h>

namespace froude {
namespace {

constexpr std::size_t kTileBlock = 4;  // tiles a task
// A wall nearer to a face's centre than this counts as this far [cells]: slivers would stiffen the system and no more.
constexpr double kNearest = 0.125;

using Window = TileHalo;

}  // namespace

void ViscosityCoefficients::fromCells(const TileGrid& grid, const GridCell* kind, const float* area, const float* openX,
                                      const float* openY) {
  for (AlignedArray<float>* a : {&cell, &node, &massX, &massY, &groundX, &groundY, &wallX, &wallY}) grid.clear(*a);
  const auto eachCell = [&](auto&& body) {
    parallelFor(grid.size(), kTileBlock, [&](std::size_t begin, std::size_t end) {
      for (std::size_t t = begin + 1; t < end + 1; ++t) body(t);
    });
  };
  eachCell([&](std::size_t t) {
    for (std::size_t c = t * TileGrid::kCells; c < (t + 1) * TileGrid::kCells; ++c) {
      cell[c] = kind[c] == GridCell::Fluid ? area[c] : 0.0f;
    }
  });
  eachCell([&](std::size_t t) {
    Window around;
    grid.loadHalo(cell.data(), t, around);
    for (std::int32_t j = 0; j < grid.tile(t).rows; ++j) {
      for (std::int32_t i = 0; i < grid.tile(t).columns; ++i) {
        const std::size_t c = t * TileGrid::kCells + static_cast<std::size_t>(16 * j + i);
        const float own = around.value(i, j), left = around.value(i - 1, j), down = around.value(i, j - 1);
        massX[c] = openX[c] > 0.0f ? 0.5f * (own + left) : 0.0f;
        massY[c] = openY[c] > 0.0f ? 0.5f * (own + down) : 0.0f;
        node[c] = 0.25f * (own + left + down + around.value(i - 1, j - 1));
      }
    }
  });
  // A shear that misses one of its four velocities is that of a wall, or of the air.
  eachCell([&](std::size_t t) {
    Window x, y;
    grid.loadHalo(massX.data(), t, x);
    grid.loadHalo(massY.data(), t, y);
    for (std::int32_t j = 0; j < grid.tile(t).rows; ++j) {
      for (std::int32_t i = 0; i < grid.tile(t).columns; ++i) {
        const bool whole =
            x.value(i, j) > 0.0f && x.value(i, j - 1) > 0.0f && y.value(i, j) > 0.0f && y.value(i - 1, j) > 0.0f;
        if (!whole) node[t * TileGrid::kCells + static_cast<std::size_t>(16 * j + i)] = 0.0f;
      }
    }
  });
}

HeldFaces ViscosityCoefficients::addWall(const TileGrid& grid, const StickingWall& wall) {
  HeldFaces held;
  const auto [i, j] = grid.cell(wall.place);
  const auto add = [&](AlignedArray<float>& ground, AlignedArray<float>& moved, const AlignedArray<float>& mass,
                       const std::array<std::size_t, 2>& faces, const std::array<Vec2, 2>& centers,
                       std::size_t component) {
    const double along = 1.0 - wall.normal[static_cast<int>(component)] * wall.normal[static_cast<int>(component)];
    const int open = (mass[faces[0]] > 0.0f ? 1 : 0) + (mass[faces[1]] > 0.0f ? 1 : 0);
    for (std::size_t f = 0; f < 2; ++f) {
      if (!(mass[faces[f]] > 0.0f)) continue;
      const double distance = std::max(kNearest, std::abs(wall.normal.dot(centers[f] - wall.point)));
      const double g = wall.length * along / (open * distance);
      ground[faces[f]] += static_cast<float>(g);
      moved[faces[f]] += static_cast<float>(g * wall.velocity[static_cast<int>(component)]);
      held.face[held.count++] = {component, faces[f], g};
    }
  };
  // Only what slides along the wall is held by friction; towards it, pressure holds.
  add(groundX, wallX, massX, {wall.place, grid.place(i + 1, j)}, {Vec2(0.0, 0.5), Vec2(1.0, 0.5)}, 0);
  add(groundY, wallY, massY, {wall.place, grid.place(i, j + 1)}, {Vec2(0.5, 0.0), Vec2(0.5, 1.0)}, 1);
  return held;
}

// The derivative of the sums by each face's velocity: mass, and differences of the stresses beside it.
void ViscositySystem::applyTile(std::size_t t, const std::array<const float*, 2>& in,
                                const std::array<float*, 2>& out) {
  const ViscosityCoefficients& c = *coefficients_;
  Window u, v, cell, node, xx, yy, xy;
  grid_->loadHalo(in[0], t, u);
  grid_->loadHalo(in[1], t, v);
  grid_->loadHalo(c.cell.data(), t, cell);
  grid_->loadHalo(c.node.data(), t, node);
  const std::int32_t columns = grid_->tile(t).columns, rows = grid_->tile(t).rows;
  for (std::int32_t j = -1; j < rows; ++j) {
    float *toX = xx.row(j), *toY = yy.row(j);
    const float *area = cell.row(j), *uRow = u.row(j), *vRow = v.row(j), *vUp = v.row(j + 1);
    for (std::int32_t i = -1; i < columns; ++i) {
      toX[i] = 2.0f * k_ * area[i] * (uRow[i + 1] - uRow[i]);
      toY[i] = 2.0f * k_ * area[i] * (vUp[i] - vRow[i]);
    }
  }
  for (std::int32_t j = 0; j <= rows; ++j) {
    float* to = xy.row(j);
    const float *area = node.row(j), *uRow = u.row(j), *uDown = u.row(j - 1), *vRow = v.row(j);
    for (std::int32_t i = 0; i <= columns; ++i) {
      to[i] = k_ * area[i] * ((uRow[i] - uDown[i]) + (vRow[i] - vRow[i - 1]));
    }
  }
  for (std::int32_t j = 0; j < rows; ++j) {
    const std::size_t row = t * TileGrid::kCells + static_cast<std::size_t>(16 * j);
    const float *xxRow = xx.row(j), *yyRow = yy.row(j), *yyDown = yy.row(j - 1), *xyRow = xy.row(j),
                *xyUp = xy.row(j + 1);
    const float *uRow = u.row(j), *vRow = v.row(j);
    for (std::int32_t i = 0; i < columns; ++i) {
      const std::size_t at = row + static_cast<std::size_t>(i);
      const float forceX = (xxRow[i] - xxRow[i - 1]) + (xyUp[i] - xyRow[i]);
      const float forceY = (yyRow[i] - yyDown[i]) + (xyRow[i + 1] - xyRow[i]);
      out[0][at] = c.massX[at] > 0.0f ? (c.massX[at] + k_ * c.groundX[at]) * uRow[i] - forceX : 0.0f;
      out[1][at] = c.massY[at] > 0.0f ? (c.massY[at] + k_ * c.groundY[at]) * vRow[i] - forceY : 0.0f;
    }
  }
}

void ViscositySystem::apply(const float* u, const float* v, float* outU, float* outV) {
  parallelFor(grid_->size(), kTileBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin + 1; t < end + 1; ++t) applyTile(t, {u, v}, {outU, outV});
  });
  addBodies(u, v, 0.0, -1.0f, outU, outV);
}

Eigen::Vector3d ViscousBody::gained(const float* u, const float* v, double own) const {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Entry& e : entries) {
    sum += e.g * (static_cast<double>((e.component == 0 ? u : v)[e.place]) - own * e.w) * e.j;
  }
  return mobility * sum;
}

// Faces are held by bodies that move with them: out += sign·k g J q.
void ViscositySystem::addBodies(const float* u, const float* v, double own, float sign, float* outU,
                                float* outV) const {
  for (const ViscousBody& body : bodies_) {
    const Eigen::Vector3d q = body.gained(u, v, own);
    for (const ViscousBody::Entry& e : body.entries) {
      (e.component == 0 ? outU : outV)[e.place] += sign * k_ * static_cast<float>(e.g * e.j.dot(q));
    }
  }
}

// body(component, place, sums) for every face; the sums by tile are joined in the order of tiles: the first added, of
// the second the largest.
template <typename Body>
std::array<double, 2> ViscositySystem::overFaces(Body&& body) {
  parallelFor(grid_->size(), kTileBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin + 1; t < end + 1; ++t) {
      std::array<double, 2> sums{0.0, 0.0};
      for (std::size_t c = 0; c < 2; ++c) {
        for (std::size_t at = t * TileGrid::kCells; at < (t + 1) * TileGrid::kCells; ++at) body(c, at, sums);
      }
      sums_[t] = sums;
    }
  });
  std::array<double, 2> all{0.0, 0.0};
  for (std::size_t t = 1; t <= grid_->size(); ++t) all = {all[0] + sums_[t][0], std::max(all[1], sums_[t][1])};
  return all;
}

// The residual, and the diagonal's inverse.
void ViscositySystem::begin(float* u, float* v) {
  const ViscosityCoefficients& c = *coefficients_;
  for (Component& part : parts_) {
    for (AlignedArray<float>* a : {&part.r, &part.p, &part.q, &part.inverse}) grid_->clear(*a);
  }
  sums_.resize(grid_->size() + 1);
  // Of free bodies q holds what they do to faces already, with the sign of b − A(u).
  parallelFor(grid_->size(), kTileBlock, [&](std::size_t first, std::size_t end) {
    for (std::size_t t = first + 1; t < end + 1; ++t) applyTile(t, {u, v}, {parts_[0].q.data(), parts_[1].q.data()});
  });
  addBodies(u, v, 1.0, -1.0f, parts_[0].q.data(), parts_[1].q.data());
  parallelFor(grid_->size(), kTileBlock, [&](std::size_t first, std::size_t end) {
    Window cell, node;
    for (std::size_t t = first + 1; t < end + 1; ++t) {
      grid_->loadHalo(c.cell.data(), t, cell);
      grid_->loadHalo(c.node.data(), t, node);
      for (std::int32_t j = 0; j < grid_->tile(t).rows; ++j) {
        for (std::int32_t i = 0; i < grid_->tile(t).columns; ++i) {
          const std::size_t at = t * TileGrid::kCells + static_cast<std::size_t>(16 * j + i);
          const float own = node.value(i, j);
          if (c.massX[at] > 0.0f) {
            const float beside = 2.0f * (cell.value(i, j) + cell.value(i - 1, j)) + own + node.value(i, j + 1);
            parts_[0].inverse[at] = 1.0f / (c.massX[at] + k_ * (c.groundX[at] + beside));
            parts_[0].r[at] = c.massX[at] * u[at] + k_ * c.wallX[at] - parts_[0].q[at];
          }
          if (c.massY[at] > 0.0f) {
            const float beside = 2.0f * (cell.value(i, j) + cell.value(i, j - 1)) + own + node.value(i + 1, j);
            parts_[1].inverse[at] = 1.0f / (c.massY[at] + k_ * (c.groundY[at] + beside));
            parts_[1].r[at] = c.massY[at] * v[at] + k_ * c.wallY[at] - parts_[1].q[at];
          }
        }
      }
    }
  });
}

ViscosityReport ViscositySystem::solve(const TileGrid& grid, const ViscosityCoefficients& coefficients, double k,
                                       float* u, float* v, float tolerance, int mostIterations,
                                       std::span<const ViscousBody> bodies) {
  FROUDE_ASSERT(k >= 0.0);
  grid_ = &grid;
  coefficients_ = &coefficients;
  bodies_ = bodies;
  k_ = static_cast<float>(k);
  begin(u, v);
  const std::array<float*, 2> velocity{u, v};
  ViscosityReport report;
  // r·D⁻¹r, and the largest |r|.
  auto state = overFaces([&](std::size_t c, std::size_t at, std::array<double, 2>& sums) {
    const float r = parts_[c].r[at];
    sums[0] += static_cast<double>(r * parts_[c].inverse[at] * r);
    sums[1] = std::max(sums[1], static_cast<double>(std::abs(r)));
  });
  double before = 0.0;
  while (!(state[1] <= static_cast<double>(tolerance)) && report.iterations < mostIterations) {
    const auto share = static_cast<float>(report.iterations == 0 ? 0.0 : state[0] / before);
    before = state[0];
    overFaces([&](std::size_t c, std::size_t at, std::array<double, 2>&) {
      Component& part = parts_[c];
      part.p[at] = part.inverse[at] * part.r[at] + share * part.p[at];
    });
    apply(parts_[0].p.data(), parts_[1].p.data(), parts_[0].q.data(), parts_[1].q.data());
    const auto curvature = overFaces([&](std::size_t c, std::size_t at, std::array<double, 2>& sums) {
      sums[0] += static_cast<double>(parts_[c].p[at] * parts_[c].q[at]);
    });
    if (!(curvature[0] > 0.0)) break;
    const auto step = static_cast<float>(state[0] / curvature[0]);
    state = overFaces([&](std::size_t c, std::size_t at, std::array<double, 2>& sums) {
      Component& part = parts_[c];
      velocity[c][at] += step * part.p[at];
      part.r[at] -= step * part.q[at];
      sums[0] += static_cast<double>(part.r[at] * part.inverse[at] * part.r[at]);
      sums[1] = std::max(sums[1], static_cast<double>(std::abs(part.r[at])));
    });
    ++report.iterations;
  }
  report.residual = static_cast<float>(state[1]);
  report.converged = report.residual <= tolerance;
  return report;
}

std::size_t ViscositySystem::memoryBytes() const {
  std::size_t bytes = sums_.capacity() * sizeof(sums_[0]);
  for (const Component& part : parts_) {
    for (const AlignedArray<float>* a : {&part.r, &part.p, &part.q, &part.inverse})
      bytes += a->capacity() * sizeof(float);
  }
  return bytes;
}

}  // namespace froude
