#include "export/segments.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string_view>

#include <froude/base/parallel.h>
#include "export/frames.h"
#include "export/soft_surface.h"
#include "run/atomic_file.h"

namespace froude::exporting {
namespace {

constexpr std::size_t kGrowth = 8 << 20;        // of a segment in memory [bytes]
constexpr std::size_t kIndexGrowth = 64 << 10;  // [bytes]
constexpr double kPositionError = 1e-3;         // of the smallest length
constexpr const char* kVertices = "vertices";

/// The columns of a frame, fluid first.
struct Columns {
  std::vector<double> position64;
  std::vector<float> position32, velocity, pressure, density;
  std::vector<std::uint8_t> species;
  std::vector<std::uint32_t> id;

  Columns(std::size_t count, bool wide)
      : position64(wide ? 2 * count : 0),
        position32(wide ? 0 : 2 * count),
        velocity(2 * count),
        pressure(count),
        density(count),
        species(count),
        id(count) {}

  void fill(const ParticlePool& pool, std::size_t first, std::uint8_t kind, double restDensity) {
    const auto x = pool.x(), y = pool.y(), vx = pool.vx(), vy = pool.vy();
    const auto birth = pool.birth();
    const auto p = pool.findColumn<float>("pressure"), d = pool.findColumn<float>("density");
    const bool fluid = kind == 0;
    parallelFor(pool.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const std::size_t o = first + i;
        if (!position64.empty()) {
          position64[2 * o] = x[i];
          position64[2 * o + 1] = y[i];
        } else {
          position32[2 * o] = static_cast<float>(x[i]);
          position32[2 * o + 1] = static_cast<float>(y[i]);
        }
        velocity[2 * o] = static_cast<float>(vx[i]);
        velocity[2 * o + 1] = static_cast<float>(vy[i]);
        pressure[o] = fluid && p ? static_cast<float>(restDensity * static_cast<double>(pool.column(*p)[i])) : 0.0f;
        const double relative = fluid && d ? static_cast<double>(pool.column(*d)[i]) : 1.0;
        density[o] = static_cast<float>(restDensity * relative);
        species[o] = kind;
        id[o] = static_cast<std::uint32_t>(birth[i]);
      }
    });
  }

  void fillSoft(const World& world, std::size_t first) {
    fill(*world.soft(), first, 2, 0.0);
    for (std::size_t body = 0; body < world.softCount(); ++body) {
      const SoftDef& def = world.softDefinition(body);
      const auto begin = density.begin() + static_cast<std::ptrdiff_t>(first + world.softFirst(body));
      std::fill_n(begin, def.mesh->points.size(), static_cast<float>(def.density));
    }
  }
};

/// Numbers of the surface are moved on to those of the frame's particles.
void writeSurface(hid_t group, SoftSurface& surface, std::uint32_t first) {
  for (auto& triangle : surface.triangles)
    for (std::uint32_t& corner : triangle) corner += first;
  for (auto& link : surface.links)
    for (std::uint32_t& end : link) end += first;
  const hid_t u32 = H5T_NATIVE_UINT32, u32le = H5T_STD_U32LE, f32 = H5T_NATIVE_FLOAT, f32le = H5T_IEEE_F32LE;
  const hsize_t t = surface.triangles.size(), l = surface.links.size();
  writeColumn(group, {"triangles", "", u32, u32le, {t, 3}, surface.triangles.data()});
  writeColumn(group, {"strain", "", f32, f32le, {t, 1}, surface.strain.data()});
  writeColumn(group, {"links", "", u32, u32le, {l, 2}, surface.links.data()});
  writeColumn(group, {"link_strain", "", f32, f32le, {l, 1}, surface.linkStrain.data()});
}

std::vector<double> bodyRows(const World& world) {
  std::vector<double> rows;
  for (std::size_t b = 0; b < world.bodyCount(); ++b) {
    const BodyState& s = world.body(b);
    const Vec2& at = s.transform.position;
    rows.insert(rows.end(), {at.x(), at.y(), s.angle, s.velocity.x(), s.velocity.y(), s.spin});
  }
  return rows;
}

template <typename T>
T readAttribute(hid_t object, const char* name, hid_t type) {
  T value{};
  const Hdf5Handle attribute(H5Aopen(object, name, H5P_DEFAULT), H5Aclose, name);
  checkHdf5(H5Aread(attribute, type, &value), name);
  return value;
}

