#include "export/field_page.h"

#include <nlohmann/json.hpp>

#include "export/page.h"

namespace froude::exporting {
namespace {

using Json = nlohmann::ordered_json;

Json ringsOf(const Polygon& polygon) {
  Json rings = Json::array();
  const auto starts = polygon.ringStarts();
  for (std::size_t r = 0; r + 1 < starts.size(); ++r) {
    Json ring = Json::array();
    for (const Vec2& v : polygon.vertices().subspan(starts[r], starts[r + 1] - starts[r])) {
      ring.push_back(v.x());
      ring.push_back(v.y());
    }
    rings.push_back(std::move(ring));
  }
  return rings;
}

/// Of each cell, row by row from below: the edges it keeps, or 0 outside and 1 inside.
Json cellsOf(const DistanceField& field) {
  Json cells = Json::array();
  for (int j = 0; j < field.ny(); ++j)
    for (int i = 0; i < field.nx(); ++i) {
      const std::size_t at =
          static_cast<std::size_t>(j) * static_cast<std::size_t>(field.nx()) + static_cast<std::size_t>(i);
      const auto edges = field.grid().nearest(at);
      if (edges.empty())
        cells.push_back(field.cell(i, j).kind == FieldCell::Kind::Inside ? 1 : 0);
      else
        cells.push_back(Json(std::vector<std::uint32_t>(edges.begin(), edges.end())));
    }
  return cells;
}

}  // namespace

void writeFieldPage(const std::string& file, const DistanceField& field, const std::string& title) {
  Json page;
  page["kind"] = "field";
  page["title"] = title;
  page["rings"] = ringsOf(field.polygon());
  page["band"] = field.band();
  page["origin"] = {field.gridOrigin().x(), field.gridOrigin().y()};
  page["cell"] = field.cellSize();
  page["columns"] = field.nx();
  page["rows"] = field.ny();
  page["cells"] = cellsOf(field);
  page["notices"] = pageNotices();
  writePage(file, {title, page.dump(-1, ' ', false, Json::error_handler_t::replace), {}});
}

}  // namespace froude::exporting
