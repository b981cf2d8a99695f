// What soft bodies hold: mass, momentum, energy, area; and their saved state.
#include <cmath>

#include <froude/solver/soft/soft_bodies.h>

namespace froude {

SoftSums SoftBodies::sumsOf(std::size_t i) const {
  const SoftBody& b = body(i);
  const std::size_t f = first_[i];
  const double *x = pool_.x().data() + f, *y = pool_.y().data() + f;
  const double *vx = pool_.vx().data() + f, *vy = pool_.vy().data() + f;
  SoftSums s;
  double fastest = 0.0;
  for (std::size_t k = 0; k < b.points(); ++k) {
    const double m = b.mass[k], square = vx[k] * vx[k] + vy[k] * vy[k];
    s.massCenter += m * Vec2(x[k], y[k]);
    s.momentum += m * Vec2(vx[k], vy[k]);
    s.angular += m * (x[k] * vy[k] - y[k] * vx[k]);
    s.kinetic += 0.5 * m * square;
    fastest = std::max(fastest, square);
  }
  s.mass = b.totalMass;
  s.maxSpeed = std::sqrt(fastest);
  s.strain = strainEnergyOf(i);
  return s;
}

// Elastic energy, and what the inner pressure could still do.
double SoftBodies::strainEnergyOf(std::size_t i) const {
  const SoftBody& b = body(i);
  const std::size_t f = first_[i];
  const double *x = pool_.x().data() + f, *y = pool_.y().data() + f;
  double energy = 0.0;
  if (b.isStrain()) {
    energy = strainEnergy(b.strainModel(), b.lame, b.elements, x, y);
  } else if (!b.clusters.empty()) {
    energy = b.clusters.energy(b.matching, x, y);
  } else {
    energy = b.links.energy(x, y);
  }
  double gain = 0.0;  // twice the area that is enclosed more than at rest
  for (const auto& [p, q] : b.inflated) {
    gain += (x[p] - x[0]) * (y[q] - y[0]) - (y[p] - y[0]) * (x[q] - x[0]);
    const Vec2 o = b.def.mesh->points[0];
    gain -= cross(Vec2(b.def.mesh->points[p] - o), Vec2(b.def.mesh->points[q] - o));
  }
  return energy - 0.5 * b.def.pressure * gain;
}

void SoftBodies::strainOf(std::size_t i, std::vector<double>& values) const {
  const SoftBody& b = body(i);
  const std::size_t f = first_[i];
  const double *x = pool_.x().data() + f, *y = pool_.y().data() + f;
  if (b.def.model == SoftModel::Rope) {
    b.links.strain(x, y, values);
    return;
  }
  values.clear();
  const auto& rest = b.def.mesh->points;
  for (const auto& t : b.def.mesh->triangles) {
    const Vec2 u = rest[t[1]] - rest[t[0]], v = rest[t[2]] - rest[t[0]];
    const Vec2 p(x[t[1]] - x[t[0]], y[t[1]] - y[t[0]]), q(x[t[2]] - x[t[0]], y[t[2]] - y[t[0]]);
    const double inverse = 1.0 / cross(u, v);
    const double f00 = (p.x() * v.y() - q.x() * u.y()) * inverse, f01 = (q.x() * u.x() - p.x() * v.x()) * inverse;
    const double f10 = (p.y() * v.y() - q.y() * u.y()) * inverse, f11 = (q.y() * u.x() - p.y() * v.x()) * inverse;
    const double mean = 0.5 * std::hypot(f00 + f11, f10 - f01), half = 0.5 * std::hypot(f00 - f11, f10 + f01);
    values.push_back(std::max(std::abs(mean + half - 1.0), std::abs(mean - half - 1.0)));
  }
  // Torn: two of a triangle's edges or more have given way.
  if (b.def.strainLimit == 0.0) return;
  for (std::size_t t = 0; t < values.size(); ++t) {
    if (b.tornEdges(t) >= 2) values[t] = std::nan("");
  }
}

std::size_t SoftBodies::tornOf(std::size_t i) const { return body(i).links.torn() + body(i).tornTriangles(); }

SoftSums SoftBodies::sums() const {
  SoftSums all;
  for (std::size_t i = 0; i < count(); ++i) {
    const SoftSums s = sumsOf(i);
    all.mass += s.mass;
    all.kinetic += s.kinetic;
    all.strain += s.strain;
    all.momentum += s.momentum;
    all.massCenter += s.massCenter;
    all.angular += s.angular;
    all.maxSpeed = std::max(all.maxSpeed, s.maxSpeed);
  }
  return all;
}

double SoftBodies::areaOf(std::size_t i) const {
  const std::size_t f = first_[i];
  double twice = 0.0;
  for (const auto& t : body(i).def.mesh->triangles) {
    const Vec2 a(pool_.x()[f + t[0]], pool_.y()[f + t[0]]), b(pool_.x()[f + t[1]], pool_.y()[f + t[1]]);
    const Vec2 c(pool_.x()[f + t[2]], pool_.y()[f + t[2]]);
    twice += cross(Vec2(b - a), Vec2(c - a));
  }
  return 0.5 * twice;
}

// Relative to the motion of the body as a rigid whole, so that momentum and spin stay; towards rest where it is pinned.
void SoftBodies::damp(std::size_t i, double keep) {
  const SoftBody& b = body(i);
  const std::size_t o = offset(i);
  Vec2 center(0.0, 0.0), velocity(0.0, 0.0);
  double inertia = 0.0, angular = 0.0;
  if (!b.anyPinned) {
    for (std::size_t k = 0; k < b.points(); ++k) {
      center += b.mass[k] * Vec2(x_[o + k], y_[o + k]);
      velocity += b.mass[k] * Vec2(vx_[o + k], vy_[o + k]);
    }
    center /= b.totalMass;
    velocity /= b.totalMass;
    for (std::size_t k = 0; k < b.points(); ++k) {
      const Vec2 arm = Vec2(x_[o + k], y_[o + k]) - center;
      inertia += b.mass[k] * arm.squaredNorm();
      angular += b.mass[k] * cross(arm, Vec2(vx_[o + k], vy_[o + k]));
    }
  }
  const double spin = inertia > 0.0 ? angular / inertia : 0.0;
  for (std::size_t k = 0; k < b.points(); ++k) {
    if (b.inverseMass[k] == 0.0) continue;
    const Vec2 rigid = velocity + cross(spin, Vec2(Vec2(x_[o + k], y_[o + k]) - center));
    vx_[o + k] = rigid.x() + keep * (vx_[o + k] - rigid.x());
    vy_[o + k] = rigid.y() + keep * (vy_[o + k] - rigid.y());
  }
}

// Pieces give way that are stretched too far.
void SoftBodies::tear(std::size_t i) {
  SoftBody& b = *bodies_[i];
  if (b.def.strainLimit == 0.0 || !b.clusters.empty()) return;
  const double *x = pool_.x().data() + first_[i], *y = pool_.y().data() + first_[i];
  if (!b.links.empty()) {
    b.links.tear(b.def.strainLimit, x, y);
    return;
  }
  for (std::size_t e = 0; e < b.elements.size(); ++e) {
    if (b.elements.area[e] > 0.0 && stretchOf(b.elements, e, x, y) > 1.0 + b.def.strainLimit) b.elements.area[e] = 0.0;
  }
}

void SoftBodies::archive(Archive& a) {
  const std::size_t rows = a.count("rows", pool_.size());
  if (rows != pool_.size()) throw Error("the saved world has other soft bodies");
  pool_.archive(a);
  for (std::size_t i = 0; i < count(); ++i) {
    SoftBody& b = *bodies_[i];
    if (b.def.strainLimit == 0.0) continue;
    a.beginSection("soft" + std::to_string(i));
    a.array("areas", b.elements.area);
    b.links.archive(a);
    a.endSection();
  }
}

}  // namespace froude
