#include <froude/solver/fluid/arrangement.h>

#include <cmath>

#include <froude/base/parallel.h>

namespace froude {
namespace {

constexpr float kFull = 0.97f;  // density from which a kernel counts as full
constexpr float kSkew = 0.3f;   // |S + g| from which it does not
constexpr double kOpen = 2.0;   // times √N particles at a surface make a free surface

}  // namespace

void Arrangement::resize(std::size_t n) {
  for (AlignedArray<float>* a : {&skewX, &skewY, &xx, &xy, &yy}) a->resize(n);
  place_.resize(n);
}

MomentLoop Arrangement::moments(const WallLayer& walls, float* density, float* squares) {
  return {walls.any() ? walls.lambda() : nullptr, density, skewX.data(), skewY.data(), squares,
          {xx.data(), xy.data(), yy.data()}};
}

void Arrangement::judge(const CellGrid& grid, std::span<const std::uint32_t> occupied, const WallLayer& walls,
                        double volume, float* density) {
  const bool any = walls.any();
  const auto share = static_cast<float>(volume);
  struct Part {
    double moment, count;
  };
  const auto all = reduceBlocks<Part>(
      place_.size(), {0.0, 0.0},
      [&](std::size_t begin, std::size_t end) {
        Part part{0.0, 0.0};
        for (std::size_t i = begin; i < end; ++i) {
          const float lambda = any ? walls.lambda()[i] : 0.0f;
          if (share != 1.0f) {
            density[i] = share * (density[i] - lambda) + lambda;
            for (AlignedArray<float>* a : {&skewX, &skewY, &xx, &xy, &yy}) (*a)[i] *= share;
          }
          const float x = skewX[i] + (any ? walls.gradientX()[i] : 0.0f);
          const float y = skewY[i] + (any ? walls.gradientY()[i] : 0.0f);
          const bool full = density[i] > kFull && x * x + y * y < kSkew * kSkew;
          place_[i] = !full ? Place::AtSurface : any && lambda > 0.0f ? Place::AtWall : Place::Inside;
          if (place_[i] != Place::Inside) continue;
          part.moment += 0.5 * static_cast<double>(xx[i] + yy[i]);
          part.count += 1.0;
        }
        return part;
      },
      [](const Part& a, const Part& b) {
        return Part{a.moment + b.moment, a.count + b.count};
      });
  laplacianMoment_ = all.count > 0.0 ? all.moment / all.count : 1.0;
  correction_.build(grid, occupied, {xx.data(), xy.data(), yy.data()}, place_.data(),
                    share == 1.0f ? GradientCorrection::kUsual : static_cast<float>(1.0 / laplacianMoment_));
}

double Arrangement::surfaceRows() const {
  const double count = parallelSum(place_.size(), [&](std::size_t begin, std::size_t end) {
    double part = 0.0;
    for (std::size_t i = begin; i < end; ++i) part += atSurface(i) ? 1.0 : 0.0;
    return part;
  });
  return place_.empty() ? 0.0 : count / std::sqrt(static_cast<double>(place_.size()));
}

bool Arrangement::hasSurface() const { return surfaceRows() > kOpen; }

std::size_t Arrangement::memoryBytes() const {
  return correction_.memoryBytes() + 5 * xx.capacity() * sizeof(float) + place_.capacity();
}

}  // namespace froude
