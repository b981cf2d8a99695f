// The second stage of cut cells: what the pieces of outlines in one cell leave open of it. Internal.
#pragma once

#include <span>
#include <vector>

#include <froude/fields/cut_pieces.h>

namespace froude::detail {

/// Whose an outline is, by its number.
struct CutOwner {
  std::int32_t body = -1;
  Vec2 center{0, 0};  // of moments [m]
};

/// A stretch of a cell's side that is open to one of its parts, `from` < `to`, 0 … 1.
struct CutOpening {
  CutSide side = CutSide::Left;
  std::uint32_t part = 0;  // of the cell
  double from = 0.0, to = 0.0;
};

/// An open trapezoid between two levels of a cell, bounded left and right by edges or by the cell's sides.
struct CutSlab {
  double y0 = 0.0, y1 = 0.0;
  double left0 = 0.0, left1 = 0.0, right0 = 0.0, right1 = 0.0;  // x at y0 and at y1
  std::int32_t leftEdge = -1, rightEdge = -1;                   // −1: the cell's side
  std::uint32_t part = 0;                                       // of the cell
};

/// A wall of a part, by body.
struct CutPartWall {
  std::uint32_t part = 0;  // of the cell
  CutWall wall;
};

/// Cuts one cell after the other. The levels of all end points, and of the crossings of different outlines, divide the
/// cell into slabs in which edges do not cross; in a slab they are sorted and the winding number is counted from left
/// to right: what is in no outline is open, however many overlap. Trapezoids that meet at a level in more than a point
/// are one part. No loops are traced: nothing can fail to close. Cost: levels × edges.
class CellCutter {
 public:
  /// `pieces`: all of the cell; `winding`: of its lower left corner, all outlines together.
  void cut(const CutGrid& grid, std::span<const CutPiece> pieces, std::int32_t winding,
           std::span<const CutOwner> owners);

  /// By part, the largest first [cells].
  const std::vector<double>& areas() const { return areas_; }
  /// Side by side, each from its low end to its high end.
  const std::vector<CutOpening>& openings() const { return openings_; }
  /// In the order of parts.
  const std::vector<CutPartWall>& walls() const { return walls_; }
  const std::vector<CutSlab>& slabs() const { return slabs_; }

 private:
  struct Edge {
    double x0, y0, x1, y1;  // y0 < y1
    std::int32_t rise;      // of the winding number from left to right
    std::uint32_t piece;
    double at(double y) const {
      if (y <= y0) return x0;
      if (y >= y1) return x1;
      return x0 + (y - y0) * ((x1 - x0) / (y1 - y0));
    }
  };
  struct Flat {
    double y, low, high;
    bool solidAbove;
    std::uint32_t piece;
  };
  struct Crossing {
    double at;
    std::int32_t rise;
  };
  struct Active {
    double low, high;  // x at the slab's ends
    std::uint32_t edge;
  };
  struct Span {
    double low, high;
    std::int32_t slab;  // −1: the cell beyond
  };
  struct Found {
    double area, open;
    std::uint32_t number;
  };
  struct FlatWall {
    double y, low, high;
    bool solidAbove;
    std::uint32_t slab, piece;
  };

  void sortPieces(std::span<const CutPiece> pieces);
  void addLevels(std::span<const CutPiece> pieces);
  void fillSlab(double y0, double y1, std::int32_t winding);
  void outsideSpans(std::vector<Crossing>& crossings, std::int32_t winding);
  void joinAt(double y, const std::vector<Span>& below, const std::vector<Span>& above);
  void addFlatWalls(double y, const std::vector<Span>& open, const std::vector<Span>& opposite, bool solidAbove);
  void wallOnFlats(double y, double low, double high, bool solidAbove, std::uint32_t slab);
  void numberParts();
  void addSideOpenings();
  void addWalls(const CutGrid& grid, std::span<const CutPiece> pieces, std::span<const CutOwner> owners);
  std::uint32_t root(std::uint32_t slab);

  std::vector<Edge> edges_;
  std::vector<Flat> flats_;
  std::vector<Crossing> left_, bottom_, top_;
  std::vector<double> levels_;
  std::vector<Active> active_;
  std::vector<CutSlab> slabs_;
  std::vector<std::uint32_t> parent_;
  std::vector<Found> found_;
  std::vector<Span> outside_, below_, above_;
  std::vector<FlatWall> flatWalls_;
  std::vector<CutOpening> ends_;  // of the bottom and the top side
  std::vector<double> areas_;
  std::vector<CutOpening> openings_;
  std::vector<CutPartWall> walls_;
};

}  // namespace froude::detail
