// The pressure of the grid model: what is open, which cells hold fluid, the projection of the faces' velocities, and
// what pressure does to walls.
#pragma once

#include <optional>
#include <vector>

#include <froude/base/aligned.h>
#include <froude/fields/cut_cells.h>
#include <froude/solver/coupling/obstacles.h>
#include <froude/solver/fluid/grid/face_field.h>
#include <froude/solver/fluid/grid/grid_bodies.h>
#include <froude/solver/fluid/grid/pressure_system.h>
#include <froude/solver/step_context.h>

namespace froude {

/// Finds κ = p·dt²/(ρh²) in the cells that hold particles so that nothing flows into or out of them but what moving
/// walls push. Variational where walls cut cells: C. Batty et al., ACM Trans. Graph. 26(3), 2007; Y. T. Ng et al.,
/// J. Comput. Phys. 228, 2009.
class GridPressure {
 public:
  /// Kinds of cells, open shares of faces, and where the free surface is: fluid is where particles fill half of a cell
  /// and its surroundings or more; `full` is how many fill a cell. Cost: O(tiles + cut cells in them).
  void begin(const CutGrid& grid, const CutCells& cuts, std::span<const Vec2> centers, const ParticleTiles& particles,
             double full, FaceField& faces);
  /// Solves, changes the velocities (FaceComponent::change says by how much) and moves the free bodies. density
  /// [kg/m²].
  PressureReport project(const StepContext& context, double density, FaceField& faces);
  /// Finds how particles have to move so that no cell is over-full, and none inside the fluid under-full, and adds it
  /// to the faces' carrier. T. Kugelstadt et al., IEEE Trans. Vis. Comput. Graph. 25(2), 2019. After `project`.
  PressureReport evenOut(FaceField& faces);
  /// Largest and mean of max(0, density − 1) over the cells of fluid.
  std::array<double, 2> compression() const;
  /// visit(const CutWall&, impulse on it [kg m/s], point with its moment [m], place of its cell) for the walls of cells
  /// of fluid; density [kg/m²].
  template <typename Visit>
  void forEachWall(double density, Visit&& visit) const;

  std::span<const GridCell> kinds() const { return kind_.span(); }
  /// What particles fill of cells, by what would fill them.
  std::span<const float> densities() const { return density_.span(); }
  /// κ at cell centres.
  std::span<const float> values() const { return value_.span(); }
  /// From where `project` starts; 0 after `begin`.
  std::span<float> values() { return value_.span(); }
  std::size_t memoryBytes() const;

 private:
  struct Listed {
    std::uint32_t cut, place;
  };
  void findOpenings(FaceField& faces);
  void fillTile(std::size_t t, FaceField& faces);
  void listCutCells();
  void findDensity(double full, const FaceField& faces);
  void findFluid(const FaceField& faces);
  void findSurface(FaceField& faces);
  void groundSurface(const FaceField& faces);
  void findExcess(std::size_t t);
  void findDivergence(const StepContext& context, const FaceField& faces);
  void findJumps(const AlignedArray<float>& kappa, float speed, const float* solvedX, const float* solvedY,
                 float* changeX, float* changeY) const;

  CutGrid grid_;
  const CutCells* cuts_ = nullptr;
  const TileGrid* tiles_ = nullptr;
  std::vector<Vec2> centers_;  // about which a body's moments are, by body
  AlignedArray<GridCell> kind_;
  PressureCoefficients coefficients_;
  std::optional<PressureSystem> system_;
  GridBodies bodies_;
  double dt_ = 1.0;
  std::array<const float*, 2> open_{};  // of the faces
  AlignedArray<float> value_, right_, shift_;
  AlignedArray<float> area_;             // open share of a cell
  AlignedArray<float> density_;          // by what particles would fill
  AlignedArray<float> steepX_, steepY_;  // 1, or at a free surface 1/(how far it is from the fluid's cell)
  std::vector<Listed> listed_;           // cut cells of the tiles
  std::vector<std::uint8_t> wet_;        // by tile: holds cells of fluid
  std::vector<std::uint8_t> partial_;    // by tile: a cell in it or in a tile beside it is open in part
};

template <typename Visit>
void GridPressure::forEachWall(double density, Visit&& visit) const {
  for (const Listed& l : listed_) {
    if (kind_[l.place] != GridCell::Fluid) continue;
    const CutPart& part = cuts_->parts()[cuts_->cells()[l.cut].part];
    for (std::uint32_t w = part.wall; w < part.wall + part.wallCount; ++w) {
      const CutWall& wall = cuts_->walls()[w];
      const double square = wall.normal.squaredNorm();
      if (square == 0.0) continue;
      const Vec2 center = wall.body < 0 ? grid_.origin : centers_[static_cast<std::size_t>(wall.body)];
      const Vec2 at = center + wall.moment / square * rightNormal(wall.normal);
      // p·h·dt
      const double strength =
          density * grid_.size * grid_.size * grid_.size / dt_ * static_cast<double>(value_[l.place]);
      visit(wall, Vec2(-strength * wall.normal), at, l.place);
    }
  }
}

}  // namespace froude
