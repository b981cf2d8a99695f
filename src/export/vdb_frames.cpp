#include "export/vdb_frames.h"

#include <froude/base/assert.h>

#include "export/frames.h"
#include "run/atomic_file.h"

#if FROUDE_HAS_OPENVDB
#include <froude/fields/openvdb/frame_file.h>
#include <froude/fields/openvdb/level_set.h>

#include <algorithm>
#include <optional>
#include <vector>

#include <froude/base/parallel.h>
#endif

namespace froude::exporting {

#if FROUDE_HAS_OPENVDB

namespace {

// Along the longer side of the domain: finer level sets would outweigh the particles.
constexpr double kMostVoxels = 1024.0;
constexpr double kVoxelsWithoutFluid = 512.0;
constexpr std::uint64_t kIdMask = 0x7fffffff;

double levelSetVoxel(const WorldDef& def) {
  const double side = def.domain.box.size().maxCoeff();
  return def.fluid ? std::max(def.fluid->spacing, side / kMostVoxels) : side / kVoxelsWithoutFluid;
}

/// The level set of the polygons that move, or of those that do not, where they are; nothing without any.
std::optional<vdb::LevelSet> levelSetOf(const World& world, bool moving) {
  std::vector<Polygon> polygons;
  for (std::size_t b = 0; b < world.bodyCount(); ++b) {
    const BodyDef& body = world.bodyDefinition(b);
    if ((body.motion != Motion::Fixed) == moving) polygons.push_back(body.shape->transformed(world.body(b).transform));
  }
  if (polygons.empty()) return std::nullopt;
  return vdb::LevelSet(polygons, levelSetVoxel(world.definition()));
}

struct Kind {
  std::int32_t species;
  double restDensity, radius;
};

void fill(vdb::Points& points, std::size_t first, const ParticlePool& pool, const Kind& kind) {
  const auto x = pool.x(), y = pool.y(), vx = pool.vx(), vy = pool.vy();
  const auto birth = pool.birth();
  const auto p = pool.findColumn<float>("pressure"), d = pool.findColumn<float>("density");
  const bool fluid = kind.species == 0;
  parallelFor(pool.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const std::size_t o = first + i;
      points.position[o] = {x[i], y[i]};
      points.velocity[o] = {vx[i], vy[i]};
      const double pressure = fluid && p ? static_cast<double>(pool.column(*p)[i]) : 0.0;
      const double relative = fluid && d ? static_cast<double>(pool.column(*d)[i]) : 1.0;
      points.pressure[o] = static_cast<float>(kind.restDensity * pressure);
      points.density[o] = static_cast<float>(kind.restDensity * relative);
      points.radius[o] = static_cast<float>(kind.radius);
      points.species[o] = kind.species;
      points.id[o] = static_cast<std::int32_t>(birth[i] & kIdMask);
    }
  });
}

}  // namespace

std::string openVdbVersion() { return vdb::version(); }

struct VdbFrames::Impl {
  std::optional<vdb::LevelSet> obstacles;
};

VdbFrames::VdbFrames(const World& world) : impl_(std::make_unique<Impl>(Impl{levelSetOf(world, false)})) {}

void VdbFrames::write(const std::string& file, const World& world, int index) const {
  const WorldDef& def = world.definition();
  const ParticlePool *fluid = world.fluid(), *bullets = world.bullets();
  const std::size_t fluidCount = fluid != nullptr ? fluid->size() : 0;
  vdb::FrameContents contents;
  contents.label = {world.time(), index, "m"};
  contents.points.resize(fluidCount + (bullets != nullptr ? bullets->size() : 0));
  if (fluid != nullptr) {
    fill(contents.points, 0, *fluid, {0, def.fluid->density, 0.5 * def.fluid->spacing});
    contents.fogVoxel = def.fluid->spacing;
    contents.particleArea = def.fluid->spacing * def.fluid->spacing;
  }
  if (bullets != nullptr) fill(contents.points, fluidCount, *bullets, {1, def.bullet->density, def.bullet->radius});
  const std::optional<vdb::LevelSet> bodies = levelSetOf(world, true);
  if (impl_->obstacles) contents.levelSets["obstacles"] = &*impl_->obstacles;
  if (bodies) contents.levelSets["bodies"] = &*bodies;
  run::PendingFile pending(file);
  try {
    vdb::writeFrame(pending.path(), contents);
  } catch (const Error& e) {
    throw OutputError(e.what());
  }
  pending.commit();
}

#else

std::string openVdbVersion() { return {}; }

struct VdbFrames::Impl {};

VdbFrames::VdbFrames(const World&) { FROUDE_ASSERT(kHasOpenVdb); }

void VdbFrames::write(const std::string& file, const World&, int) const {
  throw OutputError(file + ": this build of Froude has no OpenVDB");
}

#endif

VdbFrames::~VdbFrames() = default;

}  // namespace froude::exporting
