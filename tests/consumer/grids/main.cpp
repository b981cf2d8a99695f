// Asks OpenVDB's level set of a square for a distance; knows no header of OpenVDB.
#include <froude/fields/openvdb/level_set.h>

#include <cstdio>

int main() {
  const froude::vdb::LevelSet set(froude::Polygon::box({{0.0, 0.0}, {1.0, 1.0}}), 0.02, 5.0);
  std::printf("OpenVDB %s: %.4f m from the edge\n", froude::vdb::version().c_str(), set.distance({0.5, -0.03}));
}
