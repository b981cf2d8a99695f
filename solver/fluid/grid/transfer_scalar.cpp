// The transfers in plain C++: the reference of transfer_wide.cpp, by the same operations in the same order.
#include <algorithm>
#include <cmath>
#include <cstring>

#include <froude/solver/fluid/grid/transfer.h>

namespace froude {
namespace {

float hat(float d) { return std::max(0.0f, 1.0f - std::abs(d)); }

void give(const GridParticles& p, const std::uint32_t* start, TileSums& sums) {
  std::memset(static_cast<void*>(&sums), 0, sizeof sums);
  for (int j = 0; j < kTileSide; ++j) {
    for (int i = 0; i < kTileSide; ++i) {
      const std::uint32_t* cell = start + j * kTileSide + i;
      if (cell[0] == cell[1]) continue;
      const auto cx = static_cast<float>(i), cy = static_cast<float>(j);
      auto add = [&](float nodeX, float nodeY, int at, const float* velocity, const float* gradientX,
                     const float* gradientY, float* weights, float* values) {
        float weight = 0.0f, value = 0.0f;
        for (std::uint32_t k = cell[0]; k < cell[1]; ++k) {
          const float dx = nodeX - (p.x[k] - cx), dy = nodeY - (p.y[k] - cy);
          const float w = hat(dx) * hat(dy);
          weight += w;
          if (values != nullptr) value += w * (velocity[k] + (gradientX[k] * dx + gradientY[k] * dy));
        }
        weights[at] += weight;
        if (values != nullptr) values[at] += value;
      };
      for (int b = -1; b <= 1; ++b) {
        for (int a = 0; a <= 1; ++a) {
          add(static_cast<float>(a), static_cast<float>(b) + 0.5f, TileSums::at(i + a, j + b), p.u, p.gradient[0],
              p.gradient[1], sums.uWeight, sums.uSum);
        }
      }
      for (int b = 0; b <= 1; ++b) {
        for (int a = -1; a <= 1; ++a) {
          add(static_cast<float>(a) + 0.5f, static_cast<float>(b), TileSums::at(i + a, j + b), p.v, p.gradient[2],
              p.gradient[3], sums.vWeight, sums.vSum);
        }
      }
      for (int b = 0; b <= 1; ++b) {
        for (int a = 0; a <= 1; ++a) {
          add(static_cast<float>(a), static_cast<float>(b), TileSums::at(i + a, j + b), nullptr, nullptr, nullptr,
              sums.node, nullptr);
        }
      }
    }
  }
}

float weighted(const float* f, int step) {
  const float near = f[0] + (f[-step] + f[step]);
  return (1.0f / 15.0f) * (3.0f * near + (2.0f * (f[-2 * step] + f[2 * step]) + (f[-3 * step] + f[3 * step])));
}

void smoothField(const float* from, float* to) {
  constexpr int kStride = TileWindow::kStride;
  float along[TileWindow::kSize];
  std::copy_n(from, TileWindow::kSize, along);
  for (int j = 0; j < kStride; ++j) {
    for (int i = 3; i < kStride - 3; ++i) along[j * kStride + i] = weighted(from + j * kStride + i, 1);
  }
  std::copy_n(along, TileWindow::kSize, to);
  for (int k = 3 * kStride; k < TileWindow::kSize - 3 * kStride; ++k) to[k] = weighted(along + k, kStride);
}

void smooth(const TileWindow& window, TileWindow& out) {
  smoothField(window.u, out.u);
  smoothField(window.v, out.v);
}

struct Place {
  int at;
  float x, y;  // shares of a cell beyond
};

// `field` stands at whole numbers plus (shiftX, shiftY).
Place placeOf(float x, float y, float shiftX, float shiftY) {
  constexpr float kLast = TileWindow::kStride - 2;
  constexpr float kMargin = TileWindow::kMargin;
  const float px = std::clamp(x + (kMargin - shiftX), 0.0f, kLast),
              py = std::clamp(y + (kMargin - shiftY), 0.0f, kLast);
  const int i = static_cast<int>(px), j = static_cast<int>(py);
  return {j * TileWindow::kStride + i, px - static_cast<float>(i), py - static_cast<float>(j)};
}

struct Sample {
  float value, alongX, alongY;
};

Sample sampleOf(const float* field, const Place& p) {
  const float* f = field + p.at;
  const float low = f[1] - f[0], high = f[TileWindow::kStride + 1] - f[TileWindow::kStride];
  const float bottom = f[0] + p.x * low, top = f[TileWindow::kStride] + p.x * high;
  return {bottom + p.y * (top - bottom), low + p.y * (high - low), top - bottom};
}

void take(const GridParticles& p, const TileWindow& w, const TileWindow& smooth, const TileWindow& shift, float time,
          std::uint32_t begin, std::uint32_t end, const GridMotion& motion) {
  for (std::uint32_t k = begin; k < end; ++k) {
    const float x = p.x[k], y = p.y[k];
    const Place atU = placeOf(x, y, 0.0f, 0.5f), atV = placeOf(x, y, 0.5f, 0.0f);
    const Sample u = sampleOf(w.u, atU), v = sampleOf(w.v, atV);
    const float shiftX = sampleOf(shift.u, atU).value, shiftY = sampleOf(shift.v, atV).value;
    const float ownX = u.value - sampleOf(smooth.u, atU).value, ownY = v.value - sampleOf(smooth.v, atV).value;
    auto stage = [&](float share, float alongX, float alongY, float& u2, float& v2) {
      const float x2 = x + share * alongX, y2 = y + share * alongY;
      u2 = ownX + sampleOf(smooth.u, placeOf(x2, y2, 0.0f, 0.5f)).value;
      v2 = ownY + sampleOf(smooth.v, placeOf(x2, y2, 0.5f, 0.0f)).value;
    };
    float u2, v2, u3, v3;
    stage(0.5f * time, u.value, v.value, u2, v2);
    stage(0.75f * time, u2, v2, u3, v3);
    motion.u[k] = u.value;
    motion.v[k] = v.value;
    motion.gradient[0][k] = u.alongX;
    motion.gradient[1][k] = u.alongY;
    motion.gradient[2][k] = v.alongX;
    motion.gradient[3][k] = v.alongY;
    const float ninth = time / 9.0f;
    motion.dx[k] = ninth * ((2.0f * u.value + 3.0f * u2) + 4.0f * u3) + time * shiftX;
    motion.dy[k] = ninth * ((2.0f * v.value + 3.0f * v2) + 4.0f * v3) + time * shiftY;
  }
}

void sample(const GridParticles& p, const TileWindow& w, std::uint32_t begin, std::uint32_t end, float* u, float* v) {
  for (std::uint32_t k = begin; k < end; ++k) {
    u[k] = sampleOf(w.u, placeOf(p.x[k], p.y[k], 0.0f, 0.5f)).value;
    v[k] = sampleOf(w.v, placeOf(p.x[k], p.y[k], 0.5f, 0.0f)).value;
  }
}

}  // namespace

const TransferLoops& scalarTransferLoops() {
  static constexpr TransferLoops kLoops{give, smooth, take, sample};
  return kLoops;
}

}  // namespace froude
