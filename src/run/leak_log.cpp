#include "run/leak_log.h"

#include <fmt/format.h>

#include <charconv>
#include <filesystem>

#include "run/atomic_file.h"

namespace froude::run {
namespace {

const std::string kHeader = "t,kind,particle,x,y,body,depth,from_x,from_y";

const char* kindOf(const LeakEvent& leak) { return leak.species == Species::Fluid ? "fluid" : "bullet"; }

/// The side of the domain by the nearest point of the boundary.
std::string sideAt(const Box& box, const Vec2& p) {
  const double distance[] = {std::abs(p.x() - box.min.x()), std::abs(p.x() - box.max.x()),
                             std::abs(p.y() - box.min.y()), std::abs(p.y() - box.max.y())};
  const char* names[] = {"left wall", "right wall", "bottom wall", "top wall"};
  return names[std::min_element(distance, distance + 4) - distance];
}

std::string ownerOf(const World& world, const LeakEvent& leak) {
  if (leak.body.isNull()) return sideAt(world.definition().domain.box, leak.boundary);
  return world.bodyDefinition(leak.body).name;
}

/// Bytes of the header and of the rows up to that time; rows are in order of time.
std::uint64_t bytesUntil(const std::string& text, double time) {
  std::size_t at = std::min(text.find('\n'), text.size() - 1) + 1;
  while (at < text.size()) {
    const std::size_t end = text.find('\n', at);
    double t = 0.0;
    const auto [stop, error] = std::from_chars(text.data() + at, text.data() + text.size(), t);
    if (end == std::string::npos || error != std::errc() || t > time) break;
    at = end + 1;
  }
  return at;
}

}  // namespace

LeakLog::LeakLog(const std::string& file, std::optional<double> resumedAt) {
  if (resumedAt && std::filesystem::exists(file)) {
    const std::string text = readWholeFile(file);
    if (text.starts_with(kHeader + "\n")) {
      log_.emplace(file, bytesUntil(text, *resumedAt));
      return;
    }
  }
  log_.emplace(file, kHeader);
}

void LeakLog::append(const World& world) {
  rows_.clear();
  for (const LeakEvent& leak : world.leaks())
    rows_.push_back(fmt::format("{:.17g},{},{}.{},{:.17g},{:.17g},{},{:.17g},{:.17g},{:.17g}", leak.time, kindOf(leak),
                                leak.particle.slot, leak.particle.generation, leak.position.x(), leak.position.y(),
                                ownerOf(world, leak), leak.depth, leak.from.x(), leak.from.y()));
  log_->append(rows_);
}

std::vector<std::string> leakLines(const World& world, std::size_t most) {
  std::vector<std::string> lines;
  const auto leaks = world.leaks();
  for (const LeakEvent& leak : leaks) {
    if (lines.size() == most) {
      lines.push_back(fmt::format("… and {} more leaks in this sub-step", leaks.size() - most));
      break;
    }
    const std::string where = leak.inside ? fmt::format("{:.3g} m inside", leak.depth) : "gone through";
    lines.push_back(
        fmt::format("leak: t = {:.6g} s, {} particle {}.{} at ({:.6g}, {:.6g}), {} {}, from ({:.6g}, {:.6g})",
                    leak.time, kindOf(leak), leak.particle.slot, leak.particle.generation, leak.position.x(),
                    leak.position.y(), where, ownerOf(world, leak), leak.from.x(), leak.from.y()));
  }
  return lines;
}

}  // namespace froude::run
