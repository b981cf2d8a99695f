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
             double full, const FreeBodies* bodies, FaceField& faces);
  /// Solves, changes the velocities (FaceComponent::change says by how much) and moves the free bodies, on which `drag`
  /// acts besides (by owner, may be empty). density [kg/m²].
  PressureReport project(const StepContext& context, double density, FaceField& faces,
                         std::span<const Wrench> drag = {});
  /// The same but for the bodies, which stay: what friction acts on, before `project` starts from its pressures.
  PressureReport foresee(const StepContext& context, double density, FaceField& faces);
  /// Finds how particles have to move so that no cell is over-full, and none inside the fluid under-full, and adds it
  /// to the faces' carrier. T. Kugelstadt et al., IEEE Trans. Vis. Comput. Graph. 25(2), 2019. After `project`.
  PressureReport evenOut(FaceField& faces);
  /// Largest and mean of max(0, density − 1) over the cells of fluid, and what all of them hold over their room,
  /// less 1.
  std::array<double, 3> compression() const;
  /// visit(const CutWall&, impulse on it [kg/s], point with its moment [m], place of its cell) for the walls of cells
  /// of fluid; density [kg/m²].
  template <typename Visit>
  void forEachWall(double density, Visit&& visit) const;

  std::span<const GridCell> kinds() const { return kind_.span(); }
  /// Open shares of cells.
  std::span<const float> areas() const { return area_.span(); }
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
  /// A wall of a cell of fluid, and what its pressure is made of: that of the cell's middle goes on to the wall's.
  struct Wall {
    std::uint32_t wall = 0, place = 0;
    Vec2 center{0, 0}, at{0, 0};  // about which its moment is, and a point that has the normal's [m]
    WallPressure pressure;
  };
  void findWalls(const FreeBodies* bodies);
  void findOpenings(FaceField& faces);
  void fillTile(std::size_t t, FaceField& faces);
  void listCutCells();
  void findDensity(double full, const FaceField& faces);
  void findFluid(const FaceField& faces);
  void findSurface(FaceField& faces);
  void groundSurface(const FaceField& faces);
  void findExcess(std::size_t t);
  PressureReport solve(const StepContext& context, double density, FaceField& faces, std::span<const Wrench> drag);
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
  std::vector<Wall> walls_;
  std::vector<std::uint8_t> wet_;      // by tile: holds cells of fluid
  std::vector<std::uint8_t> partial_;  // by tile: a cell in it or in a tile beside it is open in part
};

template <typename Visit>
void GridPressure::forEachWall(double density, Visit&& visit) const {
  const double unit = density * grid_.size * grid_.size * grid_.size / dt_;  // p·h·dt of κ = 1
  for (const Wall& w : walls_) {
    const CutWall& wall = cuts_->walls()[w.wall];
    Vec2 push(0.0, 0.0);
    double turn = 0.0;
    for (const WallPressure::Share& share : w.pressure.shares()) {
      push += static_cast<double>(value_[share.place]) * share.normal;
      turn += static_cast<double>(value_[share.place]) * share.moment;
    }
    const double square = push.squaredNorm();
    const Vec2 at = square > 0.0 ? Vec2(w.center + turn / square * rightNormal(push)) : w.at;
    visit(wall, Vec2(-unit * push), at, w.place);
  }
}

}  // namespace froude
