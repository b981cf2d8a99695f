#include <algorithm>
#include <cmath>

#include <froude/base/parallel.h>
#include <froude/solver/fluid/kernel.h>
#include <froude/solver/fluid/lattice.h>
#include <froude/solver/fluid/pair_loops.h>

namespace froude {
namespace {

constexpr float kUnit = 1.0f / static_cast<float>(lattice::kUnitsPerSpacing);

// pair(j, dx, dy, m): each visible candidate inside the support of particle i, itself included; m = 1 − q²/4 > 0.
template <typename Pair>
void forEachPair(const PairFrame& frame, std::uint32_t cell, std::uint32_t i, Pair&& pair) {
  std::int32_t word = frame.hidden.offset != nullptr ? frame.hidden.offset[i] : -1;
  frame.grid->forEachRun(cell, [&](const CellRun& run) {
    const std::int32_t shiftX = run.shiftX > 0.0 ? frame.periodX : run.shiftX < 0.0 ? -frame.periodX : 0;
    const std::int32_t shiftY = run.shiftY > 0.0 ? frame.periodY : run.shiftY < 0.0 ? -frame.periodY : 0;
    const std::int32_t xi = lattice::difference(frame.x[i], shiftX);
    const std::int32_t yi = lattice::difference(frame.y[i], shiftY);
    for (std::uint32_t j = run.begin; j < run.end; ++j) {
      if (word >= 0) {
        const std::uint32_t k = j - run.begin;
        if ((frame.hidden.words[static_cast<std::uint32_t>(word) + k / 64] >> (k % 64) & 1) == 0) continue;
      }
      const float dx = kUnit * static_cast<float>(lattice::difference(xi, frame.x[j]));
      const float dy = kUnit * static_cast<float>(lattice::difference(yi, frame.y[j]));
      const float m = 1.0f - 0.25f * (dx * dx + dy * dy);
      if (m > 0.0f) pair(j, dx, dy, m);
    }
    if (word >= 0) word += static_cast<std::int32_t>((run.end - run.begin + 63) / 64);
  });
}

template <typename Particle>
void forEachParticle(const PairFrame& frame, std::size_t begin, std::size_t end, Particle&& particle) {
  const std::span<const std::uint32_t> start = frame.grid->cellStart();
  for (std::size_t c = begin; c < end; ++c) {
    const std::uint32_t cell = frame.cells[c];
    for (std::uint32_t i = start[cell]; i < start[cell + 1]; ++i) particle(cell, i);
  }
}

constexpr auto kNorm = static_cast<float>(kernel::kNorm);
constexpr auto kTail = static_cast<float>(kernel::kTail);

// A kernel and −(dW/dq)/q from m.
struct Blend {
  static float shape(float m) {
    const float m3 = m * m * m;
    return kNorm * (m3 * m * (1.0f + kTail * (m3 * m3)));
  }
  static float slope(float m) {
    const float m3 = m * m * m;
    return 2.0f * kNorm * (m3 * (1.0f + 2.5f * kTail * (m3 * m3)));
  }
};

struct WendlandC2 {
  static constexpr auto kFactor = static_cast<float>(kernel::kWendland);
  static float shape(float m) {
    const float h = std::sqrt(1.0f - m), k = 1.0f - h;
    return kFactor * (k * k * (k * k) * (1.0f + 4.0f * h));
  }
  static float slope(float m) {
    const float k = 1.0f - std::sqrt(1.0f - m);
    return 5.0f * kFactor * (k * k * k);
  }
};

// Returns what the gain adds to the excess.
double updatePressure(const PressureUpdate& update, std::uint32_t i, float density, float diagonal) {
  const float gain = density - update.target[i];
  const float least = update.least != nullptr ? update.least[i] : 0.0f;
  float step = update.relaxation * gain / std::max(diagonal, kSmallestDiagonal);
  if (update.momentum > 0.0f) step += update.momentum * update.change[i];
  update.change[i] = std::max(least - update.kappa[i], step);
  return static_cast<double>(std::max(gain, least < 0.0f ? -gain : 0.0f));
}

double density(const PairFrame& frame, const DensityLoop& loop, std::size_t begin, std::size_t end) {
  double excess = 0.0;
  forEachParticle(frame, begin, end, [&](std::uint32_t cell, std::uint32_t i) {
    float sum = 0.0f, sx = 0.0f, sy = 0.0f, squares = 0.0f;
    forEachPair(frame, cell, i, [&](std::uint32_t, float dx, float dy, float m) {
      const float m3 = m * m * m;
      sum += m3 * m * (1.0f + kTail * (m3 * m3));
      const float f = m3 * (1.0f + 2.5f * kTail * (m3 * m3));
      sx += f * dx;
      sy += f * dy;
      squares += f * f * (dx * dx + dy * dy);
    });
    float wall = 0.0f, gx = 0.0f, gy = 0.0f;
    if (loop.lambda != nullptr) {
      gx = loop.wallX[i];
      gy = loop.wallY[i];
      wall = loop.lambda[i] + gx * loop.shiftX[i] + gy * loop.shiftY[i];
    }
    loop.density[i] = kNorm * sum + wall;
    if (loop.diagonal != nullptr) {
      const float px = -2.0f * kNorm * sx, py = -2.0f * kNorm * sy;
      loop.diagonal[i] = (px + gx) * (px + 2.0f * gx) + (py + gy) * (py + 2.0f * gy) + 4.0f * kNorm * kNorm * squares;
    }
    const PressureUpdate& update = loop.update;
    if (update.target == nullptr) return;
    if (update.target[i] == 0.0f) update.target[i] = std::max(loop.density[i], 1.0f);
    const float diagonal = update.diagonal != nullptr ? update.diagonal[i] : loop.diagonal[i];
    excess += updatePressure(update, i, loop.density[i], diagonal);
  });
  return excess;
}

double divergence(const PairFrame& frame, const DivergenceLoop& loop, std::size_t begin, std::size_t end) {
  double excess = 0.0;
  forEachParticle(frame, begin, end, [&](std::uint32_t cell, std::uint32_t i) {
    float sum = 0.0f;
    const float ux = loop.ux[i], uy = loop.uy[i];
    const float xx = loop.correction.xx[i], xy = loop.correction.xy[i], yy = loop.correction.yy[i];
    forEachPair(frame, cell, i, [&](std::uint32_t j, float dx, float dy, float m) {
      const float m3 = m * m * m;
      const float away = (ux - loop.ux[j]) * (xx * dx + xy * dy) + (uy - loop.uy[j]) * (xy * dx + yy * dy);
      sum += m3 * (1.0f + 2.5f * kTail * (m3 * m3)) * away;
    });
    float gain = -2.0f * kNorm * sum;
    if (loop.wallX != nullptr) gain += loop.wallX[i] * ux + loop.wallY[i] * uy + loop.wallGain[i];
    excess += updatePressure(loop.update, i, gain, loop.update.diagonal[i]);
  });
  return excess;
}

template <typename Kernel>
void momentsOf(const PairFrame& frame, const MomentLoop& loop, std::size_t begin, std::size_t end) {
  forEachParticle(frame, begin, end, [&](std::uint32_t cell, std::uint32_t i) {
    float sum = 0.0f, sx = 0.0f, sy = 0.0f, squares = 0.0f, xx = 0.0f, xy = 0.0f, yy = 0.0f;
    forEachPair(frame, cell, i, [&](std::uint32_t, float dx, float dy, float m) {
      sum += Kernel::shape(m);
      const float f = Kernel::slope(m);
      sx -= f * dx;
      sy -= f * dy;
      xx += f * dx * dx;
      xy += f * dx * dy;
      yy += f * dy * dy;
      squares += f * f * (dx * dx + dy * dy);
    });
    loop.density[i] = sum + (loop.lambda != nullptr ? loop.lambda[i] : 0.0f);
    loop.skewX[i] = sx;
    loop.skewY[i] = sy;
    loop.squares[i] = squares;
    loop.moment.xx[i] = xx;
    loop.moment.xy[i] = xy;
    loop.moment.yy[i] = yy;
  });
}

void moments(const PairFrame& frame, const MomentLoop& loop, std::size_t begin, std::size_t end) {
  frame.kernel == kernel::Kind::Blend ? momentsOf<Blend>(frame, loop, begin, end)
                                      : momentsOf<WendlandC2>(frame, loop, begin, end);
}

// Adds what a wall does to a move, and the pressure to those before it.
template <typename Loop>
void takeMove(const Loop& loop, std::uint32_t i, float& moveX, float& moveY) {
  const float own = loop.pressure[i];
  if (loop.wallX != nullptr) {
    const float gx = loop.wallX[i], gy = loop.wallY[i];
    const float along = loop.tangent[i] * (gx * moveY - gy * moveX);
    moveX -= 2.0f * own * gx + along * gy;
    moveY -= 2.0f * own * gy - along * gx;
  }
  if (loop.kappa != nullptr) loop.kappa[i] += own;
}

void push(const PairFrame& frame, const PushLoop& loop, std::size_t begin, std::size_t end) {
  forEachParticle(frame, begin, end, [&](std::uint32_t cell, std::uint32_t i) {
    float sx = 0.0f, sy = 0.0f;
    forEachPair(frame, cell, i, [&](std::uint32_t j, float dx, float dy, float m) {
      const float m3 = m * m * m;
      const float f = m3 * (1.0f + 2.5f * kTail * (m3 * m3));
      sx += f * (loop.scaled.xx[j] * dx + loop.scaled.xy[j] * dy);
      sy += f * (loop.scaled.xy[j] * dx + loop.scaled.yy[j] * dy);
    });
    const float qx = loop.skewX[i], qy = loop.skewY[i];
    float moveX = 2.0f * kNorm * sx - (loop.scaled.xx[i] * qx + loop.scaled.xy[i] * qy);
    float moveY = 2.0f * kNorm * sy - (loop.scaled.xy[i] * qx + loop.scaled.yy[i] * qy);
    takeMove(loop, i, moveX, moveY);
    loop.shiftX[i] += moveX;
    loop.shiftY[i] += moveY;
    loop.totalX[i] += moveX;
    loop.totalY[i] += moveY;
  });
}

void displace(const PairFrame& frame, const DisplacementLoop& loop, std::size_t begin, std::size_t end) {
  forEachParticle(frame, begin, end, [&](std::uint32_t cell, std::uint32_t i) {
    float sx = 0.0f, sy = 0.0f;
    const float own = loop.pressure[i];
    forEachPair(frame, cell, i, [&](std::uint32_t j, float dx, float dy, float m) {
      const float m3 = m * m * m;
      const float f = (own + loop.pressure[j]) * (m3 * (1.0f + 2.5f * kTail * (m3 * m3)));
      sx += f * dx;
      sy += f * dy;
    });
    float moveX = 2.0f * kNorm * sx, moveY = 2.0f * kNorm * sy;
    takeMove(loop, i, moveX, moveY);
    loop.shiftX[i] += moveX;
    loop.shiftY[i] += moveY;
    loop.newX[i] = lattice::sum(frame.x[i], static_cast<std::int32_t>(std::lrintf(moveX / kUnit)));
    loop.newY[i] = lattice::sum(frame.y[i], static_cast<std::int32_t>(std::lrintf(moveY / kUnit)));
  });
}

template <typename Kernel>
void viscosityOf(const PairFrame& frame, const ViscosityLoop& loop, std::size_t begin, std::size_t end) {
  forEachParticle(frame, begin, end, [&](std::uint32_t cell, std::uint32_t i) {
    float sx = 0.0f, sy = 0.0f;
    const float vx = loop.vx[i], vy = loop.vy[i];
    forEachPair(frame, cell, i, [&](std::uint32_t j, float, float, float m) {
      const float weight = loop.a * Kernel::shape(m) + loop.b * Kernel::slope(m);
      sx += weight * (loop.vx[j] - vx);
      sy += weight * (loop.vy[j] - vy);
    });
    loop.changeX[i] = sx;
    loop.changeY[i] = sy;
  });
}

void viscosity(const PairFrame& frame, const ViscosityLoop& loop, std::size_t begin, std::size_t end) {
  frame.kernel == kernel::Kind::Blend ? viscosityOf<Blend>(frame, loop, begin, end)
                                      : viscosityOf<WendlandC2>(frame, loop, begin, end);
}

std::array<double, 2> force(const PairFrame& frame, const ForceLoop& loop, std::size_t begin, std::size_t end) {
  std::array<double, 2> total{0.0, 0.0};
  forEachParticle(frame, begin, end, [&](std::uint32_t cell, std::uint32_t i) {
    float sx = 0.0f, sy = 0.0f;
    const float sign = loop.sign[i];
    const float ownXX = sign * loop.scaled.xx[i], ownXY = sign * loop.scaled.xy[i], ownYY = sign * loop.scaled.yy[i];
    forEachPair(frame, cell, i, [&](std::uint32_t j, float dx, float dy, float m) {
      const float f = WendlandC2::slope(m);
      const float xx = ownXX + loop.scaled.xx[j], xy = ownXY + loop.scaled.xy[j], yy = ownYY + loop.scaled.yy[j];
      sx += f * (xx * dx + xy * dy);
      sy += f * (xy * dx + yy * dy);
    });
    float moveX = sx, moveY = sy;
    total[0] += static_cast<double>(moveX);
    total[1] += static_cast<double>(moveY);
    takeMove(loop, i, moveX, moveY);
    loop.shiftX[i] = moveX;
    loop.shiftY[i] = moveY;
    loop.ux[i] += moveX;
    loop.uy[i] += moveY;
    if (loop.fallX != nullptr) {
      loop.ux[i] += loop.fallX[i];
      loop.uy[i] += loop.fallY[i];
    }
    if (loop.totalX != nullptr) {
      loop.totalX[i] += moveX;
      loop.totalY[i] += moveY;
    }
  });
  return total;
}

// Returns the excess that the pressure belongs to.
float takeState(const StateEquation& state, const Matrices<const float>& b, float volume, std::uint32_t i, float before,
                float excess) {
  if (state.pressure == nullptr) return excess;
  excess = std::max(state.least[i], excess);
  float kappa = excess;
  if (state.tait) {
    const float r = 1.0f + kappa, r3 = r * r * r;
    kappa = (r3 * r3 * r - 1.0f) / 7.0f;
  }
  kappa = state.stiffness * (kappa + state.background + state.damping * (excess - before));
  state.pressure[i] = kappa;
  state.scaled.xx[i] = volume * kappa * b.xx[i];
  state.scaled.xy[i] = volume * kappa * b.xy[i];
  state.scaled.yy[i] = volume * kappa * b.yy[i];
  return excess;
}

void rate(const PairFrame& frame, const RateLoop& loop, std::size_t begin, std::size_t end) {
  forEachParticle(frame, begin, end, [&](std::uint32_t cell, std::uint32_t i) {
    float sum = 0.0f;
    const float ux = loop.ux[i], uy = loop.uy[i], excess = loop.excess[i], ax = loop.ax[i], ay = loop.ay[i];
    const float xx = loop.correction.xx[i], xy = loop.correction.xy[i], yy = loop.correction.yy[i];
    forEachPair(frame, cell, i, [&](std::uint32_t j, float dx, float dy, float m) {
      const float away = (ux - loop.ux[j]) * (xx * dx + xy * dy) + (uy - loop.uy[j]) * (xy * dx + yy * dy);
      const float along = 0.5f * ((ax + loop.ax[j]) * dx + (ay + loop.ay[j]) * dy);
      const float jump = loop.excess[j] - excess + loop.slope * along;
      sum += WendlandC2::slope(m) * (away - loop.diffusion * jump);
    });
    float gain = -loop.volume * sum;
    if (loop.wallX != nullptr) {
      gain += 2.0f * (loop.wallX[i] * ux + loop.wallY[i] * uy + loop.wallShare * loop.wallGain[i]);
    }
    loop.next[i] = takeState(loop.state, loop.correction, loop.volume, i, excess, excess + loop.share[i] * gain);
    if (loop.newX == nullptr) return;
    loop.newX[i] = lattice::sum(frame.x[i], static_cast<std::int32_t>(std::lrintf(ux / kUnit)));
    loop.newY[i] = lattice::sum(frame.y[i], static_cast<std::int32_t>(std::lrintf(uy / kUnit)));
  });
}

}  // namespace

void findCellRuns(const CellGrid& grid, std::span<const std::uint32_t> cells, const HiddenPairs& hidden,
                  AlignedArray<CellRuns>& runs) {
  runs.resize(cells.size());
  const std::span<const std::uint32_t> start = grid.cellStart();
  parallelFor(cells.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      CellRuns& r = runs[k];
      r = {};
      r.first = start[cells[k]];
      r.last = start[cells[k] + 1];
      bool plain = true;
      std::uint32_t count = 0, beyond = 0;
      grid.forEachRun(cells[k], [&](const CellRun& run) {
        const std::uint32_t length = run.end - run.begin;
        beyond += length - std::min(length, CellRuns::kUsual);
        plain = plain && count < 3 && beyond <= CellRuns::kUsual && run.shiftX == 0.0 && run.shiftY == 0.0;
        if (!plain) return;
        r.begin[count] = run.begin;
        r.count[count++] = static_cast<std::uint16_t>(length);
      });
      for (std::uint32_t i = r.first; hidden.offset != nullptr && i < r.last; ++i) plain &= hidden.offset[i] < 0;
      if (plain) r.kind = beyond == 0 ? CellRuns::Kind::Usual : CellRuns::Kind::Long;
    }
  });
}

const PairLoops& scalarPairLoops() {
  static constexpr PairLoops kLoops{density, divergence, moments, push, displace, viscosity, force, rate, nullptr};
  return kLoops;
}

}  // namespace froude
