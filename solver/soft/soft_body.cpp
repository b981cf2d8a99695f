#include <froude/solver/soft/soft_body.h>

#include <algorithm>
#include <cmath>

namespace froude {
namespace {

[[noreturn]] void refuse(const SoftDef& def, const std::string& what) {
  throw Error("soft body '" + def.name + "': " + what);
}

void check(const SoftDef& def) {
  if (def.mesh == nullptr) refuse(def, "it has no mesh");
  const std::size_t points = def.mesh->points.size();
  if (points < 2) refuse(def, "it needs at least two points");
  if (!(def.density > 0.0) || !std::isfinite(def.density)) refuse(def, "density must be positive");
  if (!(def.young > 0.0) || !std::isfinite(def.young)) refuse(def, "young must be positive");
  if (!(def.poisson >= 0.0 && def.poisson < 0.5)) {
    refuse(def, "poisson must be at least 0 and below 0.5; 0.49 is nearly incompressible");
  }
  if (!(def.damping >= 0.0) || !std::isfinite(def.damping)) refuse(def, "damping must be at least 0 1/s");
  if (!(def.friction >= 0.0)) refuse(def, "friction must be at least 0");
  if (!(def.strainLimit >= 0.0)) refuse(def, "strainLimit must be at least 0");
  if (!(def.spacing > 0.0)) refuse(def, "spacing must be a positive length");
  if (!std::isfinite(def.pressure)) refuse(def, "pressure must be finite");
  if (!def.position.allFinite() || !std::isfinite(def.angle) || !def.velocity.allFinite() || !std::isfinite(def.spin)) {
    refuse(def, "position, angle, velocity and spin must be finite");
  }
  for (const Vec2& p : def.mesh->points) {
    if (!p.allFinite()) refuse(def, "a point of its mesh is not finite");
  }
  for (const auto& t : def.mesh->triangles) {
    for (const std::uint32_t k : t) {
      if (k >= points) refuse(def, "a triangle names a point that is not there");
    }
    const Vec2& a = def.mesh->points[t[0]];
    if (!(cross(Vec2(def.mesh->points[t[1]] - a), Vec2(def.mesh->points[t[2]] - a)) > 0.0)) {
      refuse(def, "its triangles must be counter-clockwise and have an area");
    }
  }
  for (const std::uint32_t k : def.pinned) {
    if (k >= points) refuse(def, "a pinned point is not there");
  }
  if (def.model == SoftModel::Rope) {
    if (!(def.thickness > 0.0)) refuse(def, "a rope needs a positive thickness");
    for (std::size_t k = 1; k < points; ++k) {
      if (!((def.mesh->points[k] - def.mesh->points[k - 1]).norm() > 0.0)) refuse(def, "two of its points coincide");
    }
  } else if (def.mesh->triangles.empty()) {
    refuse(def, "its mesh has no triangles");
  }
}

// Rings of the outline that run clockwise.
std::vector<std::array<std::uint32_t, 2>> holesOf(const TriangleMesh& mesh) {
  std::vector<std::array<std::uint32_t, 2>> holes;
  for (std::size_t begin = 0, end; begin < mesh.outline.size(); begin = end) {
    double twice = 0.0;
    for (end = begin; end < mesh.outline.size(); ++end) {
      if (end > begin && mesh.outline[end][0] != mesh.outline[end - 1][1]) break;
      twice += cross(mesh.points[mesh.outline[end][0]], mesh.points[mesh.outline[end][1]]);
    }
    if (twice < 0.0) {
      holes.insert(holes.end(), mesh.outline.begin() + static_cast<std::ptrdiff_t>(begin),
                   mesh.outline.begin() + static_cast<std::ptrdiff_t>(end));
    }
  }
  return holes;
}

}  // namespace

SoftBody::SoftBody(SoftDef definition) : def(std::move(definition)) {
  check(def);
  lame = Lame::of(def.young, def.poisson);
  const TriangleMesh& mesh = *def.mesh;
  mass.assign(points(), 0.0);
  if (def.model == SoftModel::Rope) {
    for (std::size_t k = 0; k + 1 < points(); ++k) {
      const double half = 0.5 * def.density * def.thickness * (mesh.points[k + 1] - mesh.points[k]).norm();
      mass[k] += half;
      mass[k + 1] += half;
    }
  }
  for (const auto& t : mesh.triangles) {
    const Vec2& a = mesh.points[t[0]];
    const double area = 0.5 * cross(Vec2(mesh.points[t[1]] - a), Vec2(mesh.points[t[2]] - a));
    for (const std::uint32_t k : t) mass[k] += def.density * area / 3.0;
  }
  inverseMass.resize(points());
  for (std::size_t k = 0; k < points(); ++k) {
    if (!(mass[k] > 0.0)) refuse(def, "point " + std::to_string(k) + " belongs to no triangle");
    inverseMass[k] = 1.0 / mass[k];
    totalMass += mass[k];
  }
  for (const std::uint32_t k : def.pinned) inverseMass[k] = 0.0;
  anyPinned = !def.pinned.empty();
  compile();
  if (def.pressure != 0.0) {
    inflated = holesOf(mesh);
    if (inflated.empty()) {
      inflated = mesh.outline;
    } else {
      for (auto& edge : inflated) std::swap(edge[0], edge[1]);  // the hole's own side to the left
    }
  }
}

void SoftBody::compile() {
  const TriangleMesh& mesh = *def.mesh;
  switch (def.model) {
    case SoftModel::NeoHookean:
    case SoftModel::StVenantKirchhoff:
      elements = compileStrain(mesh, StrainPieces::Edges, inverseMass);
      frequencySquared = elements.stiffest * lame.waveModulus() / def.density;
      break;
    case SoftModel::Rope:
      links = Links::rope(mesh, def.young, def.thickness, def.density, inverseMass);
      frequencySquared = links.frequencySquared();
      break;
    case SoftModel::Springs:
      links = Links::springs(mesh, lame, def.density);
      frequencySquared = links.frequencySquared();
      break;
    case SoftModel::ShapeMatching:
      clusters = ShapeClusters(mesh.points, mass, def.spacing);
      // A wave of the length of a cluster: what is longer is what the model leaves to the clusters' overlap.
      matching = def.young / (def.density * clusters.radius() * clusters.radius());
      frequencySquared = matching;
      break;
  }
}

int SoftBody::tornEdges(std::size_t triangle) const {
  int torn = 0;
  for (std::size_t k = 0; k < 3 && isStrain(); ++k) torn += elements.area[elements.ofEdge[3 * triangle + k]] == 0.0;
  return torn;
}

std::size_t SoftBody::tornTriangles() const {
  std::size_t count = 0;
  if (!isStrain() || def.strainLimit == 0.0) return 0;
  for (std::size_t t = 0; t < def.mesh->triangles.size(); ++t) count += tornEdges(t) >= 2 ? 1 : 0;
  return count;
}

bool SoftBody::isTangled(const double* x, const double* y) const {
  const TriangleMesh& mesh = *def.mesh;
  if (!isStrain() || def.strainLimit > 0.0) return false;
  bool far = false;
  for (const auto& t : mesh.triangles) {
    const Vec2 a(x[t[0]], y[t[0]]), b(x[t[1]], y[t[1]]), c(x[t[2]], y[t[2]]);
    const double area = cross(Vec2(b - a), Vec2(c - a));
    if (!(area > 0.0)) return true;
    // Edges' squares over twice the area: 3.5 of the equilateral, 5.8 where six go round a point twice.
    far = far || (b - a).squaredNorm() + (c - b).squaredNorm() + (a - c).squaredNorm() > 5.0 * area;
  }
  if (!far) return false;
  around_.assign(points(), 0.0);
  auto add = [&](std::uint32_t at, const Vec2& p, const Vec2& q) { around_[at] += std::atan2(cross(p, q), p.dot(q)); };
  for (const auto& t : mesh.triangles) {
    const Vec2 a(x[t[0]], y[t[0]]), b(x[t[1]], y[t[1]]), c(x[t[2]], y[t[2]]);
    add(t[0], b - a, c - a);
    add(t[1], c - b, a - b);
    add(t[2], a - c, b - c);
  }
  return std::any_of(around_.begin(), around_.end(), [](double sum) { return sum > 2.1 * kPi; });
}

}  // namespace froude
