// Outlines of soft bodies as walls of a fluid: where its pressure meets them, and what it gives them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <froude/fields/world_field.h>
#include <froude/solver/coupling/edge_cells.h>
#include <froude/solver/fluid/wall_integral.h>

namespace froude {

/// Owners of walls are bodies (≥ 0), the domain (−1) or soft bodies (below).
inline constexpr int softOwner(std::size_t soft) { return -2 - static_cast<int>(soft); }
inline constexpr bool isSoftOwner(int owner) { return owner < -1; }

/// The outlines of one sub-step. Their nodes are where they come to if they keep the velocity that they had on the mean
/// of the sub-step before: pressures that stay as they were leave them there, for what the pressures were then is in
/// that velocity. By what changes, nodes give way as the inertia of their share of the body lets them (Fernández,
/// Mullaert & Vidrascu, Int. J. Numer. Methods Eng. 101 (2015): Robin-Neumann coupling, stable whatever the fluid's
/// mass).
class SoftWalls {
 public:
  struct Node {
    Vec2 end{0, 0}, velocity{0, 0};  // at the end of the sub-step [m], during it [m/s]
    double inverseInertia = 0.0;     // of what gives way with it [m/kg]; 0: held
    Vec2 expected{0, 0};             // impulse of the pressure in the sub-step before, for this one's length [kg/s]
    Vec2 impulse{0, 0};              // what the fluid gives it [kg/s]
  };
  struct Edge {
    std::uint32_t a, b;  // nodes; the solid is to the left
    int owner;
    CollisionFilter filter;
  };
  /// Of a wall near a particle: how much of it stands on a node.
  struct Share {
    std::uint32_t node;
    double weight;
  };

  std::vector<Node>& nodes() { return nodes_; }
  const std::vector<Node>& nodes() const { return nodes_; }
  std::vector<Edge>& edges() { return edges_; }
  /// When all nodes stand where they end; `reach` [m]: how far queries look.
  void sort(double reach);

  /// False: no edge is within the reach of x. Cost: two comparisons far from all.
  bool mayBeNear(const Vec2& x) const { return around_.contains(x); }
  /// Edges within `radius` of x that the filter accepts, relative to x and divided by `unit` [m], behind the `count`
  /// that `edges` has; at most kMaxWallEdges in all. Returns how many there are then.
  std::size_t edgesNear(const Vec2& x, double radius, double unit, const CollisionFilter& filter,
                        std::span<WallEdge> edges, std::size_t count) const;
  /// How what acts between a particle at x and the owner's wall within `radius` is shared by the nodes, by a weight
  /// that falls with the distance from x, along the edges that look at it. Adds to `shares`; the weights' sum is 1.
  void share(int owner, const Vec2& x, double radius, std::vector<Share>& shares) const;

 private:
  std::vector<Node> nodes_;
  std::vector<Edge> edges_;
  EdgeCells cells_;
  Box around_;
  std::vector<Vec2> ends_;
};

}  // namespace froude
