// Points near the boundary, the two answers to each, and the sizes of the differences.
#include <froude/fields/openvdb/cross_check.h>

#include <cmath>

#include <froude/base/random.h>
#include <froude/fields/distance_field.h>
#include <froude/fields/openvdb/level_set.h>

namespace froude::vdb {
namespace {

constexpr std::uint64_t kSeed = 20010;  // of the points; any number
constexpr double kReach = 2.0;          // [voxels] how far from a point the interpolant and its difference look
constexpr double kMargin = 1.0;         // [voxels] OpenVDB's band has gaps near its edge; ours may lose a last bit
// Half the points lie along the edges, half around the vertices: corners are what a level set finds hard.
constexpr std::size_t kCornerShare = 2;

/// Gathers errors into a norm.
struct Gather {
  ErrorNorm norm;
  void add(double error) {
    ++norm.count;
    norm.max = std::max(norm.max, std::abs(error));
    norm.rms += error * error;
  }
  ErrorNorm done() const {
    ErrorNorm n = norm;
    if (n.count > 0) n.rms = std::sqrt(n.rms / static_cast<double>(n.count));
    return n;
  }
};

/// Points within `reach` [m] of the boundary.
std::vector<Vec2> pointsNear(const Polygon& polygon, double reach, std::size_t count) {
  std::vector<double> until;  // running length of the edges [m]
  double length = 0.0;
  for (std::uint32_t e = 0; e < polygon.edgeCount(); ++e)
    until.push_back(length += (polygon.edgeEnd(e) - polygon.edgeStart(e)).norm());
  RandomStream random(kSeed, polygon.edgeCount());
  std::vector<Vec2> points;
  for (std::size_t i = 0; i < count; ++i) {
    if (i % kCornerShare == 0) {
      const double angle = random.uniform(0.0, 2.0 * kPi), radius = reach * std::sqrt(random.uniform());
      const Vec2& vertex = polygon.edgeStart(random.below(polygon.edgeCount()));
      points.emplace_back(vertex + radius * Vec2(std::cos(angle), std::sin(angle)));
      continue;
    }
    const double at = length * random.uniform();
    const auto found = std::upper_bound(until.begin(), until.end() - 1, at);
    const auto e = static_cast<std::uint32_t>(found - until.begin());
    const Vec2 along = polygon.edgeEnd(e) - polygon.edgeStart(e);
    points.emplace_back(polygon.edgeStart(e) + random.uniform() * along +
                        random.uniform(-reach, reach) * rightNormal(along.normalized()));
  }
  return points;
}

/// True if the interior of the edge closest to p is closest all over the disc of `radius` about p: own distance grows
/// and others shrink by no more than the radius each.
bool isClear(const DistanceField& field, const Vec2& p, const FieldSample& s, double radius) {
  if (s.feature != FeatureKind::Edge) return false;
  bool alone = true;
  field.forEachEdgeNear(p, std::abs(s.distance) + 2.0 * radius,
                        [&](std::uint32_t e) { alone = alone && static_cast<std::int32_t>(e) == s.edge; });
  return alone;
}

/// What single precision can do to a value [voxels]: vertices and distances are floats, in voxels from the middle.
double roundingOf(int division, double halfBand) {
  constexpr double kUlp = 1.1920928955078125e-7;  // 2⁻²³
  return 4.0 * kUlp * (0.5 * division + halfBand + kReach);
}

CrossCheckRow compare(const Polygon& polygon, int division, const CrossCheckOptions& options) {
  CrossCheckRow row;
  const double h = polygon.bounds().size().maxCoeff() / division;
  row.voxelSize = h;
  row.rounding = roundingOf(division, options.halfBand);
  const DistanceField field(polygon, (options.halfBand + 2.0 * kReach + kMargin) * h);
  const LevelSet set(polygon, h, options.halfBand + kReach + kMargin);
  row.activeVoxels = set.activeVoxels();
  row.memoryBytes = set.memoryBytes();

  const std::vector<Vec2> points = pointsNear(polygon, options.halfBand * h, options.points);
  std::vector<double> distances(points.size());
  std::vector<Vec2> normals(points.size());
  set.sample(points, distances);
  set.normals(points, normals);
  Gather all, clear, turn;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const FieldSample s = field.sample(points[i]);
    const double error = (distances[i] - s.distance) / h;
    all.add(error);
    if ((distances[i] < 0.0) != (s.distance < 0.0)) {
      ++row.wrongSides;
      row.deepestWrong = std::max(row.deepestWrong, std::abs(s.distance) / h);
    }
    if (!isClear(field, points[i], s, kReach * h)) continue;
    clear.add(error);
    turn.add(std::atan2(cross(s.normal, normals[i]), s.normal.dot(normals[i])));
  }
  row.distance = all.done();
  row.clearDistance = clear.done();
  row.clearNormal = turn.done();
  return row;
}

/// Least squares through (log h, log error); NaN with fewer than two sizes or without an error.
double slopeOf(const std::vector<CrossCheckRow>& rows, double ErrorNorm::*part) {
  double n = 0.0, x = 0.0, y = 0.0, xx = 0.0, xy = 0.0;
  for (const CrossCheckRow& row : rows) {
    const double a = std::log(row.voxelSize), b = std::log(row.distance.*part * row.voxelSize);
    n += 1.0;
    x += a;
    y += b;
    xx += a * a;
    xy += a * b;
  }
  return rows.size() < 2 ? std::nan("") : (n * xy - x * y) / (n * xx - x * x);
}

}  // namespace

bool CrossCheck::clearAgrees() const {
  for (const CrossCheckRow& row : rows)
    if (row.clearDistance.max > row.rounding || row.clearNormal.max > 2.0 * row.rounding) return false;
  return true;
}

double CrossCheck::worst() const {
  double worst = 0.0;
  for (const CrossCheckRow& row : rows) worst = std::max(worst, row.distance.max);
  return worst;
}

CrossCheck crossCheck(const Polygon& polygon, const CrossCheckOptions& options) {
  if (options.divisions.empty() || *std::min_element(options.divisions.begin(), options.divisions.end()) < 8)
    throw Error("a cross-check wants voxel sizes of 8 or more along the polygon's longer side");
  if (!(options.halfBand >= 1.0 && options.halfBand <= 50.0))
    throw Error("a cross-check with a half band of " + std::to_string(options.halfBand) + " voxels; right is 1 to 50");
  CrossCheck check;
  for (const int division : options.divisions) check.rows.push_back(compare(polygon, division, options));
  check.slopeMax = slopeOf(check.rows, &ErrorNorm::max);
  check.slopeRms = slopeOf(check.rows, &ErrorNorm::rms);
  return check;
}

}  // namespace froude::vdb
