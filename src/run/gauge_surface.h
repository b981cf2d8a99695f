// The shape of the fluid, read off the filled fraction φ: area, surface, toe. Looks at one state of a world, alters
// nothing.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <froude/solver/world.h>
#include "run/gauge_bulk.h"

namespace froude::run {

/// φ is looked at on a grid of dx/2 whose cells tile the domain from its lower left corner; a cell is wet if φ ≥ ½ at
/// its centre. Only cells within a support radius (2 dx) of a particle are looked at: λ alone reaches ½ in a dry
/// corner, and no fluid is there. Heights are above the domain's lower side [m]. The bottom of a column is its lowest
/// cell centre outside solids. Good as long as the world does not change.
class FluidSurface {
 public:
  explicit FluidSurface(const World& world);

  /// Area of the wet cells [m²]. Cost: 50 kernels a particle, and one φ a cell near solids; with `level`, once.
  double area();
  /// Mean, over the columns whose bottom cell is wet, of the top of the run of wet cells from the bottom, interpolated
  /// linearly in φ between cell centres; NaN where no column is wet [m]. Cost: as `area`.
  double level();
  /// The same top at one x, anywhere between the columns; 0 where the bottom is dry [m]. Cost: one φ a cell of the
  /// column.
  double height(double x) const;
  /// Largest x of a connected region (over the sides of cells) of wet cells that has a bottom cell, interpolated
  /// linearly in φ beyond its last centre [m]. Regions under 16 dx² are drops and count only where there is nothing
  /// larger; then the largest of them does. NaN where there is none. Plates thinner than dx/2 do not part regions,
  /// periodic sides do. Cost: one φ a cell from the right end of the fluid to where the answer is certain, mostly a few
  /// columns.
  double toe() const;

 private:
  enum class Near : std::uint8_t { Nothing, Beside, Inside };
  struct ColumnTops;

  Vec2 node(std::int64_t i, std::int64_t j) const;
  bool active(std::int64_t i, std::int64_t j) const;
  bool solid(const Vec2& point) const { return world_.insideSolid(point); }
  double phiAt(const Vec2& point) const;
  double crossing(const Vec2& wet, double phiWet, const Vec2& dry, double phiDry) const;
  std::int64_t bottomRow(double x, std::int64_t end) const;
  std::vector<float> evaluate(const std::vector<Vec2>& points) const;
  std::vector<float> columnsOf(std::int64_t first, std::int64_t count, bool everywhere) const;
  void markTiles();
  void markParticle(const Vec2& p);
  void scan();
  void fillStrip(std::vector<float>& phi, const BulkFraction& bulk, std::int64_t firstRow, std::int64_t rows) const;
  std::vector<Near> solidMask(std::int64_t firstRow, std::int64_t rows) const;

  const World& world_;
  double dx_ = 0.0, h_ = 0.0;  // [m]
  Vec2 origin_{0, 0};          // of the grid [m]
  std::int64_t firstColumn_ = 0, columns_ = 0, firstRow_ = 0,
               rows_ = 0;  // window around the fluid, in cells of the grid
  double tile_ = 0.0;      // edge of a tile [m]
  std::int64_t tilesX_ = 0, tilesY_ = 0;
  std::vector<std::uint8_t> tiles_;  // not 0: the tile or one beside it holds a particle
  std::optional<double> area_, level_;
};

}  // namespace froude::run
