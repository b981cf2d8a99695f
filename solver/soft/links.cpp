#include <froude/solver/soft/links.h>

#include <algorithm>
#include <cmath>

#include <froude/base/archive.h>

namespace froude {
namespace {

template <std::size_t N>
struct Constraint {
  double value = 0.0;
  std::array<Vec2, N> gradient;
};

Vec2 at(const double* x, const double* y, std::uint32_t i) { return {x[i], y[i]}; }

Constraint<2> lengthOf(const Vec2& a, const Vec2& b, double rest) {
  const Vec2 d = b - a;
  const double length = d.norm();
  const Vec2 n = length > 0.0 ? Vec2(d / length) : Vec2(1.0, 0.0);
  return {length - rest, {-n, n}};
}

// The turn from ab to bc against that at rest, within half a turn.
Constraint<3> angleOf(const Vec2& a, const Vec2& b, const Vec2& c, double rest) {
  const Vec2 first = b - a, second = c - b;
  const double turn = std::atan2(cross(first, second), first.dot(second)) - rest;
  const Vec2 ga = leftNormal(first) / std::max(first.squaredNorm(), 1e-300);
  const Vec2 gc = leftNormal(second) / std::max(second.squaredNorm(), 1e-300);
  return {std::remainder(turn, 2.0 * kPi), {ga, -ga - gc, gc}};
}

Constraint<3> areaOf(const Vec2& a, const Vec2& b, const Vec2& c, double rest) {
  return {0.5 * cross(Vec2(b - a), Vec2(c - a)) - rest,
          {0.5 * leftNormal(c - b), 0.5 * leftNormal(a - c), 0.5 * leftNormal(b - a)}};
}

template <std::size_t N>
void push(const Constraint<N>& c, const std::array<std::uint32_t, N>& nodes, double stiffness, double& given,
          const NodeColumns& n) {
  given = -c.value;
  for (std::size_t k = 0; k < N; ++k) {
    n.fx[nodes[k]] -= stiffness * c.value * c.gradient[k].x();
    n.fy[nodes[k]] -= stiffness * c.value * c.gradient[k].y();
  }
}

// `given` is compliance times multiplier, as in StrainElements.
template <std::size_t N>
void correct(const Constraint<N>& c, const std::array<std::uint32_t, N>& nodes, double stiffness, double dtSquared,
             double& given, const NodeColumns& n) {
  double w = 0.0;
  for (std::size_t k = 0; k < N; ++k) w += n.inverseMass[nodes[k]] * c.gradient[k].squaredNorm();
  const double change = (-c.value - given) / (1.0 + dtSquared * stiffness * w);
  given += change;
  const double step = dtSquared * stiffness * change;
  for (std::size_t k = 0; k < N; ++k) {
    n.x[nodes[k]] += step * n.inverseMass[nodes[k]] * c.gradient[k].x();
    n.y[nodes[k]] += step * n.inverseMass[nodes[k]] * c.gradient[k].y();
  }
}

}  // namespace

Links Links::rope(const TriangleMesh& mesh, double young, double thickness, double density,
                  std::span<const double> inverseMass) {
  Links links;
  const auto& p = mesh.points;
  double axial = 0.0, bending = 0.0;
  for (std::uint32_t k = 0; k + 1 < p.size(); ++k) {
    const double length = (p[k + 1] - p[k]).norm();
    links.lengths_.push_back({k, k + 1, length, young * thickness / length, 0.0});
    axial = std::max(axial, 4.0 * young / (density * length * length));
  }
  const double stiffness = young * thickness * thickness * thickness / 12.0;
  for (std::uint32_t k = 1; k + 1 < p.size(); ++k) {
    const Vec2 before = p[k] - p[k - 1], after = p[k + 1] - p[k];
    auto bends = [&](std::uint32_t i) { return inverseMass[i] > 0.0 || inverseMass[i + 1] > 0.0 ? 0.5 : 0.0; };
    const double along = std::max(bends(k - 1) * before.norm() + bends(k) * after.norm(), 0.25 * after.norm());
    const double least = std::min(before.norm(), after.norm());
    const double rest = std::atan2(cross(before, after), before.dot(after));
    links.angles_.push_back({k - 1, k, k + 1, rest, stiffness / along, 0.0});
    // A third of each point's mass, at least half a link's at the ends.
    const double share = density * thickness * least / 6.0;
    bending = std::max(bending, stiffness / along * 6.0 / (least * least * share));
  }
  links.frequencySquared_ = axial + bending;
  return links;
}

Links Links::springs(const TriangleMesh& mesh, const Lame& lame, double density) {
  Links links;
  struct Side {
    std::uint32_t low, high;
    double area;
  };
  std::vector<Side> sides;
  const double extra = std::max(0.0, lame.lambda - lame.mu);
  double inArea = 0.0, inLength = 0.0;
  for (const auto& t : mesh.triangles) {
    const Vec2 &a = mesh.points[t[0]], &b = mesh.points[t[1]], &c = mesh.points[t[2]];
    const double area = 0.5 * cross(Vec2(b - a), Vec2(c - a));
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t i = t[k], j = t[(k + 1) % 3];
      sides.push_back({std::min(i, j), std::max(i, j), area / 3.0});
    }
    if (extra > 0.0) links.areas_.push_back({t[0], t[1], t[2], area, extra / area, 0.0});
    const double squares = (b - a).squaredNorm() + (c - b).squaredNorm() + (a - c).squaredNorm();
    inArea = std::max(inArea, extra / area * 0.25 * squares / (density * area / 3.0));
  }
  std::stable_sort(sides.begin(), sides.end(),
                   [](const Side& a, const Side& b) { return a.low != b.low ? a.low < b.low : a.high < b.high; });
  for (std::size_t i = 0; i < sides.size();) {
    double area = 0.0;
    std::size_t j = i;
    for (; j < sides.size() && sides[j].low == sides[i].low && sides[j].high == sides[i].high; ++j) {
      area += sides[j].area;
    }
    const double length = (mesh.points[sides[i].high] - mesh.points[sides[i].low]).norm();
    links.lengths_.push_back({sides[i].low, sides[i].high, length, 8.0 * lame.mu * area / (length * length), 0.0});
    inLength = std::max(inLength, 32.0 * lame.mu / (density * length * length));
    i = j;
  }
  links.frequencySquared_ = inLength + inArea;
  return links;
}

