#include <froude/solver/fluid/grid/pressure_fallback.h>

#include <Eigen/IterativeLinearSolvers>
#include <Eigen/SparseCore>
#include <vector>

namespace froude {
namespace {

using Matrix = Eigen::SparseMatrix<double>;
using Vector = Eigen::VectorXd;

constexpr int kMostIterations = 5000;

class Assembly {
 public:
  explicit Assembly(Eigen::Index unknowns) : diagonal_(Vector::Zero(unknowns)) {}
  void couple(Eigen::Index a, Eigen::Index b, double coefficient) {
    if (coefficient == 0.0 || a < 0 || b < 0) return;
    add(a, b, -coefficient);
    add(b, a, -coefficient);
    diagonal_[a] += coefficient;
    diagonal_[b] += coefficient;
  }
  void ground(Eigen::Index a, double coefficient) { diagonal_[a] += coefficient; }
  void add(Eigen::Index a, Eigen::Index b, double value) { entries_.emplace_back(a, b, value); }
  double diagonal(Eigen::Index a) const { return diagonal_[a]; }
  Matrix matrix() {
    for (Eigen::Index k = 0; k < diagonal_.size(); ++k) add(k, k, diagonal_[k]);
    Matrix m(diagonal_.size(), diagonal_.size());
    m.setFromTriplets(entries_.begin(), entries_.end());
    return m;
  }

 private:
  Vector diagonal_;
  std::vector<Eigen::Triplet<double>> entries_;
};

void addBody(const PressureBody& body, const std::vector<Eigen::Index>& number, Assembly& assembly) {
  for (const PressureBody::Entry& a : body.entries) {
    for (const PressureBody::Entry& b : body.entries) {
      double value = 0.0;
      for (std::size_t c = 0; c < 3; ++c) {
        value += static_cast<double>(body.mobility[c]) * static_cast<double>(a.j[c]) * static_cast<double>(b.j[c]);
      }
      if (number[a.place] >= 0 && number[b.place] >= 0) assembly.add(number[a.place], number[b.place], value);
    }
  }
}

}  // namespace

bool solvePressureByFallback(const TileGrid& grid, const PressureCoefficients& coefficients,
                             std::span<const PressureBody> bodies, const ClosedRegions& regions, const float* inverse,
                             const float* b, float tolerance, float* kappa) {
  const std::size_t places = coefficients.ground.size();
  std::vector<Eigen::Index> number(places, -1);
  std::vector<std::size_t> placeOf;
  for (std::size_t k = TileGrid::kCells; k < places; ++k) {
    if (inverse[k] <= 0.0f) continue;
    number[k] = static_cast<Eigen::Index>(placeOf.size());
    placeOf.push_back(k);
  }
  if (placeOf.empty()) return true;
  Assembly assembly(static_cast<Eigen::Index>(placeOf.size()));
  for (const std::size_t k : placeOf) {
    assembly.ground(number[k], static_cast<double>(coefficients.ground[k]));
    if (k >= grid.values()) continue;
    const auto [i, j] = grid.cell(k);
    assembly.couple(number[k], number[grid.place(i - 1, j)], static_cast<double>(coefficients.ax[k]));
    assembly.couple(number[k], number[grid.place(i, j - 1)], static_cast<double>(coefficients.ay[k]));
  }
  for (const PressureEdge& edge : coefficients.edges) {
    assembly.couple(number[edge.a], number[edge.b], static_cast<double>(edge.coefficient));
  }
  // A closed region's constant is free: one of its cells is tied to zero, which changes nothing else.
  for (int r = 0; r < regions.count(); ++r) {
    const Eigen::Index k = number[regions.first(r)];
    assembly.ground(k, assembly.diagonal(k));
  }
  for (const PressureBody& body : bodies) addBody(body, number, assembly);
  const Matrix matrix = assembly.matrix();
  Vector right(matrix.rows()), guess(matrix.rows());
  for (Eigen::Index k = 0; k < right.size(); ++k) {
    right[k] = static_cast<double>(b[placeOf[static_cast<std::size_t>(k)]]);
    guess[k] = static_cast<double>(kappa[placeOf[static_cast<std::size_t>(k)]]);
  }
  const double size = right.norm();
  if (size == 0.0) return true;
  Eigen::ConjugateGradient<Matrix, Eigen::Lower | Eigen::Upper, Eigen::IncompleteCholesky<double>> solver;
  solver.setMaxIterations(kMostIterations);
  solver.setTolerance(0.5 * static_cast<double>(tolerance) / size);  // the largest is not above the norm
  solver.compute(matrix);
  if (solver.info() != Eigen::Success) return false;
  const Vector solution = solver.solveWithGuess(right, guess);
  if (!solution.allFinite()) return false;
  for (Eigen::Index k = 0; k < solution.size(); ++k) {
    kappa[placeOf[static_cast<std::size_t>(k)]] = static_cast<float>(solution[k]);
  }
  return (right - matrix * solution).cwiseAbs().maxCoeff() <= static_cast<double>(tolerance);
}

}  // namespace froude
