#include <froude/solver/fluid/wall_integral.h>

#include <array>

#include <froude/base/assert.h>
#include <froude/solver/fluid/kernel.h>

namespace froude {
namespace {

constexpr double kReach = kernel::kSupport;
constexpr double kShare4 = 0.8, kShare10 = 0.2;  // of m⁴ and m¹⁰ in the kernel, each normalised

// B_k = ∫ m^k ds and A_k = ∫ m^k dθ (dθ = d·ds/r²) along the line of an edge at distance d from the origin; s is
// measured from the foot of the perpendicular, r² = d² + s², m = 1 − r²/4 = M − s²/4. By parts and by splitting off one
// factor m:
//     B_k = (s·m^k + 2kM·B_{k−1})/(2k + 1),   A_k = A_{k−1} − (d/4)·B_{k−1}.
struct LineIntegrals {
  double kernel;  // ∫ w ds
  double angle;   // ∫ (1 − 2πG) dθ, 1 − 2πG(r) = 0.8 m⁵ + 0.2 m¹¹
};

LineIntegrals blendIntegrals(double d, double s, double theta) {
  const double big = 1.0 - 0.25 * d * d;
  const double m = big - 0.25 * s * s;
  double b = s, a = theta, power = 1.0;
  double b4 = 0.0, a5 = 0.0;
  for (int k = 1; k <= 11; ++k) {
    a -= 0.25 * d * b;  // A_k
    if (k == 5) a5 = a;
    power *= m;
    b = (s * power + 2.0 * k * big * b) / (2.0 * k + 1.0);  // B_k
    if (k == 4) b4 = b;
    if (k == 10) {
      a -= 0.25 * d * b;  // A_11
      break;
    }
  }
  return {(kShare4 * 5.0 * b4 + kShare10 * 11.0 * b) / (4.0 * kPi), kShare4 * a5 + kShare10 * a};
}

// Wendland's kernel is w/kWendland = 1 − 5/2 r² + 5/2 r³ − 15/16 r⁴ + 1/8 r⁵, and 2πG = 7/4 r² − 35/16 r⁴ + 7/4 r⁵ −
// 35/64 r⁶ + 1/16 r⁷. Of I_n = ∫ r^n ds each second one follows: I_n = (s·r^n + n·d²·I_{n−2})/(n + 1), from I_0 = s and
// I_{−1} = asinh(s/d).
LineIntegrals wendlandIntegrals(double d, double s, double theta) {
  const double d2 = d * d, r2 = d2 + s * s, r = std::sqrt(r2);
  const double i2 = (s * r2 + 2.0 * d2 * s) / 3.0, i4 = (s * r2 * r2 + 4.0 * d2 * i2) / 5.0;
  const double i1 = 0.5 * (s * r + (d > 0.0 ? d2 * std::asinh(s / d) : 0.0));
  const double i3 = (s * r2 * r + 3.0 * d2 * i1) / 4.0, i5 = (s * r2 * r2 * r + 5.0 * d2 * i3) / 6.0;
  return {kernel::kWendland * (s - 2.5 * i2 + 2.5 * i3 - 0.9375 * i4 + 0.125 * i5),
          theta - d * (1.75 * s - 2.1875 * i2 + 1.75 * i3 - 0.546875 * i4 + 0.0625 * i5)};
}

LineIntegrals lineIntegrals(kernel::Kind kind, double d, double s, double theta) {
  return kind == kernel::Kind::Blend ? blendIntegrals(d, s, theta) : wendlandIntegrals(d, s, theta);
}

// ∫ w dr from r to the support radius.
double radialIntegral(kernel::Kind kind, double r) {
  if (r >= kReach) return 0.0;
  return lineIntegrals(kind, 0.0, kReach, 0.0).kernel - lineIntegrals(kind, 0.0, r, 0.0).kernel;
}

struct Wedge {
  double lambda = 0.0;
  Vec2 gradient{0.0, 0.0};
};

// One visible piece of a wall from p1 to p2, seen counter-clockwise from the origin (cross(p1, p2) > 0).
Wedge integrateWedge(const Vec2& p1, const Vec2& p2, kernel::Kind kind) {
  const Vec2 along = p2 - p1;
  const double length = along.norm();
  Wedge wedge;
  if (length <= 0.0) return wedge;
  const Vec2 t = along / length;
  const Vec2 towards = rightNormal(t);  // from the origin to the wall: the way into the solid
  const double d = std::max(towards.dot(p1), 1e-12);
  if (d >= kReach) return wedge;
  const double half = std::sqrt(kReach * kReach - d * d);
  const double s1 = std::max(t.dot(p1), -half);
  const double s2 = std::min(t.dot(p2), half);
  if (s1 >= s2) return wedge;

  const LineIntegrals from = lineIntegrals(kind, d, s1, std::atan2(s1, d));
  const LineIntegrals to = lineIntegrals(kind, d, s2, std::atan2(s2, d));
  wedge.lambda = (to.angle - from.angle) / (2.0 * kPi);
  wedge.gradient = (to.kernel - from.kernel) * towards;
  // Shadow lines: only where the piece ends within the support radius.
  const double r1 = p1.norm();
  const double r2 = p2.norm();
  if (r1 < kReach && r1 > 0.0) wedge.gradient -= radialIntegral(kind, r1) / r1 * rightNormal(p1);
  if (r2 < kReach && r2 > 0.0) wedge.gradient -= radialIntegral(kind, r2) / r2 * leftNormal(p2);
  return wedge;
}

struct Front {
  Vec2 p1, p2;  // counter-clockwise as seen from the origin
  int owner;
};

void addShare(std::span<WallShare> shares, std::size_t& count, int owner, const Wedge& wedge) {
  std::size_t k = 0;
  while (k < count && shares[k].owner != owner) ++k;
  if (k == count) shares[count++] = {owner, 0.0, {0.0, 0.0}};
  shares[k].lambda += wedge.lambda;
  shares[k].gradient += wedge.gradient;
}

// Do the open angular ranges of two fronts overlap? Both are less than π wide.
bool anglesOverlap(const Front& e, const Front& f) {
  constexpr double kTouch = 1e-12;
  auto strictlyInside = [](const Front& range, const Vec2& p) {
    const double scale = p.norm();
    return cross(range.p1, p) > kTouch * scale * range.p1.norm() &&
           cross(p, range.p2) > kTouch * scale * range.p2.norm();
  };
  if (strictlyInside(e, f.p1) || strictlyInside(e, f.p2) || strictlyInside(f, e.p1) || strictlyInside(f, e.p2)) {
    return true;
  }
  // Equal ranges: neither end lies strictly inside the other.
  return strictlyInside(e, f.p1 / f.p1.norm() + f.p2 / f.p2.norm());
}

// Where the ray from the origin along u meets the line of the front; infinity if outside the front's range.
double rayDistance(const Front& f, const Vec2& u) {
  const Vec2 along = f.p2 - f.p1;
  const double denominator = cross(u, along);
  if (!(denominator > 0.0)) return kInfinity;
  if (cross(f.p1, u) < 0.0 || cross(u, f.p2) < 0.0) return kInfinity;
  return cross(f.p1, along) / denominator;
}

// Fronts that hide one another: between neighbouring end directions the nearest front is the visible one.
std::size_t integrateHidden(std::span<const Front> fronts, std::span<WallShare> shares, kernel::Kind kind) {
  std::array<double, 2 * kMaxWallEdges> angle;
  std::size_t n = 0;
  for (const Front& f : fronts) {
    angle[n++] = std::atan2(f.p1.y(), f.p1.x());
    angle[n++] = std::atan2(f.p2.y(), f.p2.x());
  }
  std::sort(angle.begin(), angle.begin() + static_cast<std::ptrdiff_t>(n));
  std::size_t count = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const double from = angle[i];
    const double to = i + 1 < n ? angle[i + 1] : angle[0] + 2.0 * kPi;
    if (to - from < 1e-13) continue;
    const double mid = 0.5 * (from + to);
    const Vec2 u(std::cos(mid), std::sin(mid));
    const Front* nearest = nullptr;
    double best = kInfinity;
    for (const Front& f : fronts) {
      const double r = rayDistance(f, u);
      if (r < best) {
        best = r;
        nearest = &f;
      }
    }
    if (nearest == nullptr) continue;
    const Vec2 along = nearest->p2 - nearest->p1;
    auto onFront = [&](double a) {
      const Vec2 v(std::cos(a), std::sin(a));
      return Vec2(v * (cross(nearest->p1, along) / cross(v, along)));
    };
    addShare(shares, count, nearest->owner, integrateWedge(onFront(from), onFront(to), kind));
  }
  return count;
}

constexpr std::size_t kTableSize = 512;

struct Table {
  std::array<HalfPlane, kTableSize + 1> entry;
  Table() {
    for (std::size_t i = 0; i <= kTableSize; ++i) {
      const double d = kReach * static_cast<double>(i) / kTableSize;
      const Wedge w = integrateWedge({3.0, std::max(d, 1e-12)}, {-3.0, std::max(d, 1e-12)}, kernel::Kind::Blend);
      entry[i] = {w.lambda, w.gradient.y()};
    }
  }
};

}  // namespace

