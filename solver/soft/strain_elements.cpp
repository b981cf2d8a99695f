#include <froude/solver/soft/strain_elements.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include <froude/base/assert.h>

namespace froude {
namespace {

constexpr std::uint32_t kNone = 0xFFFFFFFFu;

struct Element {
  std::array<std::uint32_t, 2> sides{kNone, kNone};  // 3 · triangle + side
  std::array<std::uint32_t, 4> node{};
  std::array<Vec2, 4> b{Vec2(0, 0), Vec2(0, 0), Vec2(0, 0), Vec2(0, 0)};
  std::array<double, 4> share{};  // of the nodes in the area
  double area = 0.0;
  int nodes = 0;
};

double doubleArea(const TriangleMesh& mesh, const std::array<std::uint32_t, 3>& t) {
  return cross(Vec2(mesh.points[t[1]] - mesh.points[t[0]]), Vec2(mesh.points[t[2]] - mesh.points[t[0]]));
}

// Gradient of the shape function of the triangle's corner k.
Vec2 shapeGradient(const TriangleMesh& mesh, const std::array<std::uint32_t, 3>& t, std::size_t k) {
  const Vec2 across = mesh.points[t[(k + 2) % 3]] - mesh.points[t[(k + 1) % 3]];
  return leftNormal(across) / doubleArea(mesh, t);
}

// Adds a third of a triangle, weighted by its area.
void blend(const TriangleMesh& mesh, const std::array<std::uint32_t, 3>& t, double share, Element& e) {
  const double area = 0.5 * share * doubleArea(mesh, t);
  for (std::size_t k = 0; k < 3; ++k) {
    int at = 0;
    while (at < e.nodes && e.node[static_cast<std::size_t>(at)] != t[k]) ++at;
    if (at == e.nodes) e.node[static_cast<std::size_t>(e.nodes++)] = t[k];
    e.b[static_cast<std::size_t>(at)] += area * shapeGradient(mesh, t, k);
    e.share[static_cast<std::size_t>(at)] += area / 3.0;
  }
  e.area += area;
}

// Largest eigenvalue of area · Σ b_k b_kᵀ / share_k [1/m²]: times the wave modulus over the density, the square of the
// highest angular frequency of the element alone (two uncoupled directions at most).
double stiffest(const Element& e) {
  double xx = 0.0, xy = 0.0, yy = 0.0;
  for (std::size_t k = 0; k < 4 && static_cast<int>(k) < e.nodes; ++k) {
    const Vec2 b = e.b[k] / e.area;
    const double ratio = e.area / e.share[k];
    xx += ratio * b.x() * b.x();
    xy += ratio * b.x() * b.y();
    yy += ratio * b.y() * b.y();
  }
  return 0.5 * (xx + yy) + std::sqrt(0.25 * (xx - yy) * (xx - yy) + xy * xy);
}

std::vector<Element> trianglePieces(const TriangleMesh& mesh) {
  std::vector<Element> elements;
  for (const auto& t : mesh.triangles) {
    Element e;
    blend(mesh, t, 1.0, e);
    elements.push_back(e);
  }
  return elements;
}

std::vector<Element> edgePieces(const TriangleMesh& mesh) {
  struct Side {
    std::uint32_t low, high, triangle, number;
  };
  std::vector<Side> sides;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = mesh.triangles[t][k], b = mesh.triangles[t][(k + 1) % 3];
      sides.push_back({std::min(a, b), std::max(a, b), t, 3 * t + static_cast<std::uint32_t>(k)});
    }
  }
  std::stable_sort(sides.begin(), sides.end(),
                   [](const Side& a, const Side& b) { return a.low != b.low ? a.low < b.low : a.high < b.high; });
  std::vector<Element> elements;
  for (std::size_t i = 0; i < sides.size();) {
    Element e;
    std::size_t j = i;
    for (; j < std::min(sides.size(), i + 2) && sides[j].low == sides[i].low && sides[j].high == sides[i].high; ++j) {
      blend(mesh, mesh.triangles[sides[j].triangle], 1.0 / 3.0, e);
      e.sides[j - i] = sides[j].number;
    }
    elements.push_back(e);
    i = j;
  }
  return elements;
}

// First fit, in the order of the elements.
std::vector<std::uint32_t> colorsOf(const std::vector<Element>& elements, std::size_t nodes, std::uint32_t& count) {
  std::vector<std::uint32_t> colors(elements.size());
  std::vector<std::uint64_t> taken(nodes, 0);
  count = 0;
  for (std::size_t e = 0; e < elements.size(); ++e) {
    std::uint64_t busy = 0;
    for (int k = 0; k < elements[e].nodes; ++k) busy |= taken[elements[e].node[static_cast<std::size_t>(k)]];
    const auto color = static_cast<std::uint32_t>(std::countr_one(busy));
    FROUDE_ASSERT(color < 64);
    for (int k = 0; k < elements[e].nodes; ++k) {
      taken[elements[e].node[static_cast<std::size_t>(k)]] |= std::uint64_t{1} << color;
    }
    colors[e] = color;
    count = std::max(count, color + 1);
  }
  return colors;
}

