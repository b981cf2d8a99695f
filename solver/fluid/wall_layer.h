// Walls as the particles of one sub-step see them: λ, its gradient, to whom the force goes, and which pairs are hidden.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <froude/base/aligned.h>
#include <froude/particles/cell_grid.h>
#include <froude/solver/coupling/obstacles.h>
#include <froude/solver/coupling/soft_walls.h>
#include <froude/solver/fluid/kernel.h>
#include <froude/solver/fluid/pair_loops.h>

namespace froude {

/// The part of a particle's wall gradient that belongs to one owner.
struct WallLink {
  std::uint32_t particle;
  std::int32_t owner;  // body index, −1: the domain, below: a soft body (softOwner)
  float lambda;
  float gradientX, gradientY;  // [1/dx]
  float normalX, normalY;      // of a surface that fluids stick to, towards the particle; else 0
  float drag;                  // |gradient|/distance of such a surface [1/dx²]; else 0
};

/// Built once a sub-step at the predicted positions; memory is reused from step to step.
class WallLayer {
 public:
  /// spacing: the unit of λ's gradient, half a kernel's support radius [m]; recession: by how much walls stand back, in
  /// these units (`latticeRecession`); kind: the kernel; filter: of the fluid.
  WallLayer(double spacing, double recession, kernel::Kind kind, CollisionFilter filter)
      : spacing_(spacing), recession_(recession), kernel_(kind), filter_(filter) {}

  /// Positions x, y [m] outside all solids, sorted by `grid`; obstacles posed at the end of the sub-step. Soft bodies,
  /// which may be null, may be overlapped. Cost: a look-up a particle, and the wall integral for those within the
  /// support radius of a wall.
  void build(const Obstacles& obstacles, const SoftWalls* soft, const CellGrid& grid, std::span<const double> x,
             std::span<const double> y);

  /// Per particle; 0 away from walls.
  const float* lambda() const { return lambda_.data(); }
  const float* gradientX() const { return gradientX_.data(); }
  const float* gradientY() const { return gradientY_.data(); }
  /// λ/((1 − λ)·|g|²): how much of the motion along the wall is made up for; 0 where λ ≥ 0.6.
  const float* tangent() const { return tangent_.data(); }
  /// False if no particle is near a wall: loops then skip λ altogether.
  bool any() const { return any_; }
  HiddenPairs hidden() const { return anyHidden_ ? HiddenPairs{offset_.data(), words_.data()} : HiddenPairs{}; }
  /// visit(const WallLink&) in increasing particle order.
  template <typename Visit>
  void forEachLink(Visit&& visit) const {
    for (std::size_t b = 0; b < used_; ++b) {
      for (const WallLink& link : blocks_[b].links) visit(link);
    }
  }
  /// visit(std::span<const WallLink>) for each particle that has any, in increasing order.
  template <typename Visit>
  void forEachParticle(Visit&& visit) const {
    for (std::size_t b = 0; b < used_; ++b) {
      const std::span<const WallLink> links = blocks_[b].links.span();
      for (std::size_t begin = 0, end = 0; begin < links.size(); begin = end) {
        while (end < links.size() && links[end].particle == links[begin].particle) ++end;
        visit(links.subspan(begin, end - begin));
      }
    }
  }
  /// visit(particle) for each particle in a gap between two owners that is too narrow for it, or within a soft body, in
  /// increasing order.
  template <typename Visit>
  void forEachFilm(Visit&& visit) const {
    for (std::size_t b = 0; b < used_; ++b) {
      for (const std::uint32_t i : blocks_[b].films) visit(i);
    }
  }
  std::size_t memoryBytes() const;

 private:
  struct Block {
    AlignedArray<WallLink> links;
    AlignedArray<std::uint64_t> words;
    AlignedArray<std::uint32_t> films;
  };
  void integrate(const Obstacles& obstacles, const SoftWalls* soft, const CellGrid& grid, std::span<const double> x,
                 std::span<const double> y, std::uint32_t i, Block& block);
  static void findDrag(std::span<const WallEdge> edges, WallLink& link);
  void findHidden(std::span<const WallEdge> edges, const CellGrid& grid, std::span<const double> x,
                  std::span<const double> y, std::uint32_t i, Block& block);

  double spacing_, recession_;
  kernel::Kind kernel_;
  CollisionFilter filter_;
  AlignedArray<float> lambda_, gradientX_, gradientY_, tangent_;
  AlignedArray<std::int32_t> offset_;
  AlignedArray<std::uint64_t> words_;
  std::vector<Block> blocks_;
  std::size_t used_ = 0;
  bool any_ = false;
  bool anyHidden_ = false;
};

}  // namespace froude
