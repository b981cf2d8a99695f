// The one file that includes OpenVDB: level sets from meshes, and .vdb files. It compiles slowly; nothing else belongs
// here. Points are put into their leaves by hand: OpenVDB's own conversion takes as long to compile as all the rest.
#include <openvdb/io/File.h>
#include <openvdb/openvdb.h>
#include <openvdb/points/PointDataGrid.h>
#include <openvdb/tools/Interpolation.h>
#include <openvdb/tools/MeshToVolume.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <tuple>

#include <froude/base/assert.h>
#include <froude/fields/openvdb/frame_file.h>
#include <froude/fields/openvdb/level_set.h>
#include <froude/fields/openvdb/prism.h>

namespace froude::vdb {
namespace {

namespace vdb = openvdb;
using vdb::points::PointDataGrid;
using vdb::points::PointDataTree;
using PointLeaf = PointDataTree::LeafNodeType;
using vdb::points::AttributeSet;
using vdb::points::AttributeWriteHandle;

constexpr double kMostVoxels = 8192.0;  // along a side
constexpr double kMostBand = 100.0;     // [voxels]
// Caps lie so much beyond the band [voxels]: farther than any node of the middle plane looks.
constexpr double kCapMargin = 2.0;
// Where the grid of nodes lies against the polygons' centre [voxels]: nowhere in particular, so that no edge of a box
// runs along a row of nodes, which would be exact by chance and on no side.
const Vec2 kGridOffset(0.381966, 0.276393);
constexpr double kPointsPerVoxel = 16.0;

/// Registers OpenVDB's types, once.
void open() {
  static const bool kDone = (vdb::initialize(), true);
  static_cast<void>(kDone);
}

vdb::math::Transform::Ptr voxels(double size, const Vec2& origin) {
  vdb::math::Transform::Ptr transform = vdb::math::Transform::createLinearTransform(size);
  transform->postTranslate(vdb::Vec3d(origin.x(), origin.y(), 0.0));
  return transform;
}

Box boundsOf(std::span<const Polygon> polygons) {
  Box box;
  for (const Polygon& polygon : polygons) box.include(polygon.bounds());
  return box;
}

vdb::FloatGrid::Ptr buildLevelSet(std::span<const Polygon> polygons, double size, double halfBand) {
  if (polygons.empty()) throw Error("a level set of no polygon; right is one or more");
  if (!(size > 0.0 && std::isfinite(size)))
    throw Error("a level set with voxels of " + std::to_string(size) + " m; right is a positive, finite size");
  if (!(halfBand >= 1.0 && halfBand <= kMostBand))
    throw Error("a level set with a half band of " + std::to_string(halfBand) + " voxels; right is 1 to 100");
  const Box box = boundsOf(polygons);
  const double side = box.size().maxCoeff();
  if (side > kMostVoxels * size)
    throw Error("a level set with more than 8192 voxels along a side; right are voxels of at least " +
                std::to_string(side / kMostVoxels) + " m");
  open();
  const Vec2 origin = box.center() + size * kGridOffset;
  QuadMesh mesh;
  for (const Polygon& polygon : polygons) addPrism(polygon, origin, size, (halfBand + kCapMargin) * size, mesh);
  std::vector<vdb::Vec3s> points;
  std::vector<vdb::Vec4I> quads;
  points.reserve(mesh.vertices.size());
  quads.reserve(mesh.faces.size());
  for (const auto& v : mesh.vertices) points.emplace_back(v[0], v[1], v[2]);
  for (const auto& f : mesh.faces)
    quads.emplace_back(f[0], f[1], f[2], f[3] == QuadMesh::kNoVertex ? vdb::util::INVALID_IDX : f[3]);
  vdb::util::NullInterrupter never;
  // Renormalisation mends meshes that cross themselves; these do not, and their distances are exact as they are.
  return vdb::tools::meshToVolume<vdb::FloatGrid>(
      never, vdb::tools::QuadAndTriangleDataAdapter<vdb::Vec3s, vdb::Vec4I>(points, quads), *voxels(size, origin),
      static_cast<float>(halfBand), static_cast<float>(halfBand), vdb::tools::DISABLE_RENORMALIZATION, nullptr);
}

/// The interpolant with its accessor, at points of the middle plane.
class Reader {
 public:
  explicit Reader(const vdb::FloatGrid& grid) : transform_(grid.transform()), accessor_(grid.getConstAccessor()) {}
  vdb::Vec3d toIndex(const Vec2& p) const { return transform_.worldToIndex(vdb::Vec3d(p.x(), p.y(), 0.0)); }
  double at(const vdb::Vec3d& index) const {
    return static_cast<double>(vdb::tools::BoxSampler::sample(accessor_, index));
  }
  double distance(const Vec2& p) const { return at(toIndex(p)); }
  Vec2 normal(const Vec2& p) const {
    const vdb::Vec3d i = toIndex(p), x(0.5, 0.0, 0.0), y(0.0, 0.5, 0.0);
    const Vec2 gradient(at(i + x) - at(i - x), at(i + y) - at(i - y));
    const double length = gradient.norm();
    return length > 0.0 ? Vec2(gradient / length) : Vec2(0.0, 0.0);
  }

