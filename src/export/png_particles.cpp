#include "export/png_particles.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <froude/base/types.h>

namespace froude::exporting {
namespace {

constexpr double kSmallestSeen = 3.5;  // radius [pixels]
// Small discs are a little wider than their particle's share of the area: water that is stretched by a few per cent
// must not show the paper between its particles.
constexpr double kOverlap = 1.25;
constexpr float kRim = 1.0f, kRimShade = 0.72f;  // width [pixels]; of the colour inside
constexpr Color kNeutral{70, 70, 70};

Color colorOf(float place) {
  static const auto table = [] {
    std::array<Color, 256> t{};
    for (int k = 0; k < 256; ++k) t[static_cast<std::size_t>(k)] = viridis(k / 255.0);
    return t;
  }();
  if (std::isnan(place)) return kNeutral;
  return table[static_cast<std::size_t>(std::clamp(place, 0.0f, 1.0f) * 255.0f + 0.5f)];
}

Color shaded(Color c, float level) {
  const auto part = [&](std::uint8_t v) { return static_cast<std::uint8_t>(static_cast<float>(v) * level + 0.5f); };
  return {part(c.r), part(c.g), part(c.b)};
}

void blend(std::uint32_t& pixel, Color c, float alpha) {
  const auto mix = [&](int shift, std::uint8_t value) {
    const float old = static_cast<float>((pixel >> shift) & 255u);
    return static_cast<std::uint32_t>(old + (static_cast<float>(value) - old) * alpha + 0.5f) << shift;
  };
  pixel = 0xFF000000u | mix(16, c.r) | mix(8, c.g) | mix(0, c.b);
}

/// Calls paint(x, y, coverage, core) for the pixels of a disc: how much of the pixel it covers, and how much of that is
/// inside the rim; both edges are a pixel wide and have the right area on average.
template <typename Paint>
void forDisc(const Canvas& canvas, const Disc& d, float radius, Paint&& paint) {
  const float reach = radius + 0.5f;
  const int x0 = std::max(canvas.left, static_cast<int>(std::floor(d.x - reach)));
  const int x1 = std::min(canvas.right - 1, static_cast<int>(std::floor(d.x + reach)));
  const int y0 = std::max(canvas.top, static_cast<int>(std::floor(d.y - reach)));
  const int y1 = std::min(canvas.bottom - 1, static_cast<int>(std::floor(d.y + reach)));
  for (int y = y0; y <= y1; ++y)
    for (int x = x0; x <= x1; ++x) {
      const float dx = static_cast<float>(x) + 0.5f - d.x, dy = static_cast<float>(y) + 0.5f - d.y;
      const float distance = std::sqrt(dx * dx + dy * dy), coverage = std::min(1.0f, reach - distance);
      if (coverage > 0.0f) paint(x, y, coverage, std::clamp(radius - kRim + 0.5f - distance, 0.0f, 1.0f));
    }
}

std::uint32_t& pixelAt(const Canvas& canvas, int x, int y) {
  return reinterpret_cast<std::uint32_t*>(canvas.data + static_cast<std::ptrdiff_t>(y) * canvas.stride)[x];
}

/// A small disc is the square of its area: cheap, and squares of neighbours tile the plane, so that water
/// has no moiré. Neutral discs are kept apart, for they have no value to average.
void paintSmall(const Canvas& canvas, const std::vector<Disc>& discs, double radius) {
  const int width = canvas.right - canvas.left, height = canvas.bottom - canvas.top;
  struct Pixel {
    float weight = 0.0f, value = 0.0f, neutral = 0.0f;
  };
  std::vector<Pixel> pixels(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  const float half = static_cast<float>(kOverlap * 0.5 * std::sqrt(kPi) * radius);
  for (const Disc& d : discs) {
    const float left = d.x - half - static_cast<float>(canvas.left), top = d.y - half - static_cast<float>(canvas.top);
    const float right = left + 2.0f * half, bottom = top + 2.0f * half;
    const int x0 = std::max(0, static_cast<int>(std::floor(left))), y0 = std::max(0, static_cast<int>(std::floor(top)));
    const int x1 = std::min(width, static_cast<int>(std::ceil(right)));
    const int y1 = std::min(height, static_cast<int>(std::ceil(bottom)));
    for (int y = y0; y < y1; ++y) {
      const float tall = std::min(bottom, static_cast<float>(y + 1)) - std::max(top, static_cast<float>(y));
      for (int x = x0; x < x1; ++x) {
        const float wide = std::min(right, static_cast<float>(x + 1)) - std::max(left, static_cast<float>(x));
        Pixel& p = pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)];
        if (std::isnan(d.place)) {
          p.neutral += wide * tall;
        } else {
          p.weight += wide * tall;
          p.value += wide * tall * d.place;
        }
      }
    }
  }
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const Pixel& p =
          pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)];
      std::uint32_t& pixel = pixelAt(canvas, canvas.left + x, canvas.top + y);
      if (p.weight > 0.0f) blend(pixel, colorOf(p.value / p.weight), std::min(1.0f, p.weight));
      if (p.neutral > 0.0f) blend(pixel, kNeutral, std::min(1.0f, p.neutral));
    }
}

}  // namespace

void paintDiscs(const Canvas& canvas, const std::vector<Disc>& discs, double radius) {
  if (discs.empty() || canvas.right <= canvas.left || canvas.bottom <= canvas.top) return;
  if (radius < kSmallestSeen) {
    paintSmall(canvas, discs, radius);
    return;
  }
  for (const Disc& d : discs) {
    const Color c = colorOf(d.place);
    forDisc(canvas, d, static_cast<float>(radius), [&](int x, int y, float coverage, float core) {
      blend(pixelAt(canvas, x, y), shaded(c, kRimShade + (1.0f - kRimShade) * core), coverage);
    });
  }
}

}  // namespace froude::exporting
