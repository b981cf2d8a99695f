// Polygons and particles without a world: a star is filled, what lies near its edge is painted, a sink takes some away.
#include <froude/fields/distance_field.h>
#include <froude/particles/fill.h>
#include <froude/particles/pool.h>
#include <froude/particles/sink.h>
#include <froude/version.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <vector>

namespace {

void require(bool condition, const char* what) {
  if (condition) return;
  std::fprintf(stderr, "lattice: not so: %s\n", what);
  std::exit(1);
}

froude::Polygon star(int points, double outer, double inner) {
  std::vector<froude::Vec2> ring;
  for (int k = 0; k < 2 * points; ++k) {
    const double angle = froude::kPi * k / points, radius = k % 2 == 0 ? outer : inner;
    ring.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
  }
  return froude::Polygon::make(ring);
}

}  // namespace

int main() {
  const froude::Polygon shape = star(5, 1.0, 0.4);
  const double spacing = 0.01;  // m
  const froude::FillResult filled = froude::fillLattice(shape, spacing);

  froude::ParticlePool pool({4096, froude::GrowthPolicy::Grow, "lattice"});
  const auto depth = pool.addColumn<float>("depth", froude::ColumnKind::State);  // ours, sorted and saved with the rest
  std::vector<froude::ParticleHandle> handles;
  for (const froude::Vec2& point : filled.points) {
    handles.push_back(pool.create());
    pool.x()[pool.size() - 1] = point.x();
    pool.y()[pool.size() - 1] = point.y();
  }

  const froude::DistanceField field(shape, 0.1);  // exact within 0.1 m of the edge, on both sides
  std::size_t near = 0;
  for (std::size_t i = 0; i < pool.size(); ++i) {
    const froude::FieldSample sample = field.sampleExact({pool.x()[i], pool.y()[i]});
    pool.column(depth)[i] = static_cast<float>(-sample.distance);
    near += sample.distance > -0.05 ? 1 : 0;
  }

  froude::SinkSet sinks;
  sinks.add(froude::Polygon::box({{0.5, -1.0}, {1.0, 1.0}}));
  const std::size_t marked = sinks.mark(pool);
  pool.compact();

  std::size_t alive = 0;
  for (const froude::ParticleHandle handle : handles) {
    const auto index = pool.indexOf(handle);  // empty once the particle is gone, whoever has its slot now
    if (!index) continue;
    ++alive;
    const double exact = -field.sampleExact({pool.x()[*index], pool.y()[*index]}).distance;
    require(std::abs(pool.column(depth)[*index] - exact) < 1e-6, "the column stayed with its particle");
  }
  require(alive == pool.size() && alive + marked == filled.points.size(), "who is not alive was taken by the sink");
  require(std::abs(static_cast<double>(filled.points.size()) * spacing * spacing / shape.area() - 1.0) < 0.01,
          "the particles cover the shape's area");
  try {
    static_cast<void>(froude::Polygon::make({{0, 0}, {1, 1}, {1, 0}, {0, 1}}));
    require(false, "a ring that crosses itself is refused");
  } catch (const froude::Error& error) {
    std::printf("refused: %s\n", error.what());
  }
  std::printf("froude %s: %zu particles, %zu near the edge, %zu taken by the sink\n", FROUDE_VERSION,
              filled.points.size(), near, marked);
}
