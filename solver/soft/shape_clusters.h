// Shape matching: groups of points, each drawn to the best fit of its rest shape.
#pragma once

#include <cstdint>
#include <vector>

#include <froude/base/types.h>
#include <froude/solver/soft/strain_elements.h>

namespace froude {

/// Overlapping clusters of a body's points: squares of `kClusterSide` spacings at half that distance, so that most
/// points are in four. Each finds the rotation that fits its rest shape best, and a quadratic map of which a share is
/// mixed in (Müller, Heidelberger, Teschner & Gross 2005, equations 6 to 16); goals are means over a point's clusters,
/// weighted by mass, so that momentum stays. Cheap and unconditionally stable; what E means it only resembles.
class ShapeClusters {
 public:
  ShapeClusters() = default;
  ShapeClusters(const std::vector<Vec2>& rest, const std::vector<double>& mass, double spacing);

  /// Draws each free point to its goal as a spring of angular frequency² `stiffness` [1/s²] would over dtSquared [s²],
  /// taken implicitly: x + s (goal − x)/(1 + s), s = stiffness·dtSquared.
  void project(double stiffness, double dtSquared, const NodeColumns& nodes);
  bool empty() const { return clusters_.empty(); }
  /// Energy of these springs [J/m]: of each cluster to its rotated and to its quadratic goals, in their shares. As both
  /// fit best, their variation does no work, and the springs' forces are the gradient of this.
  double energy(double stiffness, const double* x, const double* y) const;
  /// Half of the mean side of clusters [m].
  double radius() const { return radius_; }

 private:
  struct Member {
    std::uint32_t node;
    double share;  // of the node's mass in this cluster [kg/m]
    double q[5];   // rest place from the centre: x, y [m], x², y², xy [m²]
  };
  struct Cluster {
    std::uint32_t begin, end;  // of its members
    double mass;
    double inverse[2][2];    // of Σ m q qᵀ, linear part
    double quadratic[5][5];  // of Σ m q̃ q̃ᵀ; zero where there are too few points
  };
  // The share of goals that a point's clusters give it; returns Σ m |x − goal|², rotated and quadratic in their shares.
  double findGoals(const double* x, const double* y) const;

  std::vector<Member> members_;
  std::vector<Cluster> clusters_;
  std::vector<double> mass_;
  mutable std::vector<double> goalX_, goalY_;  // work space
  double radius_ = 0.0;
};

}  // namespace froude