/// Rows of a dataset; 0 where there is none.
std::size_t rowsOf(hid_t group, const char* name, const std::string& path) {
  if (H5Lexists(group, name, H5P_DEFAULT) <= 0) return 0;
  const Hdf5Handle data(H5Dopen2(group, name, H5P_DEFAULT), H5Dclose, path);
  const Hdf5Handle space(H5Dget_space(data), H5Sclose, path);
  hsize_t shape[2] = {0, 0};
  H5Sget_simple_extent_dims(space, shape, nullptr);
  return static_cast<std::size_t>(shape[0]);
}

}  // namespace

std::string frameName(int index) { return fmt::format("frame_{:05}", index); }
std::string segmentFile(int segment) { return fmt::format("frames/{:04}.h5", segment); }

int positionBytes(const WorldDef& def) {
  double length = kInfinity;
  if (def.fluid) length = std::min(length, def.fluid->spacing);
  if (def.bullet) length = std::min(length, def.bullet->radius);
  for (const SoftDef& soft : def.soft) length = std::min(length, soft.spacing);
  const double farthest = std::max(def.domain.box.min.cwiseAbs().maxCoeff(), def.domain.box.max.cwiseAbs().maxCoeff());
  return farthest * std::ldexp(1.0, -24) > kPositionError * length ? 8 : 4;
}

Segment::Segment(int number) : number_(number), file_("memory:" + segmentFile(number), kGrowth) {}

