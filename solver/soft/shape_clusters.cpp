#include <froude/solver/soft/shape_clusters.h>

#include <Eigen/LU>
#include <cmath>

namespace froude {
namespace {

constexpr double kClusterSide = 6.0;  // spacings
constexpr std::size_t kFewest = 3;    // points of a cluster
constexpr std::size_t kForQuadratic = 10;
constexpr double kShare = 0.3;  // of the quadratic map in the goals; the rest is the rotation's

}  // namespace

ShapeClusters::ShapeClusters(const std::vector<Vec2>& rest, const std::vector<double>& mass, double spacing)
    : mass_(mass), goalX_(rest.size()), goalY_(rest.size()), radius_(0.5 * kClusterSide * spacing) {
  Box box;
  for (const Vec2& p : rest) box.include(p);
  const double side = kClusterSide * spacing, step = 0.5 * side;
  const auto nx = std::max(1, static_cast<int>(std::ceil(box.size().x() / step)) - 1);
  const auto ny = std::max(1, static_cast<int>(std::ceil(box.size().y() / step)) - 1);
  std::vector<std::vector<std::uint32_t>> groups;
  std::vector<int> uses(rest.size(), 0);
  for (int j = 0; j < ny; ++j) {
    for (int i = 0; i < nx; ++i) {
      const Vec2 low = box.min + Vec2(i * step, j * step) - Vec2(1e-9 * side, 1e-9 * side);
      // The last ones reach to the end.
      const Vec2 high(i + 1 == nx ? kInfinity : low.x() + side, j + 1 == ny ? kInfinity : low.y() + side);
      std::vector<std::uint32_t> group;
      for (std::uint32_t k = 0; k < rest.size(); ++k) {
        if ((rest[k].array() >= low.array()).all() && (rest[k].array() < high.array()).all()) group.push_back(k);
      }
      if (group.size() < kFewest) continue;
      for (const std::uint32_t k : group) ++uses[k];
      groups.push_back(std::move(group));
    }
  }
  for (std::uint32_t k = 0; k < rest.size(); ++k) {  // what fell between goes to the nearest
    if (uses[k] > 0 || groups.empty()) continue;
    std::size_t best = 0;
    double least = kInfinity;
    for (std::size_t g = 0; g < groups.size(); ++g) {
      const double away = (rest[groups[g].front()] - rest[k]).squaredNorm();
      if (away < least) least = away, best = g;
    }
    groups[best].push_back(k);
    ++uses[k];
  }
  for (const std::vector<std::uint32_t>& group : groups) {
    Cluster c{static_cast<std::uint32_t>(members_.size()), 0, 0.0, {}, {}};
    Vec2 center(0.0, 0.0);
    for (const std::uint32_t k : group) {
      const double share = mass[k] / uses[k];
      center += share * rest[k];
      c.mass += share;
    }
    center /= c.mass;
    Eigen::Matrix2d linear = Eigen::Matrix2d::Zero();
    Eigen::Matrix<double, 5, 5> quadratic = Eigen::Matrix<double, 5, 5>::Zero();
    for (const std::uint32_t k : group) {
      const Vec2 q = rest[k] - center;
      const double share = mass[k] / uses[k];
      Eigen::Matrix<double, 5, 1> full;
      full << q.x(), q.y(), q.x() * q.x(), q.y() * q.y(), q.x() * q.y();
      linear += share * q * q.transpose();
      quadratic += share * full * full.transpose();
      members_.push_back({k, share, {full[0], full[1], full[2], full[3], full[4]}});
    }
    c.end = static_cast<std::uint32_t>(members_.size());
    const Eigen::Matrix2d inverse = linear.inverse();
    const Eigen::FullPivLU<Eigen::Matrix<double, 5, 5>> lu(quadratic);
    const bool full = group.size() >= kForQuadratic && lu.isInvertible();
    const Eigen::Matrix<double, 5, 5> inverse5 = full
                                                     ? Eigen::Matrix<double, 5, 5>(lu.inverse())
                                                     : Eigen::Matrix<double, 5, 5>(Eigen::Matrix<double, 5, 5>::Zero());
    for (int a = 0; a < 5; ++a) {
      for (int b = 0; b < 5; ++b) c.quadratic[a][b] = inverse5(a, b);
    }
    for (int a = 0; a < 2; ++a) {
      for (int b = 0; b < 2; ++b) c.inverse[a][b] = std::isfinite(inverse(a, b)) ? inverse(a, b) : 0.0;
    }
    clusters_.push_back(c);
  }
}

double ShapeClusters::findGoals(const double* x, const double* y) const {
  std::fill(goalX_.begin(), goalX_.end(), 0.0);
  std::fill(goalY_.begin(), goalY_.end(), 0.0);
  double squares = 0.0;
  for (const Cluster& c : clusters_) {
    double cx = 0.0, cy = 0.0;
    for (std::uint32_t m = c.begin; m < c.end; ++m) {
      cx += members_[m].share * x[members_[m].node];
      cy += members_[m].share * y[members_[m].node];
    }
    cx /= c.mass;
    cy /= c.mass;
    // Σ m p q̃ᵀ, its first two columns the linear A_pq.
    double px[5] = {}, py[5] = {};
    for (std::uint32_t m = c.begin; m < c.end; ++m) {
      const Member& at = members_[m];
      const double dx = at.share * (x[at.node] - cx), dy = at.share * (y[at.node] - cy);
      for (int a = 0; a < 5; ++a) {
        px[a] += dx * at.q[a];
        py[a] += dy * at.q[a];
      }
    }
    // In two dimensions the polar rotation is the angle of the sum of A's rotations; a shape that has none stays.
    const double along = px[0] + py[1], turn = py[0] - px[1], length = std::hypot(along, turn);
    const double cosine = length > 0.0 ? along / length : 1.0, sine = length > 0.0 ? turn / length : 0.0;
    double mapX[5] = {}, mapY[5] = {};
    const bool full = c.quadratic[2][2] != 0.0;
    const int order = full ? 5 : 2;
    for (int b = 0; b < order; ++b) {
      for (int a = 0; a < order; ++a) {
        const double inverse = full ? c.quadratic[a][b] : c.inverse[a][b];
        mapX[b] += px[a] * inverse;
        mapY[b] += py[a] * inverse;
      }
    }
    // The squares have a mean of their own; what it moves all by is taken out, or momentum would change.
    double meanX = 0.0, meanY = 0.0;
    for (std::uint32_t m = c.begin; m < c.end; ++m) {
      for (int a = 2; a < order; ++a) {
        meanX += members_[m].share * mapX[a] * members_[m].q[a];
        meanY += members_[m].share * mapY[a] * members_[m].q[a];
      }
    }
    meanX /= c.mass;
    meanY /= c.mass;
    for (std::uint32_t m = c.begin; m < c.end; ++m) {
      const Member& at = members_[m];
      double gx = cx - meanX, gy = cy - meanY;
      for (int a = 0; a < order; ++a) {
        gx += mapX[a] * at.q[a];
        gy += mapY[a] * at.q[a];
      }
      const double rx = cx + cosine * at.q[0] - sine * at.q[1], ry = cy + sine * at.q[0] + cosine * at.q[1];
      goalX_[at.node] += at.share * (kShare * gx + (1.0 - kShare) * rx);
      goalY_[at.node] += at.share * (kShare * gy + (1.0 - kShare) * ry);
      const double ax = x[at.node] - gx, ay = y[at.node] - gy, bx = x[at.node] - rx, by = y[at.node] - ry;
      squares += at.share * (kShare * (ax * ax + ay * ay) + (1.0 - kShare) * (bx * bx + by * by));
    }
  }
  for (std::size_t k = 0; k < mass_.size(); ++k) {
    goalX_[k] /= mass_[k];
    goalY_[k] /= mass_[k];
  }
  return squares;
}

void ShapeClusters::project(double stiffness, double dtSquared, const NodeColumns& n) {
  findGoals(n.x, n.y);
  const double s = stiffness * dtSquared, pull = s / (1.0 + s);
  for (std::size_t k = 0; k < mass_.size(); ++k) {
    if (n.inverseMass[k] == 0.0) continue;
    n.x[k] += pull * (goalX_[k] - n.x[k]);
    n.y[k] += pull * (goalY_[k] - n.y[k]);
  }
}

double ShapeClusters::energy(double stiffness, const double* x, const double* y) const {
  return 0.5 * stiffness * findGoals(x, y);
}

}  // namespace froude
