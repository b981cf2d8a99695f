#include "export/run_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <utility>

#include "export/color_scale.h"
#include "export/frames.h"
#include "export/page.h"
#include "run/atomic_file.h"

namespace froude::exporting {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kBytes = 5.0;  // of a particle in a frame, at most
constexpr int kPaletteSize = 33;

Json jsonOf(const Box& box) { return {box.min.x(), box.min.y(), box.max.x(), box.max.y()}; }

Json palette(Color (*color)(double)) {
  Json colors = Json::array();
  for (int k = 0; k < kPaletteSize; ++k) {
    const Color c = color(k / (kPaletteSize - 1.0));
    colors.push_back(fmt::format("#{:02x}{:02x}{:02x}", c.r, c.g, c.b));
  }
  return colors;
}

Json jsonOf(const char* name, const ColorScale& scale) {
  return {{"name", name}, {"low", scale.low}, {"high", scale.high}, {"factor", scale.factor}, {"label", scale.label}};
}

/// What particles and triangles can be coloured by.
Json scalesOf(const scene::Scene& scene) {
  Json scales = Json::array();
  const WorldDef& def = scene.world;
  if (def.fluid || def.bullet || !def.soft.empty()) scales.push_back(jsonOf("speed", colorScale(scene, "speed")));
  if (def.fluid) scales.push_back(jsonOf("pressure", colorScale(scene, "pressure")));
  if (!def.soft.empty()) scales.push_back(jsonOf("strain", strainScale(scene)));
  return scales;
}

Json ringsOf(const Polygon& polygon) {
  Json rings = Json::array();
  const auto vertices = polygon.vertices();
  const auto starts = polygon.ringStarts();
  for (std::size_t r = 0; r + 1 < starts.size(); ++r) {
    Json ring = Json::array();
    for (std::uint32_t v = starts[r]; v < starts[r + 1]; ++v) {
      ring.push_back(vertices[v].x());
      ring.push_back(vertices[v].y());
    }
    rings.push_back(std::move(ring));
  }
  return rings;
}

/// Shapes once each, though a thousand bodies may share one; bodies in the order of the scene.
void addBodies(Json& page, const World& world) {
  std::map<const Polygon*, std::size_t> numbers;
  Json shapes = Json::array(), bodies = Json::array();
  for (std::size_t b = 0; b < world.bodyCount(); ++b) {
    const BodyDef& def = world.bodyDefinition(b);
    const auto [at, fresh] = numbers.emplace(def.shape.get(), shapes.size());
    if (fresh) shapes.push_back(ringsOf(*def.shape));
    const BodyState& state = world.body(b);
    const Vec2& p = state.transform.position;
    Json body{{"name", def.name}, {"shape", at->second}, {"moves", def.motion != Motion::Fixed}};
    if (def.motion == Motion::Fixed) body["pose"] = {p.x(), p.y(), state.angle};
    bodies.push_back(std::move(body));
  }
  page["shapes"] = std::move(shapes);
  page["bodies"] = std::move(bodies);
}

std::string textOf(const std::string& file) {
  std::error_code error;
  return std::filesystem::exists(file, error) ? run::readWholeFile(file) : std::string();
}

}  // namespace

RunPage::RunPage(std::string folder, const scene::Scene& scene, int nextFrame)
    : folder_(std::move(folder)), scene_(scene), ranges_(frameRanges(scene)) {
  if (!scene.output.png && !scene.output.h5 && !scene.output.vdb) return;
  const double particles = static_cast<double>(scene.fluidParticles() + scene.bulletCount() + scene.softPoints());
  const double bytes = kBytes * particles * (std::floor(scene.duration / scene.output.every) + 1.0);
  every_ = std::max(1, static_cast<int>(std::ceil(bytes / static_cast<double>(PageFrames::kLargest))));
  frames_.emplace(folder_, nextFrame);
}

void RunPage::take(const World& world, int index) {
  if (frames_ && index % every_ == 0) frames_->append(takeFrame(world, ranges_, index));
}

void RunPage::write(const World& world, const std::string& summary) const {
  const WorldDef& def = world.definition();
  const DomainDef& domain = def.domain;
  Json page;
  page["kind"] = "run";
  page["title"] = scene_.title.empty() ? scene_.name : scene_.title;
  page["box"] = jsonOf(domain.box);
  page["view"] = jsonOf(scene_.output.image.view);
  page["closed"] = domain.closed;
  page["spacing"] = def.fluid ? Json(def.fluid->spacing) : Json(nullptr);
  page["bulletRadius"] = def.bullet ? Json(def.bullet->radius) : Json(nullptr);
  page["soft"] = Json::array();
  for (std::size_t k = 0; k < world.softCount(); ++k) {
    const SoftDef& soft = world.softDefinition(k);
    page["soft"].push_back({{"first", world.softFirst(k)}, {"thickness", soft.thickness}});
  }
  page["color"] = scene_.output.image.color;
  page["scales"] = scalesOf(scene_);
  page["palettes"] = {{"viridis", palette(viridis)}, {"strain", palette(strainColor)}};
  page["every"] = scene_.output.every;
  addBodies(page, world);
  Json blocks = Json::array(), frames = Json::array();
  if (frames_)
    for (const PageFrames::Entry& e : frames_->entries()) {
      const FrameRecord& r = e.record;
      frames.push_back({r.index, r.time, r.key ? 1 : 0, r.packed, r.unpacked, r.particles});
    }
  page["frames"] = std::move(frames);
  page["gauges"] = textOf(folder_ + "/gauges.csv");
  page["scene"] = scene_.resolved;
  page["summary"] = Json::parse(summary, nullptr, false);
  page["notices"] = pageNotices();

  PageParts parts{page["title"].get<std::string>(), page.dump(-1, ' ', false, Json::error_handler_t::replace), {}};
  if (frames_)
    parts.blocks = [&](const std::function<void(std::string_view)>& block) {
      std::ifstream file(frames_->file(), std::ios::binary);
      const auto& entries = frames_->entries();
      for (std::size_t first = 0; first < entries.size();) {
        std::size_t end = first + 1;
        while (end < entries.size() && !entries[end].record.key) ++end;
        std::string bytes;
        for (; first < end; ++first) {
          const std::size_t before = bytes.size();
          bytes.resize(before + entries[first].record.packed);
          file.seekg(static_cast<std::streamoff>(entries[first].begin));
          file.read(bytes.data() + before, entries[first].record.packed);
        }
        if (!file) throw OutputError(frames_->file() + ": cannot be read back");
        block(bytes);
      }
    };
  writePage(folder_ + "/" + kFile, parts);
}

}  // namespace froude::exporting
