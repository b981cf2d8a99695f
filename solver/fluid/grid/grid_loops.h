// The loops over tiles of the pressure solve: a five-point operator, a Jacobi sweep, and what stands between grids.
//
// A field's tiles are those of TileGrid. Each loop handles tiles [begin, end), writes these only, and leaves sums by
// tile, so that threads change no bit. Cells that are no unknown have zeros in every coefficient and stay zero.
#pragma once

#include <cstddef>
#include <cstdint>

#include <froude/base/aligned.h>
#include <froude/base/simd.h>
#include <froude/fields/tile_grid.h>

namespace froude {

/// Where the values beyond a tile's sides are.
struct TileLinks {
  std::uint32_t left = 0;          // place of the left neighbour of cell (0, 0); that of row j lies 16 j further
  std::uint32_t right = 0;         // of the right neighbour of the last column's cell in row 0
  std::uint32_t down = 0, up = 0;  // of the row below the first, above the last
  std::int32_t lane = 15;          // last column
  std::int32_t rows = 16;
  std::int32_t first = 0, end = 0;  // rows with unknowns; only these are visited
};

/// Links of the tiles of a grid, `first` and `end` left 0; links[0] is that of the null tile.
void linkTiles(const TileGrid& grid, AlignedArray<TileLinks>& links);

/// (A x)_c = diagonal·x_c − Σ a·x_neighbour.
struct GridOperator {
  const TileLinks* links = nullptr;  // by tile; [0] is not used
  const float* ax = nullptr;         // towards the left
  const float* ar = nullptr;         // towards the right
  const float* ay = nullptr;         // towards below; towards above it is that of the cell there
  const float* diagonal = nullptr;
  const float* inverse = nullptr;  // 1/diagonal; 0 where there is no unknown
};

/// Of a fine tile: its quarter of the coarse tile.
struct TileParent {
  std::uint32_t place = 0;  // of the coarse cell over the fine cell (0, 0)
};

/// What a level's matrix is made from, and where it goes.
struct GridAssembly {
  TileLinks* links = nullptr;
  const float* ax = nullptr;
  const float* ay = nullptr;
  const float* ground = nullptr;
  float* ar = nullptr;
  float* diagonal = nullptr;
  float* inverse = nullptr;
};

/// What the next level's matrix is made of: of faces the mean of two, of grounds `share` of the sum of four.
struct GridCoarsening {
  const float* ax = nullptr;
  const float* ay = nullptr;
  const float* ground = nullptr;
  const TileParent* parents = nullptr;
  float share = 1.0f;
  float* coarseX = nullptr;
  float* coarseY = nullptr;
  float* coarseGround = nullptr;
};

struct GridLoops {
  /// The couplings to the right, the diagonal and its inverse, and which rows have unknowns; sums[t] = Σ couplings.
  void (*assemble)(const GridAssembly&, double* sums, std::size_t begin, std::size_t end);
  void (*coarsen)(const GridCoarsening&, std::size_t begin, std::size_t end);
  /// bits[16 t + j]: bit i where the value of cell (i, j) of tile t is > 0.
  void (*positive)(const float* values, std::uint16_t* bits, std::size_t begin, std::size_t end);
  /// x = 0 where there is no unknown.
  void (*clean)(const GridOperator&, float* x, std::size_t begin, std::size_t end);
  /// q = A x; sums[t] = Σ x·q.
  void (*apply)(const GridOperator&, const float* x, float* q, double* sums, std::size_t begin, std::size_t end);
  /// r = b − A x.
  void (*residual)(const GridOperator&, const float* b, const float* x, float* r, std::size_t begin, std::size_t end);
  /// out = x + weight·D⁻¹(r − A x); sums[t] = Σ r·out if sums is not null.
  void (*smooth)(const GridOperator&, const float* r, const float* x, float weight, float* out, double* sums,
                 std::size_t begin, std::size_t end);
  /// out = weight·D⁻¹ r: the sweep from x = 0. sums[t] = largest |r| if sums is not null.
  void (*start)(const GridOperator&, const float* r, float weight, float* out, double* sums, std::size_t begin,
                std::size_t end);
  /// coarse = sums over 2 × 2 cells of r − A x; where there are no unknowns, it stays as it is (0).
  void (*restrictResidual)(const GridOperator&, const float* r, const float* x, const TileParent* parents,
                           float* coarse, std::size_t begin, std::size_t end);
  /// x += coarse, where x is unknown.
  void (*prolong)(const GridOperator&, const float* coarse, const TileParent* parents, float* x, std::size_t begin,
                  std::size_t end);
  /// κ += step·p, r −= step·q, z = weight·D⁻¹ r; sums[t] = largest |r|.
  void (*advance)(const GridOperator&, float step, const float* p, const float* q, float* kappa, float* r, float weight,
                  float* z, double* sums, std::size_t begin, std::size_t end);
  /// p = z + share·p.
  void (*direct)(const GridOperator&, const float* z, float share, float* p, std::size_t begin, std::size_t end);
};

/// Plain C++ in the order of the formulas: the oracle of the wide versions.
const GridLoops& scalarGridLoops();
/// The loops of a target; those of Scalar are `scalarGridLoops`.
const GridLoops& gridLoops(SimdTarget target);

}  // namespace froude
