#include <froude/fields/sampled_field.h>

#include <froude/base/parallel.h>

namespace froude {
namespace {

constexpr double kMostNodes = 1u << 24;
/// The bound may exceed the largest error found by this share, or by this part of a cell.
constexpr double kBoundShare = 0.04;
constexpr double kBoundPart = 1e-4;
/// Bisections of a cell at most; what is still in doubt then counts as an error.
constexpr int kDeepest = 10;

/// The largest difference between the exact field and the interpolation, from above: squares of a cell are divided
/// until what their centre tells, and how fast both can change, cannot exceed the largest error known.
class ErrorSearch {
 public:
  ErrorSearch(const DistanceField& field, const SampledField& sampled)
      : field_(field), sampled_(sampled), little_(kBoundPart * sampled.cellSize()) {}

  double bound() const { return std::max(ceiling_, worst_ * (1.0 + kBoundShare) + little_); }

  void look(const Vec2& center, double half) { worst_ = std::max(worst_, errorAt(center, half).difference); }

  void divide(const Vec2& center, double half, int depth) {
    const Error here = errorAt(center, half);
    if (!here.counts) return;
    worst_ = std::max(worst_, here.difference);
    // The distance changes by no more than the way; the interpolation by no more than √2 of it, since neighbouring
    // nodes differ by no more than a cell.
    const double above = here.difference + (1.0 + std::sqrt(2.0)) * std::sqrt(2.0) * half;
    if (above <= worst_ * (1.0 + kBoundShare) + little_) return;
    if (depth == kDeepest) {
      ceiling_ = std::max(ceiling_, above);
      return;
    }
    for (const double sx : {-0.5, 0.5}) {
      for (const double sy : {-0.5, 0.5}) divide(center + half * Vec2(sx, sy), 0.5 * half, depth + 1);
    }
  }

 private:
  struct Error {
    bool counts;  // some point of the square may be in the band
    double difference;
  };
  Error errorAt(const Vec2& p, double half) const {
    const FieldSample exact = field_.sampleExact(p);
    if (std::abs(exact.distance) > field_.band() + 1.5 * half) return {false, 0.0};
    const SampledValue value = sampled_.sample(p);
    return {true, value.inBand && std::abs(exact.distance) <= field_.band() ? std::abs(value.distance - exact.distance)
                                                                            : 0.0};
  }

  const DistanceField& field_;
  const SampledField& sampled_;
  const double little_;
  double worst_ = 0.0;
  double ceiling_ = 0.0;
};

}  // namespace

SampledField::SampledField(const DistanceField& field, double cellSize) : band_(field.band()) {
  if (!(cellSize >= 0.0) || !std::isfinite(cellSize))
    throw Error("the cell size must be positive [m], or 0 to take the exact field's");
  cell_ = cellSize == 0.0 ? field.cellSize() : cellSize;
  inverseCell_ = 1.0 / cell_;
  const Box wanted = field.polygon().bounds().grown(band_ + cell_);
  const Vec2 size = wanted.size();
  const double columns = std::ceil(size.x() / cell_);
  const double rows = std::ceil(size.y() / cell_);
  if (!((columns + 1.0) * (rows + 1.0) <= kMostNodes))
    throw Error("a sampled field of so small cells needs more than 16 million nodes; make the cells larger");
  nx_ = static_cast<int>(columns);
  ny_ = static_cast<int>(rows);
  box_ = {wanted.min, wanted.min + Vec2(nx_, ny_) * cell_};
  fill(field);
  boundError(field);
}

void SampledField::fill(const DistanceField& field) {
  const std::size_t stride = static_cast<std::size_t>(nx_) + 1;
  nodes_.resize(stride * (static_cast<std::size_t>(ny_) + 1));
  const double reach = band_ + 2.0 * cell_;
  parallelFor(static_cast<std::size_t>(ny_) + 1, 8, [&](std::size_t begin, std::size_t end) {
    for (std::size_t j = begin; j < end; ++j) {
      for (std::size_t i = 0; i < stride; ++i) {
        const Vec2 p = box_.min + Vec2(static_cast<double>(i), static_cast<double>(j)) * cell_;
        FieldSample s = field.sample(p);
        if (!s.exact && std::abs(s.distance) <= reach) s = field.sampleExact(p);
        nodes_[j * stride + i] =
            s.exact ? static_cast<float>(s.distance) : std::copysign(kBeyond, static_cast<float>(s.distance));
      }
    }
  });
}

void SampledField::boundError(const DistanceField& field) {
  ErrorSearch search(field, *this);
  const auto eachCell = [&](const auto& visit) {
    for (int j = 0; j < ny_; ++j) {
      for (int i = 0; i < nx_; ++i) visit(Vec2(box_.min + Vec2(i + 0.5, j + 0.5) * cell_));
    }
  };
  // A first look finds an error near the largest, so that few squares need to be divided.
  eachCell([&](const Vec2& center) {
    if (std::abs(field.lowerBound(center)) < band_ + cell_) search.look(center, 0.5 * cell_);
  });
  eachCell([&](const Vec2& center) {
    if (std::abs(field.lowerBound(center)) < band_ + cell_) search.divide(center, 0.5 * cell_, 0);
  });
  // Nodes are rounded to single precision.
  errorBound_ = search.bound() + 0x1p-23 * (band_ + 2.0 * cell_);
}

SampledValue SampledField::sample(const Vec2& p) const {
  if (!box_.contains(p)) return {band_, {0.0, 0.0}, false};
  const double x = (p.x() - box_.min.x()) * inverseCell_;
  const double y = (p.y() - box_.min.y()) * inverseCell_;
  const double i = std::min(std::floor(x), nx_ - 1.0);
  const double j = std::min(std::floor(y), ny_ - 1.0);
  const std::size_t stride = static_cast<std::size_t>(nx_) + 1;
  const float* low = nodes_.data() + static_cast<std::size_t>(j) * stride + static_cast<std::size_t>(i);
  const double a = static_cast<double>(low[0]), b = static_cast<double>(low[1]);
  const double c = static_cast<double>(low[stride]), d = static_cast<double>(low[stride + 1]);
  const double fx = x - i, fy = y - j;
  const double bottom = a + fx * (b - a), top = c + fx * (d - c);
  const double distance = bottom + fy * (top - bottom);
  if (!(std::abs(distance) <= band_)) return {std::copysign(band_, distance), {0.0, 0.0}, false};
  const double gx = (b - a) + fy * ((d - c) - (b - a)), gy = top - bottom;
  const double length = std::sqrt(gx * gx + gy * gy);
  const double scale = length > 0.0 ? 1.0 / length : 0.0;
  return {distance, {gx * scale, gy * scale}, true};
}

}  // namespace froude
