#include <froude/solver/fluid/coarse_pressure.h>

#include <froude/base/parallel.h>

namespace froude {
namespace {

constexpr float kFull = 0.85f;      // mean density of a full cell
constexpr double kReduction = 0.1;  // of the residual
constexpr int kMaxIterations = 200;
constexpr double kLeastCurvature = 1e-9;  // of a direction: rounding beside the smoothest mode of 10,000 cells in a row
constexpr std::int32_t kStepX[4] = {1, -1, 0, 0};
constexpr std::int32_t kStepY[4] = {0, 0, 1, -1};

double dot(const AlignedArray<double>& a, const AlignedArray<double>& b) {
  return parallelSum(a.size(), [&](std::size_t begin, std::size_t end) {
    double sum = 0.0;
    for (std::size_t i = begin; i < end; ++i) sum += a[i] * b[i];
    return sum;
  });
}

}  // namespace

std::int32_t CoarsePressure::unknownAt(std::int32_t ix, std::int32_t iy) const {
  auto inside = [](std::int32_t& i, std::int32_t n, bool periodic) {
    if (i >= 0 && i < n) return true;
    i += i < 0 ? n : -n;
    return periodic;
  };
  if (!inside(ix, frame_.nx, frame_.periodicX) || !inside(iy, frame_.ny, frame_.periodicY)) return kAir;
  return kind_[static_cast<std::size_t>(iy) * static_cast<std::size_t>(frame_.nx) + static_cast<std::size_t>(ix)];
}

void CoarsePressure::build(const Obstacles& obstacles, const CollisionFilter& filter, const CellGrid& grid,
                           std::span<const std::uint32_t> occupied, const float* density) {
  frame_ = grid.frame();
  kind_.resize(frame_.cellCount());
  std::fill(kind_.begin(), kind_.end(), kAir);
  cells_.clear();
  const std::span<const std::uint32_t> start = grid.cellStart();
  for (const std::uint32_t c : occupied) {
    float sum = 0.0f;
    for (std::uint32_t i = start[c]; i < start[c + 1]; ++i) sum += density[i];
    if (sum < kFull * static_cast<float>(start[c + 1] - start[c])) continue;
    kind_[c] = static_cast<std::int32_t>(cells_.size());
    cells_.push_back(c);
  }
  neighbor_.resize(4 * cells_.size());
  diagonal_.resize(cells_.size());
  const Vec2 extent = frame_.cellExtent();
  const double reach = extent.maxCoeff();
  parallelFor(cells_.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const auto ix = static_cast<std::int32_t>(cells_[k] % static_cast<std::uint32_t>(frame_.nx));
      const auto iy = static_cast<std::int32_t>(cells_[k] / static_cast<std::uint32_t>(frame_.nx));
      const Vec2 center = frame_.origin + extent.cwiseProduct(Vec2(ix + 0.5, iy + 0.5));
      const bool nearWall = obstacles.clearance(center) < 1.5 * reach;
      const bool inSolid = nearWall && obstacles.distance(center, filter).distance <= 0.0;
      double diagonal = 0.0;
      for (int f = 0; f < 4; ++f) {
        std::int32_t n = unknownAt(ix + kStepX[f], iy + kStepY[f]);
        if (nearWall) {
          const Vec2 other = center + extent.cwiseProduct(Vec2(kStepX[f], kStepY[f]));
          if (n < 0) {
            if (obstacles.distance(other, filter).distance <= 0.0) n = kSolid;
          } else if (!inSolid && obstacles.distance(other, filter).distance > 0.0 &&
                     obstacles.sweep(center, other, 1.0, 0.0, filter).hit) {
            n = kSolid;  // a thin wall stands between two full cells
          }
        }
        neighbor_[4 * k + static_cast<std::size_t>(f)] = n;
        if (n != kSolid) diagonal += 1.0;
      }
      diagonal_[k] = diagonal;
    }
  });
}

