#include <froude/solver/fluid/grid/front_loops.h>

namespace froude {
namespace {

void means(const float* values, const TileLinks& link, const FrontRows& rows, std::size_t tile, float* next) {
  for (std::int32_t j = 0; j < 16; ++j) {
    if (rows.fresh[j] == 0) continue;
    const std::size_t row = tile * 256 + static_cast<std::size_t>(16 * j);
    const std::size_t below = j == 0 ? link.down : row - 16, above = j == link.rows - 1 ? link.up : row + 16;
    for (std::int32_t i = 0; i < 16; ++i) {
      const auto k = static_cast<std::size_t>(i);
      const std::size_t at = row + k;
      next[at] = values[at];
      if ((rows.fresh[j] >> i & 1) == 0) continue;
      const std::size_t left = i == 0 ? link.left + static_cast<std::size_t>(16 * j) : at - 1;
      const std::size_t right = i == link.lane ? link.right + static_cast<std::size_t>(16 * j) : at + 1;
      auto one = [i](std::uint16_t side) { return static_cast<float>(side >> i & 1); };
      const float count = (one(rows.left[j]) + one(rows.right[j])) + (one(rows.down[j]) + one(rows.up[j]));
      const float sum = (values[left] + values[right]) + (values[below + k] + values[above + k]);
      next[at] = sum / count;
    }
  }
}

void take(const float* next, const std::uint16_t* fresh, std::size_t tile, float* values, float* known) {
  for (std::size_t k = tile * 256; k < tile * 256 + 256; ++k) {
    const std::uint16_t word = fresh[k % 256 / 16];
    if (word == 0) continue;
    values[k] = next[k];
    if (known != nullptr && (word >> k % 16 & 1) != 0) known[k] = 1.0f;
  }
}

}  // namespace

const FrontLoops& scalarFrontLoops() {
  static constexpr FrontLoops kLoops{means, take};
  return kLoops;
}

bool findFront(const std::uint16_t* known, const TileLinks& link, std::size_t tile, FrontRows& rows) {
  const std::uint16_t* own = known + tile * 16;
  const std::uint16_t *left = known + link.left / 16, *right = known + link.right / 16;
  const std::uint32_t lastOfLeft = link.left % 16;
  const auto lane = static_cast<std::uint32_t>(link.lane);
  const std::uint32_t columns = (2u << lane) - 1u;
  std::uint32_t any = 0;
  for (std::int32_t j = 0; j < 16; ++j) {
    const std::uint32_t word = own[j];
    rows.left[j] = static_cast<std::uint16_t>(word << 1 | (left[j] >> lastOfLeft & 1u));
    rows.right[j] = static_cast<std::uint16_t>(word >> 1 | (right[j] & 1u) << lane);
  }
  rows.down[0] = known[link.down / 16];
  for (std::int32_t j = 1; j < 16; ++j) rows.down[j] = own[j - 1];
  for (std::int32_t j = 0; j < 15; ++j) rows.up[j] = own[j + 1];
  rows.up[link.rows - 1] = known[link.up / 16];
  for (std::int32_t j = 0; j < 16; ++j) {
    const std::uint32_t beside = static_cast<std::uint32_t>(rows.left[j] | rows.right[j]) |
                                 static_cast<std::uint32_t>(rows.down[j] | rows.up[j]);
    const std::uint32_t fresh = j < link.rows ? beside & ~static_cast<std::uint32_t>(own[j]) & columns : 0u;
    rows.fresh[j] = static_cast<std::uint16_t>(fresh);
    any |= fresh;
  }
  return any != 0;
}

}  // namespace froude