std::size_t integrateWalls(std::span<const WallEdge> edges, std::span<WallShare> shares, kernel::Kind kind) {
  FROUDE_ASSERT(edges.size() <= kMaxWallEdges && shares.size() >= edges.size());
  std::array<Front, kMaxWallEdges> fronts;
  std::size_t n = 0;
  for (const WallEdge& e : edges) {
    if (cross(e.a, e.b) < 0.0) fronts[n++] = {e.b, e.a, e.owner};
  }
  bool hidden = false;
  for (std::size_t i = 0; i < n && !hidden; ++i) {
    for (std::size_t j = i + 1; j < n && !hidden; ++j) hidden = anglesOverlap(fronts[i], fronts[j]);
  }
  if (hidden) return integrateHidden({fronts.data(), n}, shares, kind);
  std::size_t count = 0;
  for (std::size_t i = 0; i < n; ++i)
    addShare(shares, count, fronts[i].owner, integrateWedge(fronts[i].p1, fronts[i].p2, kind));
  return count;
}

// Each edge's wedge reaches from the edge to infinity: those of the faces that look away take off what is not solid.
std::size_t integrateSolids(std::span<const WallEdge> edges, std::span<WallShare> shares, kernel::Kind kind) {
  std::size_t count = 0;
  for (const WallEdge& e : edges) {
    const bool front = cross(e.a, e.b) < 0.0;
    Wedge wedge = front ? integrateWedge(e.b, e.a, kind) : integrateWedge(e.a, e.b, kind);
    if (!front) wedge = {-wedge.lambda, -wedge.gradient};
    addShare(shares, count, e.owner, wedge);
  }
  return count;
}