void Segment::add(const World& world, int index) {
  const ParticlePool *fluid = world.fluid(), *bullets = world.bullets();
  const std::size_t fluidCount = fluid != nullptr ? fluid->size() : 0;
  const std::size_t bulletCount = bullets != nullptr ? bullets->size() : 0, rigidCount = fluidCount + bulletCount;
  const std::size_t count = rigidCount + (world.soft() != nullptr ? world.soft()->size() : 0);
  const WorldDef& def = world.definition();
  SoftSurface surface = softSurface(world);
  const FrameEntry entry{
      index, number_, world.time(), count, surface.triangles.size(), surface.links.size(), positionBytes(def)};
  const bool wide = entry.positionBytes == 8;
  Columns c(count, wide);
  if (fluidCount > 0) c.fill(*fluid, 0, 0, def.fluid->density);
  if (bulletCount > 0) c.fill(*bullets, fluidCount, 1, def.bullet->density);
  if (count > rigidCount) c.fillSoft(world, rigidCount);
  const std::vector<double> bodies = bodyRows(world);

  const std::string name = frameName(index);
  const Hdf5Handle group(H5Gcreate2(file_.id(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose, name);
  writeAttribute(group, "index", index);
  writeAttribute(group, "time", entry.time);
  const hsize_t n = count;
  const hid_t f32 = H5T_NATIVE_FLOAT, f64 = H5T_NATIVE_DOUBLE, f32le = H5T_IEEE_F32LE, f64le = H5T_IEEE_F64LE;
  if (wide)
    writeColumn(group, {"position", "m", f64, f64le, {n, 2}, c.position64.data()});
  else
    writeColumn(group, {"position", "m", f32, f32le, {n, 2}, c.position32.data()});
  writeColumn(group, {"velocity", "m/s", f32, f32le, {n, 2}, c.velocity.data()});
  writeColumn(group, {"pressure", "N/m", f32, f32le, {n, 1}, c.pressure.data()});
  writeColumn(group, {"density", "kg/m²", f32, f32le, {n, 1}, c.density.data()});
  writeColumn(group, {"species", "", H5T_NATIVE_UINT8, H5T_STD_U8LE, {n, 1}, c.species.data()});
  writeColumn(group, {"id", "", H5T_NATIVE_UINT32, H5T_STD_U32LE, {n, 1}, c.id.data()});
  if (world.softCount() > 0) writeSurface(group, surface, static_cast<std::uint32_t>(rigidCount));
  writeColumn(group, {"bodies", "m, m, rad, m/s, m/s, rad/s", f64, f64le, {world.bodyCount(), 6}, bodies.data()});
  frames_.push_back(entry);
}

void Segment::copy(const std::string& file, const FrameEntry& frame) {
  const Hdf5Handle from(H5Fopen(file.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose, file);
  const std::string name = frameName(frame.index);
  checkHdf5(H5Ocopy(from, name.c_str(), file_.id(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT), file);
  frames_.push_back(frame);
  frames_.back().segment = number_;
}

// XDMF's Polyvertex without numbers of its points has no cells in ParaView, which then draws nothing.
void Segment::save(const std::string& folder) {
  std::size_t most = 0;
  for (const FrameEntry& frame : frames_) most = std::max(most, frame.particles);
  std::vector<std::uint32_t> numbers(most);
  std::iota(numbers.begin(), numbers.end(), 0u);
  if (H5Lexists(file_.id(), kVertices, H5P_DEFAULT) > 0) H5Ldelete(file_.id(), kVertices, H5P_DEFAULT);
  writeColumn(file_.id(), {kVertices, "", H5T_NATIVE_UINT32, H5T_STD_U32LE, {most, 1}, numbers.data()});
  for (FrameEntry& frame : frames_) frame.vertices = most;
  file_.save(folder + "/" + segmentFile(number_));
}

std::vector<FrameEntry> readSegment(const std::string& folder, int segment) {
  const std::string path = folder + "/" + segmentFile(segment);
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  const hid_t opened = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  if (opened < 0) throw OutputError(path + ": cannot be read: it is not a whole HDF5 file");
  const Hdf5Handle file(opened, H5Fclose, path);
  H5G_info_t info{};
  checkHdf5(H5Gget_info(file, &info), path);
  std::vector<FrameEntry> frames;
  const std::size_t vertices = rowsOf(file, kVertices, path);
  for (hsize_t k = 0; k < info.nlinks; ++k) {
    char name[64] = {};
    H5Lget_name_by_idx(file, ".", H5_INDEX_NAME, H5_ITER_INC, k, name, sizeof name, H5P_DEFAULT);
    if (std::string_view(name) == kVertices) continue;
    const Hdf5Handle group(H5Gopen2(file, name, H5P_DEFAULT), H5Gclose, path);
    const Hdf5Handle position(H5Dopen2(group, "position", H5P_DEFAULT), H5Dclose, path);
    const Hdf5Handle space(H5Dget_space(position), H5Sclose, path);
    const Hdf5Handle type(H5Dget_type(position), H5Tclose, path);
    hsize_t shape[2] = {0, 0};
    H5Sget_simple_extent_dims(space, shape, nullptr);
    frames.push_back({readAttribute<int>(group, "index", H5T_NATIVE_INT), segment,
                      readAttribute<double>(group, "time", H5T_NATIVE_DOUBLE), static_cast<std::size_t>(shape[0]),
                      rowsOf(group, "triangles", path), rowsOf(group, "links", path),
                      static_cast<int>(H5Tget_size(type)), vertices});
  }
  std::sort(frames.begin(), frames.end(), [](const FrameEntry& a, const FrameEntry& b) { return a.index < b.index; });
  return frames;
}

namespace {

std::string xdmfAttribute(const FrameEntry& f, const char* name, const char* kind, const char* number, int precision) {
  return fmt::format(
      "        <Attribute Name=\"{0}\" AttributeType=\"{1}\" Center=\"Node\">\n"
      "          <DataItem Dimensions=\"{2}{3}\" NumberType=\"{4}\" Precision=\"{5}\" "
      "Format=\"HDF\">{6}:/{7}/{0}</DataItem>\n"
      "        </Attribute>\n",
      name, kind, f.particles, std::string_view(kind) == "Vector" ? " 2" : "", number, precision,
      segmentFile(f.segment), frameName(f.index));
}

std::string xdmfBegin(const FrameEntry& f, const std::string& topology) {
  return fmt::format(
      "      <Grid Name=\"{0}\" GridType=\"Uniform\">\n"
      "        <Time Value=\"{1:.17g}\"/>\n"
      "{5}"
      "        <Geometry GeometryType=\"XY\">\n"
      "          <DataItem Dimensions=\"{2} 2\" NumberType=\"Float\" Precision=\"{3}\" "
      "Format=\"HDF\">{4}:/{0}/position</DataItem>\n"
      "        </Geometry>\n",
      frameName(f.index), f.time, f.particles, f.positionBytes, segmentFile(f.segment), topology);
}

/// Cells of soft bodies, and a number for each.
struct XdmfCells {
  const char *topology, *set, *value;
  int corners;
  std::size_t count;
};

std::string xdmfCells(const FrameEntry& f, const XdmfCells& cells) {
  const std::string file = segmentFile(f.segment) + ":/" + frameName(f.index) + "/";
  return xdmfBegin(f, fmt::format("        <Topology TopologyType=\"{0}\" NumberOfElements=\"{1}\" "
                                  "NodesPerElement=\"{2}\">\n"
                                  "          <DataItem Dimensions=\"{1} {2}\" NumberType=\"UInt\" Precision=\"4\" "
                                  "Format=\"HDF\">{3}{4}</DataItem>\n"
                                  "        </Topology>\n",
                                  cells.topology, cells.count, cells.corners, file, cells.set)) +
         fmt::format(
             "        <Attribute Name=\"strain\" AttributeType=\"Scalar\" Center=\"Cell\">\n"
             "          <DataItem Dimensions=\"{0}\" NumberType=\"Float\" Precision=\"4\" "
             "Format=\"HDF\">{1}{2}</DataItem>\n"
             "        </Attribute>\n"
             "      </Grid>\n",
             cells.count, file, cells.value);
}

std::string xdmfGrid(const FrameEntry& f) {
  std::string grid = xdmfBegin(
      f, fmt::format("        <Topology TopologyType=\"Polyvertex\" NumberOfElements=\"{0}\" NodesPerElement=\"1\">\n"
                     "          <DataItem ItemType=\"HyperSlab\" Dimensions=\"{0} 1\">\n"
                     "            <DataItem Dimensions=\"3 1\" Format=\"XML\">0 1 {0}</DataItem>\n"
                     "            <DataItem Dimensions=\"{1}\" NumberType=\"UInt\" Precision=\"4\" "
                     "Format=\"HDF\">{2}:/{3}</DataItem>\n"
                     "          </DataItem>\n"
                     "        </Topology>\n",
                     f.particles, f.vertices, segmentFile(f.segment), kVertices));
  grid += xdmfAttribute(f, "velocity", "Vector", "Float", 4);
  grid += xdmfAttribute(f, "pressure", "Scalar", "Float", 4);
  grid += xdmfAttribute(f, "density", "Scalar", "Float", 4);
  grid += xdmfAttribute(f, "species", "Scalar", "UChar", 1);
  grid += xdmfAttribute(f, "id", "Scalar", "UInt", 4);
  return grid + "      </Grid>\n";
}

std::string xdmfCollection(const char* name, const std::string& grids) {
  if (grids.empty()) return grids;
  return fmt::format("    <Grid Name=\"{}\" GridType=\"Collection\" CollectionType=\"Temporal\">\n", name) + grids +
         "    </Grid>\n";
}

}  // namespace

void writeIndex(const std::string& folder, const std::vector<FrameEntry>& frames) {
  Hdf5Memory links("memory:frames.h5", kIndexGrowth);
  std::string particles, soft, ropes;
  for (const FrameEntry& f : frames) {
    const std::string name = frameName(f.index), path = "/" + name, segment = segmentFile(f.segment);
    checkHdf5(H5Lcreate_external(segment.c_str(), path.c_str(), links.id(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT),
              folder + "/frames.h5");
    if (f.particles > 0) particles += xdmfGrid(f);
    if (f.triangles > 0) soft += xdmfCells(f, {"Triangle", "triangles", "strain", 3, f.triangles});
    if (f.links > 0) ropes += xdmfCells(f, {"Polyline", "links", "link_strain", 2, f.links});
  }
  const std::string xdmf =
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<Xdmf Version=\"2.0\">\n"
      "  <Domain>\n"
      "    <Grid Name=\"particles\" GridType=\"Collection\" CollectionType=\"Temporal\">\n" +
      particles + "    </Grid>\n" + xdmfCollection("soft", soft) + xdmfCollection("ropes", ropes) +
      "  </Domain>\n</Xdmf>\n";
  links.save(folder + "/frames.h5");
  run::writeWholeFile(folder + "/frames.xdmf", xdmf);
}

}  // namespace froude::exporting
