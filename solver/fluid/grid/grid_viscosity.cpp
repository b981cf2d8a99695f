#include <froude/solver/fluid/grid/grid_viscosity.h>

#include <Eigen/LU>

namespace froude {
namespace {

// Velocity left to be found, of the scene's largest.
constexpr double kTolerance = 1e-5;

}  // namespace

int GridViscosity::smooth(const StepContext& context, const CutGrid& grid, double density, double viscosity,
                          const GridPressure& pressure, FaceField& faces) {
  const TileGrid& tiles = faces.tiles();
  const double k = viscosity * context.dt / (grid.size * grid.size), cellMass = density * grid.size * grid.size;
  coefficients_.fromCells(tiles, pressure.kinds().data(), pressure.areas().data(), faces.x.open.data(),
                          faces.y.open.data());
  findHolds(context, grid, pressure, tiles);
  findBodies(context, cellMass, k);
  holdClosed(context, grid, pressure, faces);
  const double speed = context.maxSpeed + context.dt * context.acceleration;
  const int iterations = system_
                             .solve(tiles, coefficients_, k, faces.x.value.data(), faces.y.value.data(),
                                    static_cast<float>(kTolerance * speed), 500, viscous_)
                             .iterations;
  for (const Closed& c : closed_) *c.value = c.before;
  findImpulses(context, cellMass * k, faces);
  return iterations;
}

// A closed face of a cell of fluid moves as the wall behind it: the cell's stretch counts from there.
void GridViscosity::holdClosed(const StepContext& context, const CutGrid& grid, const GridPressure& pressure,
                               FaceField& faces) {
  closed_.clear();
  const TileGrid& tiles = faces.tiles();
  pressure.forEachWall(1.0, [&](const CutWall& wall, const Vec2&, const Vec2&, std::size_t place) {
    const auto [i, j] = tiles.cell(place);
    auto hold = [&](FaceComponent& c, std::size_t face, int axis, double towards, const Vec2& at) {
      if (c.open[face] > 0.0f || !(towards * wall.normal[axis] < 0.0) || face < TileGrid::kCells) return;
      closed_.push_back({&c.value[face], c.value[face]});
      c.value[face] = static_cast<float>(context.obstacles.velocityAt(wall.body, at)[axis]);
    };
    const Vec2 corner = grid.origin + grid.size * Vec2(i, j);
    const double h = grid.size;
    hold(faces.x, place, 0, -1.0, corner + Vec2(0.0, 0.5 * h));
    hold(faces.x, tiles.place(i + 1, j), 0, 1.0, corner + Vec2(h, 0.5 * h));
    hold(faces.y, place, 1, -1.0, corner + Vec2(0.5 * h, 0.0));
    hold(faces.y, tiles.place(i, j + 1), 1, 1.0, corner + Vec2(0.5 * h, h));
  });
}

void GridViscosity::findHolds(const StepContext& context, const CutGrid& grid, const GridPressure& pressure,
                              const TileGrid& tiles) {
  holds_.clear();
  if (!context.obstacles.anySticks()) return;
  pressure.forEachWall(1.0, [&](const CutWall& wall, const Vec2&, const Vec2&, std::size_t place) {
    if (!context.obstacles.sticks(wall.body)) return;
    const auto [i, j] = tiles.cell(place);
    const Vec2 normal = wall.normal.normalized(), at = grid.origin + grid.size * (Vec2(i, j) + wall.middle);
    const Vec2 surface = context.obstacles.surfaceVelocityAt(wall.body, at, normal);
    for (const HeldFace& face :
         coefficients_.addWall(tiles, {place, wall.normal.norm(), normal, wall.middle, surface})) {
      holds_.push_back({face, wall.body, at, surface, Vec2(0.0, 0.0)});
    }
  });
}

// In a turn lengths are metres; a hinged body has that freedom alone.
void GridViscosity::findBodies(const StepContext& context, double cellMass, double k) {
  bodyCount_ = 0;
  viscous_.clear();
  drag_.clear();
  const FreeBodies* bodies = context.freeBodies;
  if (bodies == nullptr || holds_.empty()) return;
  bodyOf_.assign(bodies->count(), -1);
  for (const Hold& hold : holds_) {
    if (!bodies->isFree(hold.owner)) continue;
    std::int32_t& index = bodyOf_[static_cast<std::size_t>(hold.owner)];
    const std::optional<Vec2> arm = bodies->hingeArm(hold.owner);
    const Vec2 center = bodies->center(hold.owner), pivot = arm ? Vec2(center - *arm) : center;
    if (index < 0) {
      index = static_cast<std::int32_t>(bodyCount_);
      if (bodies_.size() <= bodyCount_) bodies_.emplace_back();
      Body& body = bodies_[bodyCount_++];
      const MassData& mass = bodies->mass(hold.owner);
      body.owner = hold.owner;
      body.entries.clear();
      body.mass.setZero();
      body.mass(0, 0) = body.mass(1, 1) = arm ? 1.0 : mass.mass / cellMass;  // a hinged body's are not moved
      body.mass(2, 2) = (mass.inertia + (arm ? mass.mass * arm->squaredNorm() : 0.0)) / cellMass;
    }
    Body& body = bodies_[static_cast<std::size_t>(index)];
    const Vec2 turned = leftNormal(Vec2(hold.at - pivot));
    const auto c = static_cast<int>(hold.face.component);
    Eigen::Vector3d j(0.0, 0.0, turned[c]);
    if (!arm) j[c] = 1.0;
    body.entries.push_back({hold.face.component, hold.face.place, hold.face.g, hold.surface[c], j});
    body.mass += k * hold.face.g * j * j.transpose();
  }
  for (std::size_t b = 0; b < bodyCount_; ++b) {
    viscous_.push_back({k * bodies_[b].mass.inverse(), bodies_[b].entries});
  }
  if (bodyCount_ > 0) drag_.assign(bodies->count(), Wrench{0.0, 0.0, 0.0});
}

void GridViscosity::findImpulses(const StepContext& context, double strength, const FaceField& faces) {
  const float *u = faces.x.value.data(), *v = faces.y.value.data();
  gained_.clear();
  for (const ViscousBody& body : viscous_) gained_.push_back(body.gained(u, v, 1.0));
  next_.assign(bodyCount_, 0);  // entries stand in the order of holds
  for (Hold& hold : holds_) {
    const auto c = static_cast<int>(hold.face.component);
    double slide = static_cast<double>((c == 0 ? u : v)[hold.face.place]) - hold.surface[c];
    const std::int32_t index = bodyCount_ > 0 && hold.owner >= 0 ? bodyOf_[static_cast<std::size_t>(hold.owner)] : -1;
    if (index >= 0) {
      const auto b = static_cast<std::size_t>(index);
      slide -= viscous_[b].entries[next_[b]++].j.dot(gained_[b]);
    }
    hold.impulse = Vec2(0.0, 0.0);
    hold.impulse[c] = strength * hold.face.g * slide;
    if (index < 0) continue;
    Wrench& drag = drag_[static_cast<std::size_t>(hold.owner)];
    drag[0] += hold.impulse.x();
    drag[1] += hold.impulse.y();
    drag[2] += cross(Vec2(hold.at - context.freeBodies->center(hold.owner)), hold.impulse);
  }
}

void GridViscosity::book(ImpulseLedger& impulses, Vec2& rest) const {
  for (const Hold& hold : holds_) {
    impulses.add(hold.owner, hold.at, hold.impulse, hold.surface);
    rest -= hold.impulse;
  }
}

}  // namespace froude
