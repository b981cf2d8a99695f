// CutCells: what polygons and walls leave open of the cells and faces of a square grid, by exact clipping. Knows no
// fluid: a list of the cells that an outline touches, their parts, how these join, and which wall each part has.
#pragma once

#include <array>
#include <memory>
#include <span>

#include <froude/base/api.h>
#include <froude/base/transform.h>
#include <froude/fields/polygon.h>

namespace froude {

/// Cell (i, j) covers origin + [i, i+1] × [j, j+1] · size, without bounds. Along a periodic axis cells are numbered
/// from 0 to the period, which is a whole number of cells; polygons may lie anywhere.
struct CutGrid {
  Vec2 origin{0, 0};                      // [m]
  double size = 1.0;                      // [m]
  std::int32_t periodX = 0, periodY = 0;  // [cells]; 0: not periodic
};

/// A polygon that cuts: solid inside. Several may overlap; what is in any of them is solid once.
struct CutOutline {
  const Polygon* polygon = nullptr;
  Transform place;        // of its frame in the world
  Vec2 center{0, 0};      // about which moments are taken [m, world]
  std::int32_t body = 0;  // whose it is; ≥ 0
};

/// Straight walls of the domain, body −1: solid beyond each closed side. Moments about the grid's origin.
struct CutWalls {
  Box box;                                                 // [m]
  std::array<bool, 4> closed{false, false, false, false};  // left, right, bottom, top
};

/// Sides of a cell, in this order everywhere.
enum class CutSide : std::uint8_t { Left, Right, Bottom, Top };

/// A cell that an outline touches. Its parts are the connected pieces of what is open in it, the largest first: the
/// main part. A cell that is not listed is wholly open or wholly solid.
struct CutCell {
  std::int32_t i = 0, j = 0;
  std::uint32_t part = 0, partCount = 0;  // in parts(); no part: the cell is solid
  /// By side: how much of it is open between the main part and the main part of the cell beyond (or that whole cell)
  /// [of a cell's size].
  std::array<double, 4> open{0, 0, 0, 0};
};

/// For each part, Σ over its joints of length · outward side normal = Σ over its walls of normal, to rounding: constant
/// pressure does nothing, and moving walls are divergence-free where they should be.
struct CutPart {
  double area = 0.0;                                                 // [cells]
  std::uint32_t cell = 0;                                            // in cells()
  std::uint32_t joint = 0, jointCount = 0, wall = 0, wallCount = 0;  // in joints(), walls()
};

/// Where a part is open to the cell beyond one of its sides. Between two cut cells it is there twice, once for each.
struct CutJoint {
  CutSide side = CutSide::Left;
  std::int32_t part = -1;  // that it opens to, in parts(); −1: the cell beyond is wholly open
  std::int32_t edge = -1;  // that it is, in edges(); −1: it is between two main parts
  double length = 0.0;     // [of a cell's size]
};

/// What one body bounds of one part: with n the unit normal out of the solid, r the arm from the body's center,
/// pressure p [N/m] pushes the body by −p·size·normal and turns it by −p·size·moment; the body moving at V with spin ω
/// pushes size·(V·normal + ω·moment) [m²/s] out of the part through its joints.
struct CutWall {
  std::int32_t body = -1;
  Vec2 normal{0, 0};    // ∫ n ds [of a cell's size]
  double moment = 0.0;  // ∫ r × n ds [m · of a cell's size]
  double length = 0.0;  // [of a cell's size]
  Vec2 middle{0, 0};    // ∫ x ds / length, from the cell's lower left corner [cells]
  /// ∫ (x − middle of the cell)·n ds, rows by the axis of x [cells²]: what a pressure that changes across the cell
  /// adds.
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
};

/// A face that is not open between two main parts alone: left or bottom part `a`, right or top part `b`; each is an
/// index into parts() or −1 for a wholly open cell. At least one of them is not a main part. Cell (i, j) is the one
/// whose left (`vertical`) or bottom face this is.
struct CutEdge {
  std::int32_t i = 0, j = 0;
  bool vertical = true;
  std::int32_t a = -1, b = -1;
  double length = 0.0;  // [of a cell's size]
};

/// Cut cells of fixed outlines, made once, and of moving ones, made each step.
///
/// Vertices nearer than 1e-10 cells to a grid line are put on it; everything else is as exact as doubles are: areas and
/// lengths to about 1e-12 cells, corners, needles and plates of any thinness included. Outlines on grid lines belong to
/// the cell on their open side, so that no part without area arises from them. Slivers are listed as they are: a part's
/// matrix row is made of its joints' lengths alone, the area stands nowhere in it, so a small part has a small or an
/// ordinary row but no singular one. A part without joints is a closed pocket: it has no equation.
///
/// The same bits whatever the number of threads, whatever was there before, and whatever `range` was. No allocation in
/// a steady state.
class FROUDE_API CutCells {
 public:
  CutCells();
  ~CutCells();
  CutCells(CutCells&&) noexcept;
  CutCells& operator=(CutCells&&) noexcept;

  /// Takes fixed outlines and walls. Nothing moving is left. Cost: about 1 µs for each cell that is touched.
  void setFixed(const CutGrid& grid, std::span<const CutOutline> outlines, const CutWalls& walls);
  /// Cells with range[0] ≤ i ≤ range[2], range[1] ≤ j ≤ range[3] are to be right from now on (others may be missing
  /// or cut by walls and fixed outlines alone), with these moving outlines. Cost: the moving outlines' cells in range;
  /// next to nothing if there are none and the range was covered before.
  void update(const std::array<std::int32_t, 4>& range, std::span<const CutOutline> moving);
  /// Rises whenever the lists below have changed.
  std::uint64_t version() const;

  /// By tiles of 16 × 16 cells, row after row of tiles, inside a tile row after row of cells.
  std::span<const CutCell> cells() const;
  std::span<const CutPart> parts() const;
  std::span<const CutJoint> joints() const;
  std::span<const CutWall> walls() const;
  /// In the order of cells.
  std::span<const CutEdge> edges() const;

  /// Index of the first listed cell of tile (⌊i/16⌋, ⌊j/16⌋) or of the tiles behind it. Cost: a binary search.
  std::size_t tileBegin(std::int32_t tileX, std::int32_t tileY) const;
  /// Index into cells(); −1: not listed. Cost: a binary search.
  std::int32_t find(std::int32_t i, std::int32_t j) const;
  /// Of a cell that is not listed: is it wholly solid? Cost: a binary search.
  bool solid(std::int32_t i, std::int32_t j) const;
  /// The part in parts() to which x [m] belongs, or is nearest if it lies in the solid. Exact to rounding.
  /// Precondition: x in the cell or next to it, and the cell has a part. Cost: nothing for a single part, else a few
  /// pieces.
  std::uint32_t partAt(std::uint32_t cell, const Vec2& x) const;

  std::size_t memoryBytes() const;

 private:
  struct Data;
  std::unique_ptr<Data> data_;
};

}  // namespace froude
