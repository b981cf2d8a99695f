#include <froude/solver/fluid/lattice_sums.h>

#include <algorithm>
#include <cmath>

#include <froude/solver/fluid/wall_integral.h>

namespace froude {
namespace {

constexpr int kFar = 1 << 20;  // rows: all

// Of the kernel over rows first to last, from a particle in row 0.
double sumOverRows(double ratio, kernel::Kind kind, int first, int last) {
  const int reach = static_cast<int>(kernel::kSupport / ratio) + 1;
  double sum = 0.0;
  for (int row = std::max(first, -reach); row <= std::min(last, reach); ++row) {
    for (int k = -reach; k <= reach; ++k) {
      const double q2 = ratio * ratio * static_cast<double>(row * row + k * k);
      sum += kind == kernel::Kind::Blend ? kernel::value(q2) : kernel::wendland(std::sqrt(q2));
    }
  }
  return sum;
}

}  // namespace

double latticeVolume(double ratio, kernel::Kind kind) {
  if (ratio == 1.0 && kind == kernel::Kind::Blend) return 1.0;
  return 1.0 / sumOverRows(ratio, kind, -kFar, kFar);
}

double latticeRecession(double ratio, kernel::Kind kind) {
  const double missing = latticeVolume(ratio, kind) * sumOverRows(ratio, kind, -kFar, -1);
  double low = -0.5, high = 0.5;
  while (high - low > 1e-8) {
    const double middle = 0.5 * (low + high);
    (halfPlaneShare(0.5 * ratio + middle, kind) > missing ? low : high) = middle;
  }
  return std::round(1e7 * 0.5 * (low + high)) / 1e7;
}

}  // namespace froude
