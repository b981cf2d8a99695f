#include "export/png_particles.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <froude/base/types.h>

namespace froude::exporting {
namespace {

// Together, discs are wider than their particle's share of the area: the corners between four of them close, also where
// water is stretched by a few per cent, and no paper shows through.
constexpr double kOverlap = 1.5;
constexpr float kRim = 1.0f, kRimShade = 0.72f;  // width [pixels]; of the colour inside
constexpr float kSmallestRimmed = 3.0f;          // radius [pixels]
constexpr float kSmallestRound = 1.0f;           // radius [pixels]; below it a disc is the square of its area
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

/// Calls paint(x, y, coverage) for the pixels of a square: a disc too small to look round, and cheaper.
template <typename Paint>
void forSquare(const Canvas& canvas, const Disc& d, float half, Paint&& paint) {
  const float left = d.x - half, top = d.y - half, right = d.x + half, bottom = d.y + half;
  const int x0 = std::max(canvas.left, static_cast<int>(std::floor(left)));
  const int x1 = std::min(canvas.right, static_cast<int>(std::ceil(right)));
  const int y0 = std::max(canvas.top, static_cast<int>(std::floor(top)));
  const int y1 = std::min(canvas.bottom, static_cast<int>(std::ceil(bottom)));
  for (int y = y0; y < y1; ++y) {
    const float tall = std::min(bottom, static_cast<float>(y + 1)) - std::max(top, static_cast<float>(y));
    for (int x = x0; x < x1; ++x)
      paint(x, y, tall * (std::min(right, static_cast<float>(x + 1)) - std::max(left, static_cast<float>(x))));
  }
}

std::uint32_t& pixelAt(const Canvas& canvas, int x, int y) {
  return reinterpret_cast<std::uint32_t*>(canvas.data + static_cast<std::ptrdiff_t>(y) * canvas.stride)[x];
}

/// What each pixel of the canvas has of the discs so far.
class MeanLayer {
 public:
  explicit MeanLayer(const Canvas& canvas)
      : canvas_(canvas),
        width_(canvas.right - canvas.left),
        pixels_(static_cast<std::size_t>(width_) * static_cast<std::size_t>(canvas.bottom - canvas.top)) {}

  void add(int x, int y, float coverage, float place) {
    Pixel& p = pixels_[index(x, y)];
    if (std::isnan(place)) {
      p.neutral += coverage;
    } else {
      p.weight += coverage;
      p.value += coverage * place;
    }
  }

  void paint() const {
    for (int y = canvas_.top; y < canvas_.bottom; ++y)
      for (int x = canvas_.left; x < canvas_.right; ++x) {
        const Pixel& p = pixels_[index(x, y)];
        if (p.weight > 0.0f) blend(pixelAt(canvas_, x, y), colorOf(p.value / p.weight), std::min(1.0f, p.weight));
        if (p.neutral > 0.0f) blend(pixelAt(canvas_, x, y), kNeutral, std::min(1.0f, p.neutral));
      }
  }

 private:
  struct Pixel {
    float weight = 0.0f, value = 0.0f, neutral = 0.0f;
  };
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y - canvas_.top) * static_cast<std::size_t>(width_) +
           static_cast<std::size_t>(x - canvas_.left);
  }

  const Canvas& canvas_;
  int width_;
  std::vector<Pixel> pixels_;
};

void paintTogether(const Canvas& canvas, const std::vector<Disc>& discs, float radius) {
  MeanLayer layer(canvas);
  const float half = 0.5f * std::sqrt(static_cast<float>(kPi)) * radius;
  for (const Disc& d : discs) {
    if (radius < kSmallestRound)
      forSquare(canvas, d, half, [&](int x, int y, float coverage) { layer.add(x, y, coverage, d.place); });
    else
      forDisc(canvas, d, radius, [&](int x, int y, float coverage, float) { layer.add(x, y, coverage, d.place); });
  }
  layer.paint();
}

void paintApart(const Canvas& canvas, const std::vector<Disc>& discs, float radius) {
  const float shade = radius < kSmallestRimmed ? 1.0f : kRimShade;
  for (const Disc& d : discs) {
    const Color c = colorOf(d.place);
    forDisc(canvas, d, radius, [&](int x, int y, float coverage, float core) {
      blend(pixelAt(canvas, x, y), shaded(c, shade + (1.0f - shade) * core), coverage);
    });
  }
}

}  // namespace

void paintDiscs(const Canvas& canvas, const std::vector<Disc>& discs, double radius, Look look) {
  if (discs.empty() || canvas.right <= canvas.left || canvas.bottom <= canvas.top) return;
  if (look == Look::Together)
    paintTogether(canvas, discs, static_cast<float>(kOverlap * radius));
  else
    paintApart(canvas, discs, static_cast<float>(radius));
}

}  // namespace froude::exporting
