// A small scene, a folder of its own, and readers of frames that share no code with what wrote them.
#pragma once

#include <hdf5.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "scene/scene.h"

namespace froude::test {

/// A folder that goes with the object.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "froude-export-XXXXXX").string();
    path_ = mkdtemp(pattern.data());
  }
  ~TemporaryFolder() { std::filesystem::remove_all(path_); }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const std::string& path() const { return path_; }
  std::string file(const std::string& name) const { return path_ + "/" + name; }
  bool has(const std::string& name) const { return std::filesystem::exists(file(name)); }
  std::string text(const std::string& name) const {
    std::ostringstream text;
    text << std::ifstream(file(name), std::ios::binary).rdbuf();
    return text.str();
  }
  /// All files below, sorted.
  std::vector<std::string> files() const {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(path_))
      if (entry.is_regular_file()) names.push_back(entry.path().lexically_relative(path_).string());
    std::sort(names.begin(), names.end());
    return names;
  }

 private:
  std::string path_;
};

/// Writes to files fail beyond so many bytes while it lives: a disk that is full.
class FullDisk {
 public:
  explicit FullDisk(rlim_t bytes) {
    getrlimit(RLIMIT_FSIZE, &before_);
    signal(SIGXFSZ, SIG_IGN);
    const rlimit less{bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &less);
  }
  ~FullDisk() {
    setrlimit(RLIMIT_FSIZE, &before_);
    signal(SIGXFSZ, SIG_DFL);
  }

 private:
  rlimit before_{};
};

/// A block of water and some bullets in a tank of 2 m × 1 m with a box on its floor.
inline scene::Scene smallScene(double spacing = 0.05) {
  scene::Scene scene;
  scene.name = "small";
  scene.title = "A small tank";
  scene.duration = 1.0;
  scene.world.domain.box = {{0.0, 0.0}, {2.0, 1.0}};
  scene.world.fluid = FluidDef{};
  scene.world.fluid->spacing = spacing;
  scene.world.bullet = BulletDef{};
  BodyDef body;
  body.name = "box";
  body.shape = std::make_shared<Polygon>(Polygon::box({{0.0, 0.0}, {0.4, 0.2}}));
  body.position = {1.2, 0.0};
  scene.world.bodies.push_back(body);
  scene::SeededBlock water, bullets;
  for (double y = 0.5 * spacing; y < 0.5; y += spacing)
    for (double x = 0.5 * spacing; x < 0.8; x += spacing) {
      water.positions.emplace_back(x, y);
      water.velocities.emplace_back(0.5 * x, -0.25 * y);
    }
  for (int k = 0; k < 5; ++k) {
    bullets.positions.emplace_back(1.0 + 0.1 * k, 0.8);
    bullets.velocities.emplace_back(0.0, -1.0);
  }
  scene.fluidBlocks.push_back(water);
  scene.bulletBlocks.push_back(bullets);
  scene.output.every = 0.05;
  scene.output.image.view = scene.world.domain.box;
  return scene;
}

inline World worldOf(const scene::Scene& scene) {
  World world(scene.world);
  for (const scene::SeededBlock& b : scene.fluidBlocks) world.addFluid(b.positions, b.velocities);
  for (const scene::SeededBlock& b : scene.bulletBlocks) world.addBullets(b.positions, b.velocities);
  return world;
}

/// A dataset as doubles, whatever its type in the file, and its shape. Empty shape: there is no such dataset.
struct Dataset {
  std::vector<hsize_t> shape;
  std::vector<double> values;
  std::size_t elementSize = 0;
};
inline Dataset readDataset(const std::string& file, const std::string& path) {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  Dataset result;
  const hid_t f = H5Fopen(file.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  if (f < 0) return result;
  const hid_t set = H5Dopen2(f, path.c_str(), H5P_DEFAULT);
  if (set >= 0) {
    const hid_t space = H5Dget_space(set), type = H5Dget_type(set);
    result.shape.resize(static_cast<std::size_t>(H5Sget_simple_extent_ndims(space)));
    H5Sget_simple_extent_dims(space, result.shape.data(), nullptr);
    result.values.resize(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)));
    result.elementSize = H5Tget_size(type);
    H5Dread(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, result.values.data());
    H5Tclose(type);
    H5Sclose(space);
    H5Dclose(set);
  }
  H5Fclose(f);
  return result;
}

/// A scalar attribute of a group; NaN if it is not there.
inline double readNumber(const std::string& file, const std::string& group, const char* name) {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  double value = std::nan("");
  const hid_t f = H5Fopen(file.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  if (f < 0) return value;
  const hid_t a = H5Aopen_by_name(f, group.c_str(), name, H5P_DEFAULT, H5P_DEFAULT);
  if (a >= 0) {
    H5Aread(a, H5T_NATIVE_DOUBLE, &value);
    H5Aclose(a);
  }
  H5Fclose(f);
  return value;
}

/// Names of all links in the root of a file, sorted by HDF5.
inline std::vector<std::string> rootNames(const std::string& file) {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  std::vector<std::string> names;
  const hid_t f = H5Fopen(file.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  if (f < 0) return names;
  H5G_info_t info{};
  H5Gget_info(f, &info);
  for (hsize_t k = 0; k < info.nlinks; ++k) {
    char name[100] = {};
    H5Lget_name_by_idx(f, ".", H5_INDEX_NAME, H5_ITER_INC, k, name, sizeof name, H5P_DEFAULT);
    names.emplace_back(name);
  }
  H5Fclose(f);
  return names;
}

}  // namespace froude::test