namespace {

constexpr double kSharpest = 0.766;  // cosine of 40 degrees
constexpr double kInset = 0.5;       // how far from its ends a face is looked at [dx]

// How far along u from m, less than the support radius, is the edge? Infinity if it is not met.
double rayToEdge(const Vec2& m, const Vec2& u, const WallEdge& e) {
  const Vec2 along = e.b - e.a;
  const double denominator = cross(u, along);
  if (denominator == 0.0) return kInfinity;
  const double s = cross(e.a - m, along) / denominator;
  const double t = cross(e.a - m, u) / denominator;
  return s > 0.0 && s < kReach && t >= 0.0 && t <= 1.0 ? s : kInfinity;
}

bool isThinBehind(const WallEdge& away, std::span<const WallEdge> edges) {
  const Vec2 along = away.b - away.a;
  const double length = along.norm();
  const Vec2 direction = along / length;
  const double inset = std::min(kInset, 0.5 * length);
  const Vec2 m = away.a + std::clamp(-away.a.dot(direction), inset, length - inset) * direction;
  for (const WallEdge& e : edges) {
    if (&e == &away || e.owner != away.owner || rayToEdge(m, leftNormal(direction), e) == kInfinity) continue;
    const bool follows = e.a == away.b, precedes = e.b == away.a;
    if (!follows && !precedes) return true;
    // Neighbours at a sharp corner run nearly back on each other.
    if (-direction.dot((e.b - e.a).normalized()) > kSharpest) return true;
  }
  return false;
}

bool edgesCross(const WallEdge& e, const WallEdge& f) {
  auto side = [](const WallEdge& line, const Vec2& p) { return cross(line.b - line.a, p - line.a); };
  return side(e, f.a) * side(e, f.b) < 0.0 && side(f, e.a) * side(f, e.b) < 0.0;
}

}  // namespace

bool anyThin(std::span<const WallEdge> edges) {
  for (const WallEdge& e : edges) {
    if (cross(e.a, e.b) > 0.0 && isThinBehind(e, edges)) return true;
  }
  for (std::size_t i = 0; i < edges.size(); ++i) {
    for (std::size_t j = i + 1; j < edges.size(); ++j) {
      if (edges[i].owner != edges[j].owner && edgesCross(edges[i], edges[j])) return true;
    }
  }
  return false;
}

bool hiddenByThin(std::span<const WallEdge> edges, const Vec2& p) {
  std::array<Vec2, kMaxWallEdges> crossed;
  std::size_t n = 0;
  for (const WallEdge& e : edges) {
    if (!hidesPoint(e, p)) continue;
    const Vec2 direction = (e.b - e.a).normalized();
    for (std::size_t k = 0; k < n; ++k) {
      if (-crossed[k].dot(direction) > kSharpest) return true;
    }
    crossed[n++] = direction;
  }
  return false;
}

HalfPlane halfPlane(double distance) {
  static const Table table;
  const double x = std::abs(distance) * (kTableSize / kReach);
  if (!(x < kTableSize)) return {distance > 0.0 ? 0.0 : 1.0, 0.0};
  const auto i = static_cast<std::size_t>(x);
  const double f = x - static_cast<double>(i);
  const HalfPlane& a = table.entry[i];
  const HalfPlane& b = table.entry[i + 1];
  // Cubic Hermite for λ (its derivative is known exactly), linear for the slope's residual.
  constexpr double kStep = kReach / kTableSize;
  const double h00 = (1.0 + 2.0 * f) * (1.0 - f) * (1.0 - f), h10 = f * (1.0 - f) * (1.0 - f);
  const double h01 = f * f * (3.0 - 2.0 * f), h11 = f * f * (f - 1.0);
  const double lambda = h00 * a.lambda - h10 * kStep * a.slope + h01 * b.lambda - h11 * kStep * b.slope;
  const double slope = a.slope + f * (b.slope - a.slope);
  return {distance >= 0.0 ? lambda : 1.0 - lambda, slope};
}

double halfPlaneShare(double distance, kernel::Kind kind) {
  const double d = std::max(std::abs(distance), 1e-12);
  const double lambda = d < kReach ? integrateWedge({3.0, d}, {-3.0, d}, kind).lambda : 0.0;
  return distance >= 0.0 ? lambda : 1.0 - lambda;
}

}  // namespace froude