 private:
  const vdb::math::Transform& transform_;
  vdb::FloatGrid::ConstAccessor accessor_;
};

}  // namespace

std::string version() { return vdb::getLibraryVersionString(); }

struct LevelSet::Impl {
  vdb::FloatGrid::Ptr grid;
};

LevelSet::LevelSet(const Polygon& polygon, double voxelSize, double halfBand)
    : LevelSet(std::span<const Polygon>(&polygon, 1), voxelSize, halfBand) {}
LevelSet::LevelSet(std::span<const Polygon> polygons, double voxelSize, double halfBand)
    : impl_(std::make_unique<Impl>(buildLevelSet(polygons, voxelSize, halfBand))) {}
LevelSet::LevelSet(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
LevelSet::LevelSet(LevelSet&&) noexcept = default;
LevelSet& LevelSet::operator=(LevelSet&&) noexcept = default;
LevelSet::~LevelSet() = default;

double LevelSet::distance(const Vec2& p) const { return Reader(*impl_->grid).distance(p); }
Vec2 LevelSet::normal(const Vec2& p) const { return Reader(*impl_->grid).normal(p); }

void LevelSet::sample(std::span<const Vec2> points, std::span<double> distances) const {
  FROUDE_ASSERT(points.size() == distances.size());
  const Reader reader(*impl_->grid);
  for (std::size_t i = 0; i < points.size(); ++i) distances[i] = reader.distance(points[i]);
}

void LevelSet::normals(std::span<const Vec2> points, std::span<Vec2> normals) const {
  FROUDE_ASSERT(points.size() == normals.size());
  const Reader reader(*impl_->grid);
  for (std::size_t i = 0; i < points.size(); ++i) normals[i] = reader.normal(points[i]);
}

double LevelSet::voxelSize() const { return impl_->grid->voxelSize()[0]; }
double LevelSet::halfBand() const { return static_cast<double>(impl_->grid->background()); }
std::size_t LevelSet::activeVoxels() const { return impl_->grid->activeVoxelCount(); }
std::size_t LevelSet::memoryBytes() const { return impl_->grid->memUsage(); }

void Points::resize(std::size_t count) {
  position.resize(count);
  velocity.resize(count);
  for (auto* column : {&pressure, &density, &radius}) column->resize(count);
  for (auto* column : {&species, &id}) column->resize(count);
}

namespace {

enum Attribute : std::size_t { kP, kV, kPressure, kDensity, kScale, kSpecies, kId };

AttributeSet::Descriptor::Ptr attributes() {
  const vdb::NamePair vector = vdb::points::TypedAttributeArray<vdb::Vec3f>::attributeType();
  const vdb::NamePair real = vdb::points::TypedAttributeArray<float>::attributeType();
  const vdb::NamePair whole = vdb::points::TypedAttributeArray<std::int32_t>::attributeType();
  AttributeSet::Descriptor::Ptr list = AttributeSet::Descriptor::create(vector);  // P
  list = list->duplicateAppend("v", vector);
  for (const char* name : {"pressure", "density", "pscale"}) list = list->duplicateAppend(name, real);
  for (const char* name : {"species", "id"}) list = list->duplicateAppend(name, whole);
  return list;
}

/// Where a point belongs: which leaf, which voxel in it, and its number in the columns; sorts in the order of the file.
struct Place {
  std::int32_t x, y;  // origin of the leaf [voxels]
  std::uint32_t voxel, point;
  bool operator<(const Place& o) const { return std::tie(x, y, voxel, point) < std::tie(o.x, o.y, o.voxel, o.point); }
};

std::vector<Place> placesOf(const Points& points, const vdb::math::Transform& transform) {
  constexpr std::int32_t kInner = PointLeaf::DIM - 1;
  std::vector<Place> places(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec2& p = points.position[i];
    const vdb::Coord at = transform.worldToIndexCellCentered(vdb::Vec3d(p.x(), p.y(), 0.0));
    places[i] = {at.x() & ~kInner, at.y() & ~kInner, PointLeaf::coordToOffset(at), static_cast<std::uint32_t>(i)};
  }
  std::sort(places.begin(), places.end());
  return places;
}

template <typename T, typename Value>
void fill(PointLeaf& leaf, Attribute attribute, std::span<const Place> places, Value value) {
  AttributeWriteHandle<T> handle(leaf.attributeArray(attribute));
  for (std::size_t k = 0; k < places.size(); ++k) handle.set(static_cast<vdb::Index>(k), value(places[k].point));
  handle.compact();  // one value for all is kept once
}

void fillLeaf(PointLeaf& leaf, std::span<const Place> places, const Points& points,
              const vdb::math::Transform& transform) {
  std::vector<PointLeaf::ValueType> ends(PointLeaf::SIZE, 0);
  for (const Place& place : places) ends[place.voxel] = ends[place.voxel] + 1;
  for (std::size_t v = 1; v < ends.size(); ++v) ends[v] = ends[v] + ends[v - 1];
  leaf.setOffsets(ends);
  fill<vdb::Vec3f>(leaf, kP, places, [&](std::uint32_t i) {
    const Vec2& p = points.position[i];
    const vdb::Vec3d index = transform.worldToIndex(vdb::Vec3d(p.x(), p.y(), 0.0));
    return vdb::Vec3f(index - transform.worldToIndexCellCentered(vdb::Vec3d(p.x(), p.y(), 0.0)).asVec3d());
  });
  fill<vdb::Vec3f>(leaf, kV, places, [&](std::uint32_t i) {
    return vdb::Vec3f(static_cast<float>(points.velocity[i].x()), static_cast<float>(points.velocity[i].y()), 0.0f);
  });
  fill<float>(leaf, kPressure, places, [&](std::uint32_t i) { return points.pressure[i]; });
  fill<float>(leaf, kDensity, places, [&](std::uint32_t i) { return points.density[i]; });
  fill<float>(leaf, kScale, places, [&](std::uint32_t i) { return points.radius[i]; });
  fill<std::int32_t>(leaf, kSpecies, places, [&](std::uint32_t i) { return points.species[i]; });
  fill<std::int32_t>(leaf, kId, places, [&](std::uint32_t i) { return points.id[i]; });
}

/// Voxels that hold some 16 points each if these are spread evenly; 1 m where they have no extent.
double pointVoxel(const Points& points) {
  Box box;
  for (const Vec2& p : points.position) box.include(p);
  if (points.size() == 0) return 1.0;
  const Vec2 size = box.size();
  const double count = static_cast<double>(points.size());
  const double voxel =
      std::max(std::sqrt(size.x() * size.y() * kPointsPerVoxel / count), size.maxCoeff() * kPointsPerVoxel / count);
  return voxel > 0.0 ? voxel : 1.0;
}

PointDataGrid::Ptr particleGrid(const Points& points) {
  const PointDataTree::Ptr tree = std::make_shared<PointDataTree>();
  const vdb::math::Transform::Ptr transform = vdb::math::Transform::createLinearTransform(pointVoxel(points));
  const std::vector<Place> places = placesOf(points, *transform);
  const AttributeSet::Descriptor::Ptr descriptor = attributes();
  for (std::size_t begin = 0; begin < places.size();) {
    std::size_t end = begin;
    while (end < places.size() && places[end].x == places[begin].x && places[end].y == places[begin].y) ++end;
    PointLeaf& leaf = *tree->touchLeaf(vdb::Coord(places[begin].x, places[begin].y, 0));
    leaf.replaceAttributeSet(new AttributeSet(descriptor, static_cast<vdb::Index>(end - begin)), true);  // it owns it
    fillLeaf(leaf, std::span(places).subspan(begin, end - begin), points, *transform);
    begin = end;
  }
  PointDataGrid::Ptr grid = PointDataGrid::create(tree);
  grid->setTransform(transform);
  return grid;
}

vdb::FloatGrid::Ptr fogGrid(const FrameContents& contents) {
  const vdb::FloatGrid::Ptr grid = vdb::FloatGrid::create(0.0f);
  grid->setTransform(vdb::math::Transform::createLinearTransform(contents.fogVoxel));
  grid->setGridClass(vdb::GRID_FOG_VOLUME);
  vdb::FloatGrid::Accessor accessor = grid->getAccessor();
  const double part = contents.particleArea / (contents.fogVoxel * contents.fogVoxel);
  for (std::size_t i = 0; i < contents.points.size(); ++i) {
    if (contents.points.species[i] != 0) continue;
    const Vec2 at = contents.points.position[i] / contents.fogVoxel;
    const Vec2 low = at.array().floor(), f = at - low;
    for (int k = 0; k < 4; ++k) {
      const int x = k & 1, y = k >> 1;
      const double share = (x != 0 ? f.x() : 1.0 - f.x()) * (y != 0 ? f.y() : 1.0 - f.y()) * part;
      const vdb::Coord voxel(static_cast<int>(low.x()) + x, static_cast<int>(low.y()) + y, 0);
      accessor.setValue(voxel, accessor.getValue(voxel) + static_cast<float>(share));
    }
  }
  return grid;
}

void writeLabel(vdb::MetaMap& meta, const FrameLabel& label) {
  meta.insertMeta("time", vdb::DoubleMetadata(label.time));
  meta.insertMeta("frame", vdb::Int32Metadata(label.frame));
  meta.insertMeta("unit", vdb::StringMetadata(label.unit));
}

void readPoints(const PointDataGrid& grid, Points& points) {
  using vdb::points::AttributeHandle;
  for (PointDataTree::LeafCIter leaf = grid.constTree().cbeginLeaf(); leaf; ++leaf) {
    const AttributeHandle<vdb::Vec3f> p(leaf->constAttributeArray("P")), v(leaf->constAttributeArray("v"));
    const AttributeHandle<float> pressure(leaf->constAttributeArray("pressure")),
        density(leaf->constAttributeArray("density")), radius(leaf->constAttributeArray("pscale"));
    const AttributeHandle<std::int32_t> species(leaf->constAttributeArray("species")),
        id(leaf->constAttributeArray("id"));
    for (vdb::Index voxel = 0, k = 0; voxel < PointLeaf::SIZE; ++voxel)
      for (const vdb::Index end = leaf->getValue(voxel); k < end; ++k) {
        const vdb::Vec3d at =
            grid.transform().indexToWorld(leaf->offsetToGlobalCoord(voxel).asVec3d() + vdb::Vec3d(p.get(k)));
        points.position.emplace_back(at.x(), at.y());
        points.velocity.emplace_back(static_cast<double>(v.get(k).x()), static_cast<double>(v.get(k).y()));
        points.pressure.push_back(pressure.get(k));
        points.density.push_back(density.get(k));
        points.radius.push_back(radius.get(k));
        points.species.push_back(species.get(k));
        points.id.push_back(id.get(k));
      }
  }
}

/// What io::File writes, into a stream of ours: io::File says nothing of a disk that is full.
struct Archive : vdb::io::Archive {
  using vdb::io::Archive::write;
};

}  // namespace

/// Both ways between files and what this program keeps.
struct GridFile {
  static void write(const std::string& name, const FrameContents& contents) {
    vdb::GridPtrVec grids;
    const auto add = [&](const std::string& title, const vdb::GridBase::Ptr& grid) {
      grid->setName(title);
      writeLabel(*grid, contents.label);
      grids.push_back(grid);
    };
    add("particles", particleGrid(contents.points));
    if (contents.fogVoxel > 0.0) add("density", fogGrid(contents));
    // The values are shared, name and label are this file's own.
    for (const auto& [title, set] : contents.levelSets) add(title, set->impl_->grid->copy());
    vdb::MetaMap meta;
    writeLabel(meta, contents.label);
    meta.insertMeta("creator", vdb::StringMetadata("Froude"));
    std::ofstream file(name, std::ios::binary | std::ios::trunc);
    if (file) Archive().write(file, grids, /*with places of grids*/ true, meta);
    file.close();
    if (!file) throw Error(name + ": cannot be written: " + std::strerror(errno));
  }

  static FrameRead read(const std::string& name) {
    FrameRead found;
    vdb::io::File file(name);
    file.open(/*delayed loading*/ false);
    const vdb::MetaMap::Ptr meta = file.getMetadata();
    found.label.time = meta->metaValue<double>("time");
    found.label.frame = meta->metaValue<std::int32_t>("frame");
    found.label.unit = meta->metaValue<std::string>("unit");
    const vdb::GridPtrVecPtr grids = file.getGrids();
    for (const vdb::GridBase::Ptr& grid : *grids) {
      if (const auto points = vdb::gridPtrCast<PointDataGrid>(grid)) {
        found.pointVoxel = points->voxelSize()[0];
        readPoints(*points, found.points);
      } else if (const auto values = vdb::gridPtrCast<vdb::FloatGrid>(grid)) {
        if (values->getGridClass() == vdb::GRID_LEVEL_SET) {
          found.levelSets.emplace(grid->getName(), LevelSet(std::make_unique<LevelSet::Impl>(LevelSet::Impl{values})));
          continue;
        }
        double sum = 0.0;
        for (auto value = values->cbeginValueOn(); value; ++value) sum += static_cast<double>(*value);
        found.fogArea = sum * values->voxelSize()[0] * values->voxelSize()[1];
      }
    }
    return found;
  }
};

void writeFrame(const std::string& file, const FrameContents& contents) {
  open();
  try {
    GridFile::write(file, contents);
  } catch (const vdb::Exception& e) {
    throw Error(file + ": cannot be written: " + e.what());
  }
}

FrameRead readFrame(const std::string& file) {
  open();
  try {
    return GridFile::read(file);
  } catch (const vdb::Exception& e) {
    throw Error(file + ": is no frame that can be read: " + e.what());
  }
}

}  // namespace froude::vdb
