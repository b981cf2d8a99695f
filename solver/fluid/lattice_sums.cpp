#include <froude/solver/fluid/lattice_sums.h>

#include <algorithm>

#include <froude/solver/fluid/kernel.h>
#include <froude/solver/fluid/wall_integral.h>

namespace froude {
namespace {

constexpr int kFar = 1 << 20;  // rows: all

// Of the kernel over rows first to last, from a particle in row 0.
double sumOverRows(double ratio, int first, int last) {
  const int reach = static_cast<int>(kernel::kSupport / ratio) + 1;
  double sum = 0.0;
  for (int row = std::max(first, -reach); row <= std::min(last, reach); ++row) {
    for (int k = -reach; k <= reach; ++k) sum += kernel::value(ratio * ratio * static_cast<double>(row * row + k * k));
  }
  return sum;
}

}  // namespace

double latticeVolume(double ratio) {
  return ratio == 1.0 ? 1.0 : 1.0 / sumOverRows(ratio, -kFar, kFar);
}

double latticeRecession(double ratio) {
  const double missing = latticeVolume(ratio) * sumOverRows(ratio, -kFar, -1);
  double low = -0.5, high = 0.5;
  while (high - low > 1e-8) {
    const double middle = 0.5 * (low + high);
    (halfPlane(0.5 * ratio + middle).lambda > missing ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace froude
