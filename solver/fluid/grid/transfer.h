// Between particles and the staggered grid, a tile at a time: the affine particle-in-cell method.
//
// C. Jiang et al., "The affine particle-in-cell method", ACM Trans. Graph. 34(4), 2015; on a staggered grid the affine
// part of a component is the gradient of its bilinear interpolation.
#pragma once

#include <cstdint>

#include <froude/base/simd.h>
#include <froude/fields/tile_grid.h>

namespace froude {

/// Cells along the side of a tile.
inline constexpr int kTileSide = TileGrid::kSide;

/// Particles in the order of their cells. Positions in cells from the corner of the tile that each belongs to, in
/// [0, 16]; velocities [m/s]; gradients ∂u/∂x, ∂u/∂y, ∂v/∂x, ∂v/∂y [m/s a cell].
struct GridParticles {
  const float* x;
  const float* y;
  const float* u;
  const float* v;
  const float* gradient[4];
};

/// What the particles of a tile give to the faces and nodes in and around it: sums of weights, and of weights times
/// velocity. Row j + 1, column i + 1 is cell (i, j) of the tile, so one row and column of the tiles around; u stands at
/// the left face of the cell, v at the bottom one, a node at the lower left corner.
struct TileSums {
  static constexpr int kRows = kTileSide + 2, kStride = 20, kSize = kRows * kStride;
  float uWeight[kSize], uSum[kSize], vWeight[kSize], vSum[kSize], node[kSize];
  static constexpr int at(int i, int j) { return (j + 1) * kStride + i + 1; }
};

/// Velocities at faces in and around a tile: face (i, j) of the tile stands at at(i, j), `kMargin` cells around it too.
struct TileWindow {
  static constexpr int kMargin = 8, kStride = kTileSide + 2 * kMargin, kSize = kStride * kStride;
  float u[kSize], v[kSize];  // [m/s]
  static constexpr int at(int i, int j) { return (j + kMargin) * kStride + i + kMargin; }
};

/// What a particle takes from the grid.
struct GridMotion {
  float* u;  // interpolated velocity [m/s]
  float* v;
  float* gradient[4];  // as in GridParticles
  float* dx;           // where the velocity field takes it in the time, from where it is [cells]
  float* dy;
};

/// The loops of one instruction set. All give the same bits but for fused multiply-adds, which none uses.
struct TransferLoops {
  /// Particles [start[c], start[c + 1]) are in cell c of the tile (row by row). Overwrites `sums`.
  void (*give)(const GridParticles& particles, const std::uint32_t* start, TileSums& sums);
  /// Means over neighbouring faces with weights 1 2 3 3 3 2 1 along both axes: what a pattern of a few cells is carried
  /// by. Right up to three faces from the window's edge.
  void (*smooth)(const TileWindow& window, TileWindow& smooth);
  /// For particles [begin, end), which lie in the windows' tile: velocity and its gradient, and the way that it takes
  /// them in `time` [s/cell size]: by the third-order Runge-Kutta method of Ralston (Math. Comp. 16, 1962) along
  /// `smooth` as it stands, with what the velocity has beyond that carried along as it is at the start; and on top the
  /// way of `shift` at the start. Places beyond the margin see the margin's velocities.
  void (*take)(const GridParticles& particles, const TileWindow& velocity, const TileWindow& smooth,
               const TileWindow& shift, float time, std::uint32_t begin, std::uint32_t end, const GridMotion& motion);
  /// Interpolates to u and v at the particles.
  void (*sample)(const GridParticles& particles, const TileWindow& window, std::uint32_t begin, std::uint32_t end,
                 float* u, float* v);
};
const TransferLoops& transferLoops(SimdTarget target);
const TransferLoops& scalarTransferLoops();

}  // namespace froude