void append(StrainElements& out, const Element& e, std::span<const double> inverseMass) {
  const double inverse = e.area > 0.0 ? 1.0 / e.area : 0.0;
  double xx = 0.0, xy = 0.0, yy = 0.0;
  for (std::size_t k = 0; k < 4; ++k) {
    // Of a piece with three nodes the fourth is its first again, without a share.
    const std::uint32_t node = static_cast<int>(k) < e.nodes ? e.node[k] : e.node[0];
    out.node[k].push_back(node);
    const Vec2 b = inverse * e.b[k];
    if (k > 0) {
      out.b[2 * k - 2].push_back(b.x());
      out.b[2 * k - 1].push_back(b.y());
    }
    if (static_cast<int>(k) >= e.nodes) continue;
    const double w = inverseMass[node];
    xx += w * b.x() * b.x();
    xy += w * b.x() * b.y();
    yy += w * b.y() * b.y();
  }
  out.inertia[0].push_back(xx);
  out.inertia[1].push_back(xy);
  out.inertia[2].push_back(yy);
  out.area.push_back(e.area);
}

}  // namespace

StrainElements compileStrain(const TriangleMesh& mesh, StrainPieces pieces, std::span<const double> inverseMass) {
  const std::vector<Element> elements = pieces == StrainPieces::Triangles ? trianglePieces(mesh) : edgePieces(mesh);
  std::uint32_t count = 0;
  const std::vector<std::uint32_t> colors = colorsOf(elements, mesh.points.size(), count);
  StrainElements out;
  out.ofEdge.resize(3 * mesh.triangles.size(), kNone);
  Element none;
  none.node.fill(static_cast<std::uint32_t>(mesh.points.size()));
  for (std::uint32_t c = 0; c < count; ++c) {
    out.colors.push_back(out.size());
    for (std::size_t e = 0; e < elements.size(); ++e) {
      if (colors[e] != c) continue;
      for (const std::uint32_t side : elements[e].sides) {
        if (side != kNone) out.ofEdge[side] = static_cast<std::uint32_t>(out.size());
      }
      append(out, elements[e], inverseMass);
    }
    while (out.size() % kElementLanes != 0) append(out, none, inverseMass);
  }
  out.colors.push_back(out.size());
  for (auto& g : out.given) g.resize(out.size());
  for (const Element& e : elements) out.stiffest = std::max(out.stiffest, stiffest(e));
  return out;
}

namespace {

Eigen::Matrix2d gradientOf(const StrainElements& el, std::size_t e, const double* x, const double* y) {
  const std::uint32_t o = el.node[0][e];
  Eigen::Matrix2d f = Eigen::Matrix2d::Zero();
  for (std::size_t k = 1; k < 4; ++k) {
    const double dx = x[el.node[k][e]] - x[o], dy = y[el.node[k][e]] - y[o];
    f(0, 0) += dx * el.b[2 * k - 2][e];
    f(0, 1) += dx * el.b[2 * k - 1][e];
    f(1, 0) += dy * el.b[2 * k - 2][e];
    f(1, 1) += dy * el.b[2 * k - 1][e];
  }
  return f;
}

}  // namespace

double stretchOf(const StrainElements& el, std::size_t e, const double* x, const double* y) {
  const Eigen::Matrix2d f = gradientOf(el, e, x, y);
  return 0.5 * (std::hypot(f(0, 0) + f(1, 1), f(1, 0) - f(0, 1)) + std::hypot(f(0, 0) - f(1, 1), f(1, 0) + f(0, 1)));
}

double strainEnergy(StrainModel model, const Lame& lame, const StrainElements& el, const double* x, const double* y) {
  double sum = 0.0;
  const double bulk = lame.lambda + lame.mu, gamma = 1.0 + lame.mu / bulk;
  for (std::size_t e = 0; e < el.size(); ++e) {
    if (!(el.area[e] > 0.0)) continue;
    const Eigen::Matrix2d f = gradientOf(el, e, x, y);
    const double f00 = f(0, 0), f01 = f(0, 1), f10 = f(1, 0), f11 = f(1, 1);
    const double g00 = f00 * f00 + f10 * f10, g01 = f00 * f01 + f10 * f11, g11 = f01 * f01 + f11 * f11;
    if (model == StrainModel::NeoHookean) {
      const double j = f00 * f11 - f01 * f10;
      sum += el.area[e] * (0.5 * lame.mu * (g00 + g11 - 2.0) +
                           0.5 * bulk * ((j - gamma) * (j - gamma) - (1.0 - gamma) * (1.0 - gamma)));
    } else {
      const double e0 = 0.5 * (g00 - 1.0), e1 = 0.5 * (g11 - 1.0), e2 = 0.5 * g01;
      const double trace = e0 + e1;
      sum += el.area[e] * (lame.mu * (e0 * e0 + e1 * e1 + 2.0 * e2 * e2) + 0.5 * lame.lambda * trace * trace);
    }
  }
  return sum;
}

}  // namespace froude
