#include "scene/repeat.h"

#include <fmt/format.h>

#include <algorithm>

namespace froude::scene {

namespace {

constexpr std::int64_t kMostCopies = 100000;

bool goodName(const std::string& name) {
  if (name.empty() || !(std::isalpha(static_cast<unsigned char>(name[0])) || name[0] == '_')) return false;
  return std::all_of(name.begin(), name.end(), [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) || c == '_' || c == '-' || c == '.';
  });
}

}  // namespace

void checkBodyName(const TableReader& body, const std::string& name) {
  if (!goodName(name))
    body.fail("name", fmt::format("is \"{}\", right are a letter or _, then letters, digits, _ and -", name));
}

std::optional<Repeat> readRepeat(TableReader& body) {
  std::optional<TableReader> table = body.table("repeat", {"count", "step", "turn"});
  if (!table) return std::nullopt;
  Repeat repeat;
  const Node& count = table->need("count", "one or two integers, [nx, ny]");
  const std::size_t n = count.items.size();
  if (count.kind != Node::Kind::Array || n < 1 || n > 2)
    table->fail("count", "right are one or two integers, [nx, ny]");
  for (std::size_t i = 0; i < n; ++i) {
    const Node& item = count.items[i];
    if (item.kind != Node::Kind::Integer || item.integer < 1 || item.integer > kMostCopies)
      table->fail(item, "count", fmt::format("right are integers from 1 to {}", kMostCopies));
    repeat.count[i] = item.integer;
  }
  if (repeat.copies() > kMostCopies)
    table->fail("count", fmt::format("asks for {} copies, right are at most {}", repeat.copies(), kMostCopies));
  const Node& step = table->need("step", "a vector for each count, [[dx, dy], [dx, dy]]");
  if (step.kind != Node::Kind::Array || step.items.size() != n)
    table->fail("step", fmt::format("right are as many vectors as counts, {} of the form [dx, dy]", n));
  for (std::size_t i = 0; i < n; ++i) {
    Node pair;  // a table with one key, so that the vector is checked like any other
    pair.set("step", step.items[i]);
    TableReader reader(table->file(), pair, table->path(), {"step"});
    repeat.step[i] = reader.vector("step");
  }
  repeat.turn = table->number("turn", Range::between(-1e6, 1e6), 0.0);
  return repeat;
}

double turnedBy(const TableReader& body, const Repeat& repeat, double degrees, std::int64_t k) {
  const double turned = degrees + static_cast<double>(k) * repeat.turn;
  if (std::abs(turned) > 1e9) body.fail("repeat", "turns the last copy by more than 1e9 degrees");
  return turned;
}

}  // namespace froude::scene
