// Questions to a fluid between steps: filled fraction, pressure and velocity at a point. Alters nothing.
#pragma once

#include <span>
#include <vector>

#include <froude/base/aligned.h>
#include <froude/particles/cell_grid.h>
#include <froude/particles/pool.h>
#include <froude/solver/coupling/obstacles.h>
#include <froude/solver/fluid/kernel.h>

namespace froude {

/// Sorts the particles anew when their state has changed, and answers from its own cells.
class FluidQuery {
 public:
  /// Called before questions; cheap if `version` is the one it holds. spacing dx [m].
  void update(const ParticlePool& pool, const DomainDef& domain, double spacing, std::uint64_t version);

  /// φ = Σ (m/ρ0) W + λ at x, pairs across walls left out; NaN inside a solid.
  double filledFraction(const Obstacles& obstacles, const CollisionFilter& filter, const Vec2& x) const;

  /// Shepard mean Σ a W / Σ W of a value over the particles within one support radius; NaN if there is none.
  /// value(i): of the particle at the pool's index i.
  template <typename Value>
  double mean(const Vec2& x, Value&& value) const {
    double sum = 0.0, weight = 0.0;
    forEachNear(x, [&](std::uint32_t i, const Vec2&, double w) {
      sum += w * value(i);
      weight += w;
    });
    return weight > 0.0 ? sum / weight : std::nan("");
  }

 private:
  /// visit(pool index, offset from x in spacings, W·dx²) for particles within the support.
  template <typename Visit>
  void forEachNear(const Vec2& x, Visit&& visit) const {
    if (empty_) return;
    grid_.forEachRun(grid_.cellOf(x.x(), x.y()), [&](const CellRun& run) {
      for (std::uint32_t j = run.begin; j < run.end; ++j) {
        const Vec2 p = Vec2(x_[j] + run.shiftX - x.x(), y_[j] + run.shiftY - x.y()) / spacing_;
        const double w = kernel::value(p.squaredNorm());
        if (w > 0.0) visit(grid_.order()[j], p, w);
      }
    });
  }

  CellGrid grid_;
  AlignedArray<double> x_, y_;  // in cell order [m]
  double spacing_ = 1.0;
  std::uint64_t version_ = ~0ull;
  bool empty_ = true;
};

}  // namespace froude