void CoarsePressure::apply(const AlignedArray<double>& in, AlignedArray<double>& out) const {
  parallelFor(cells_.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      double sum = diagonal_[k] * in[k];
      for (std::size_t f = 4 * k; f < 4 * k + 4; ++f) {
        if (neighbor_[f] >= 0) sum -= in[static_cast<std::size_t>(neighbor_[f])];
      }
      out[k] = sum;
    }
  });
}

// κ of a cell for interpolation, asked for by a cell whose own κ is `own`: walls continue it, air holds 0.
double CoarsePressure::valueAt(std::int32_t ix, std::int32_t iy, double own) const {
  const std::int32_t k = unknownAt(ix, iy);
  return k >= 0 ? solution_[static_cast<std::size_t>(k)] : k == kSolid ? own : 0.0;
}

int CoarsePressure::solve(const CellGrid& grid, std::span<const double> x, std::span<const double> y,
                          const float* excess, float* correction) {
  const std::size_t n = cells_.size();
  std::fill_n(correction, x.size(), 0.0f);
  for (AlignedArray<double>* a : {&solution_, &residual_, &direction_, &product_}) a->resize(n);
  const std::span<const std::uint32_t> start = grid.cellStart();
  parallelFor(n, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      double sum = 0.0;
      for (std::uint32_t i = start[cells_[k]]; i < start[cells_[k] + 1]; ++i) sum += static_cast<double>(excess[i]);
      solution_[k] = 0.0;
      residual_[k] = direction_[k] = diagonal_[k] > 0.0 ? sum : 0.0;
    }
  });
  double energy = dot(residual_, residual_);
  const double enough = kReduction * kReduction * energy;
  int iteration = 0;
  for (; iteration < kMaxIterations && energy > enough && energy > 0.0; ++iteration) {
    apply(direction_, product_);
    const double curvature = dot(direction_, product_);
    // A pocket without a free surface: constants are free, and what they should carry has no solution.
    if (!(curvature > kLeastCurvature * dot(direction_, direction_))) break;
    const double step = energy / curvature;
    parallelFor(n, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) {
        solution_[k] += step * direction_[k];
        residual_[k] -= step * product_[k];
      }
    });
    const double next = dot(residual_, residual_);
    const double keep = next / energy;
    energy = next;
    parallelFor(n, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) direction_[k] = residual_[k] + keep * direction_[k];
    });
  }
  const Vec2 extent = frame_.cellExtent();
  parallelFor(n, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const auto ix = static_cast<std::int32_t>(cells_[k] % static_cast<std::uint32_t>(frame_.nx));
      const auto iy = static_cast<std::int32_t>(cells_[k] / static_cast<std::uint32_t>(frame_.nx));
      const double own = solution_[k];
      // Closed faces continue the cell's own value, whatever lies behind them.
      auto across = [&](std::size_t f, std::int32_t jx, std::int32_t jy) {
        return neighbor_[4 * k + f] == kSolid ? own : valueAt(jx, jy, own);
      };
      for (std::uint32_t i = start[cells_[k]]; i < start[cells_[k] + 1]; ++i) {
        const double fx = (x[i] - frame_.origin.x()) / extent.x() - (ix + 0.5);
        const double fy = (y[i] - frame_.origin.y()) / extent.y() - (iy + 0.5);
        const std::int32_t sx = fx < 0.0 ? -1 : 1, sy = fy < 0.0 ? -1 : 1;
        const double ax = std::min(std::abs(fx), 0.5), ay = std::min(std::abs(fy), 0.5);
        const double vx = across(fx < 0.0 ? 1 : 0, ix + sx, iy), vy = across(fy < 0.0 ? 3 : 2, ix, iy + sy);
        const double corner = valueAt(ix + sx, iy + sy, vx + vy - own);
        correction[i] =
            static_cast<float>((1.0 - ay) * ((1.0 - ax) * own + ax * vx) + ay * ((1.0 - ax) * vy + ax * corner));
      }
    }
  });
  return iteration;
}

std::size_t CoarsePressure::memoryBytes() const {
  return kind_.capacity() * 4 + cells_.capacity() * 4 + neighbor_.capacity() * 4 + 5 * solution_.capacity() * 8;
}

}  // namespace froude