void Links::force(const NodeColumns& n) {
  for (Length& l : lengths_) {
    push(lengthOf(at(n.x, n.y, l.a), at(n.x, n.y, l.b), l.rest), {l.a, l.b}, l.stiffness, l.given, n);
  }
  for (Angle& l : angles_) {
    push(angleOf(at(n.x, n.y, l.a), at(n.x, n.y, l.b), at(n.x, n.y, l.c), l.rest), {l.a, l.b, l.c}, l.stiffness,
         l.given, n);
  }
  for (Area& l : areas_) {
    push(areaOf(at(n.x, n.y, l.a), at(n.x, n.y, l.b), at(n.x, n.y, l.c), l.rest), {l.a, l.b, l.c}, l.stiffness, l.given,
         n);
  }
}

void Links::project(double dtSquared, const NodeColumns& n) {
  for (Length& l : lengths_) {
    correct(lengthOf(at(n.x, n.y, l.a), at(n.x, n.y, l.b), l.rest), {l.a, l.b}, l.stiffness, dtSquared, l.given, n);
  }
  for (Angle& l : angles_) {
    correct(angleOf(at(n.x, n.y, l.a), at(n.x, n.y, l.b), at(n.x, n.y, l.c), l.rest), {l.a, l.b, l.c}, l.stiffness,
            dtSquared, l.given, n);
  }
  for (Area& l : areas_) {
    correct(areaOf(at(n.x, n.y, l.a), at(n.x, n.y, l.b), at(n.x, n.y, l.c), l.rest), {l.a, l.b, l.c}, l.stiffness,
            dtSquared, l.given, n);
  }
}

double Links::energy(const double* x, const double* y) const {
  double sum = 0.0;
  auto add = [&](double value, double stiffness) { sum += 0.5 * stiffness * value * value; };
  for (const Length& l : lengths_) add(lengthOf(at(x, y, l.a), at(x, y, l.b), l.rest).value, l.stiffness);
  for (const Angle& l : angles_) {
    add(angleOf(at(x, y, l.a), at(x, y, l.b), at(x, y, l.c), l.rest).value, l.stiffness);
  }
  for (const Area& l : areas_) {
    add(areaOf(at(x, y, l.a), at(x, y, l.b), at(x, y, l.c), l.rest).value, l.stiffness);
  }
  return sum;
}

std::size_t Links::tear(double limit, const double* x, const double* y) {
  std::size_t count = 0;
  for (Length& l : lengths_) {
    if (l.stiffness == 0.0 || lengthOf(at(x, y, l.a), at(x, y, l.b), l.rest).value <= limit * l.rest) continue;
    l.stiffness = 0.0;
    ++count;
    auto isOn = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
      const bool hasA = l.a == a || l.a == b || l.a == c, hasB = l.b == a || l.b == b || l.b == c;
      return hasA && hasB;
    };
    for (Angle& other : angles_) {
      if (isOn(other.a, other.b, other.c)) other.stiffness = 0.0;
    }
    for (Area& other : areas_) {
      if (isOn(other.a, other.b, other.c)) other.stiffness = 0.0;
    }
  }
  return count;
}

std::size_t Links::torn() const {
  return static_cast<std::size_t>(
      std::count_if(lengths_.begin(), lengths_.end(), [](const Length& l) { return l.stiffness == 0.0; }));
}

void Links::strain(const double* x, const double* y, std::vector<double>& values) const {
  values.clear();
  for (const Length& l : lengths_) {
    values.push_back(std::abs(lengthOf(at(x, y, l.a), at(x, y, l.b), l.rest).value) / l.rest);
  }
}

void Links::archive(Archive& a) {
  flat_.clear();
  for (const Length& l : lengths_) flat_.push_back(l.stiffness);
  for (const Angle& l : angles_) flat_.push_back(l.stiffness);
  for (const Area& l : areas_) flat_.push_back(l.stiffness);
  a.bytes("links", flat_.data(), sizeof(double), flat_.size());
  if (!a.loading()) return;
  auto from = flat_.begin();
  for (Length& l : lengths_) l.stiffness = *from++;
  for (Angle& l : angles_) l.stiffness = *from++;
  for (Area& l : areas_) l.stiffness = *from++;
}

}  // namespace froude
