// The shapes of tests/data/geometry_polygons.json as polygons.
#pragma once

#include <froude/fields/polygon.h>

#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

namespace froude::test {

inline std::map<std::string, Polygon> goldenShapes() {
  std::ifstream file(std::string(FROUDE_TEST_DATA) + "/geometry_polygons.json");
  std::map<std::string, Polygon> shapes;
  const nlohmann::json polygons = nlohmann::json::parse(file).at("polygons");
  for (const auto& [name, entry] : polygons.items()) {
    std::vector<std::vector<Vec2>> rings;
    for (const auto& loop : entry.at("loops")) {
      rings.emplace_back();
      for (const auto& v : loop) rings.back().emplace_back(v[0].get<double>(), v[1].get<double>());
    }
    const std::vector<Vec2> outer = rings.front();
    rings.erase(rings.begin());
    shapes.emplace(name, Polygon::make(outer, rings));
  }
  return shapes;
}

}  // namespace froude::test
