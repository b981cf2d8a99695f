#include <cmath>

#include <froude/solver/soft/strain_elements.h>

namespace froude {
namespace {

struct Gradient {
  double f00, f01, f10, f11;
};

Gradient gradientAt(const StrainElements& el, const NodeColumns& n, std::size_t e) {
  const std::uint32_t i0 = el.node[0][e], i1 = el.node[1][e], i2 = el.node[2][e], i3 = el.node[3][e];
  const double x1 = n.x[i1] - n.x[i0], x2 = n.x[i2] - n.x[i0], x3 = n.x[i3] - n.x[i0];
  const double y1 = n.y[i1] - n.y[i0], y2 = n.y[i2] - n.y[i0], y3 = n.y[i3] - n.y[i0];
  return {x1 * el.b[0][e] + x2 * el.b[2][e] + x3 * el.b[4][e], x1 * el.b[1][e] + x2 * el.b[3][e] + x3 * el.b[5][e],
          y1 * el.b[0][e] + y2 * el.b[2][e] + y3 * el.b[4][e], y1 * el.b[1][e] + y2 * el.b[3][e] + y3 * el.b[5][e]};
}

// Adds w_k g b_k to the columns at all nodes, the shared last node first: its first node again is written after it.
void spread(const StrainElements& el, const double* weight, const Gradient& g, std::size_t e, double* x, double* y) {
  double sumX = 0.0, sumY = 0.0;
  for (std::size_t k = 3; k >= 1; --k) {
    const double dx = g.f00 * el.b[2 * k - 2][e] + g.f01 * el.b[2 * k - 1][e];
    const double dy = g.f10 * el.b[2 * k - 2][e] + g.f11 * el.b[2 * k - 1][e];
    const std::uint32_t i = el.node[k][e];
    const double w = weight != nullptr ? weight[i] : 1.0;
    x[i] += w * dx;
    y[i] += w * dy;
    sumX += dx;
    sumY += dy;
  }
  const std::uint32_t i = el.node[0][e];
  const double w = weight != nullptr ? weight[i] : 1.0;
  x[i] -= w * sumX;
  y[i] -= w * sumY;
}

void forceNeoHookean(const Lame& lame, StrainElements& el, const NodeColumns& n, std::size_t begin, std::size_t end) {
  const double bulk = lame.lambda + lame.mu, gamma = 1.0 + lame.mu / bulk;
  for (std::size_t e = begin; e < end; ++e) {
    const Gradient f = gradientAt(el, n, e);
    const double volume = (f.f00 * f.f11 - f.f01 * f.f10) - gamma;
    const double square = (f.f00 * f.f00 + f.f01 * f.f01) + (f.f10 * f.f10 + f.f11 * f.f11);
    el.given[0][e] = -std::sqrt(square);
    el.given[1][e] = -volume;
    const double p = -el.area[e] * lame.mu, q = -el.area[e] * bulk * volume;
    const Gradient g{p * f.f00 + q * f.f11, p * f.f01 - q * f.f10, p * f.f10 - q * f.f01, p * f.f11 + q * f.f00};
    spread(el, nullptr, g, e, n.fx, n.fy);
  }
}

void projectNeoHookean(const Lame& lame, double dtSquared, StrainElements& el, const NodeColumns& n, std::size_t begin,
                       std::size_t end) {
  const double bulk = lame.lambda + lame.mu, gamma = 1.0 + lame.mu / bulk;
  const double softD = 1.0 / lame.mu, softH = 1.0 / bulk;
  for (std::size_t e = begin; e < end; ++e) {
    const Gradient f = gradientAt(el, n, e);
    const double xx = el.inertia[0][e], xy = el.inertia[1][e], yy = el.inertia[2][e];
    const double square = (f.f00 * f.f00 + f.f01 * f.f01) + (f.f10 * f.f10 + f.f11 * f.f11);
    const double length = std::max(std::sqrt(square), 1e-12), inverse = 1.0 / length;
    const double rD = -length - el.given[0][e];
    const double rH = gamma - (f.f00 * f.f11 - f.f01 * f.f10) - el.given[1][e];
    // F and its cofactor, times the inertia: u = F B, then the products of rows.
    const double u00 = f.f00 * xx + f.f01 * xy, u01 = f.f00 * xy + f.f01 * yy;
    const double u10 = f.f10 * xx + f.f11 * xy, u11 = f.f10 * xy + f.f11 * yy;
    const double c00 = f.f11, c01 = -f.f10, c10 = -f.f01, c11 = f.f00;
    const double t00 = c00 * xx + c01 * xy, t01 = c00 * xy + c01 * yy;
    const double t10 = c10 * xx + c11 * xy, t11 = c10 * xy + c11 * yy;
    const double scale = dtSquared * el.area[e];
    const double dd = scale * inverse * inverse * ((u00 * f.f00 + u01 * f.f01) + (u10 * f.f10 + u11 * f.f11)) + softD;
    const double dh = scale * inverse * ((u00 * c00 + u01 * c01) + (u10 * c10 + u11 * c11));
    const double hh = scale * ((t00 * c00 + t01 * c01) + (t10 * c10 + t11 * c11)) + softH;
    const double divisor = 1.0 / (dd * hh - dh * dh);
    const double qD = (hh * rD - dh * rH) * divisor, qH = (dd * rH - dh * rD) * divisor;
    el.given[0][e] += softD * qD;
    el.given[1][e] += softH * qH;
    const double p = scale * qD * inverse, q = scale * qH;
    const Gradient g{p * f.f00 + q * c00, p * f.f01 + q * c01, p * f.f10 + q * c10, p * f.f11 + q * c11};
    spread(el, n.inverseMass, g, e, n.x, n.y);
  }
}

void forceStVenantKirchhoff(const Lame& lame, StrainElements& el, const NodeColumns& n, std::size_t begin,
                            std::size_t end) {
  for (std::size_t e = begin; e < end; ++e) {
    const Gradient f = gradientAt(el, n, e);
    const double e0 = 0.5 * ((f.f00 * f.f00 + f.f10 * f.f10) - 1.0);
    const double e1 = 0.5 * ((f.f01 * f.f01 + f.f11 * f.f11) - 1.0);
    const double e2 = f.f00 * f.f01 + f.f10 * f.f11;
    el.given[0][e] = -e0;
    el.given[1][e] = -e1;
    el.given[2][e] = -e2;
    const double trace = lame.lambda * (e0 + e1), area = -el.area[e];
    const double s0 = area * (trace + 2.0 * lame.mu * e0), s1 = area * (trace + 2.0 * lame.mu * e1);
    const double s2 = area * lame.mu * e2;
    const Gradient g{f.f00 * s0 + f.f01 * s2, f.f00 * s2 + f.f01 * s1, f.f10 * s0 + f.f11 * s2,
                     f.f10 * s2 + f.f11 * s1};
    spread(el, nullptr, g, e, n.fx, n.fy);
  }
}

// The block of three is solved by its Cholesky factors.
void projectStVenantKirchhoff(const Lame& lame, double dtSquared, StrainElements& el, const NodeColumns& n,
                              std::size_t begin, std::size_t end) {
  const double unit = 1.0 / (4.0 * lame.mu * (lame.lambda + lame.mu));
  const double softA = unit * (lame.lambda + 2.0 * lame.mu), softB = -unit * lame.lambda, softC = 1.0 / lame.mu;
  for (std::size_t e = begin; e < end; ++e) {
    const Gradient f = gradientAt(el, n, e);
    const double xx = el.inertia[0][e], xy = el.inertia[1][e], yy = el.inertia[2][e];
    const double c0 = f.f00 * f.f00 + f.f10 * f.f10, c1 = f.f01 * f.f01 + f.f11 * f.f11;
    const double c2 = f.f00 * f.f01 + f.f10 * f.f11;
    const double r0 = 0.5 * (1.0 - c0) - el.given[0][e];
    const double r1 = 0.5 * (1.0 - c1) - el.given[1][e];
    const double r2 = -c2 - el.given[2][e];
    const double scale = dtSquared * el.area[e];
    const double a00 = scale * (c0 * xx) + softA, a11 = scale * (c1 * yy) + softA, a01 = scale * (c2 * xy) + softB;
    const double a02 = scale * (c0 * xy + c2 * xx), a12 = scale * (c2 * yy + c1 * xy);
    const double a22 = scale * ((c0 * yy + c1 * xx) + 2.0 * (c2 * xy)) + softC;
    const double i0 = 1.0 / a00, l1 = a01 * i0, l2 = a02 * i0;
    const double d1 = a11 - l1 * a01, m = a12 - l1 * a02, i1 = 1.0 / d1, l3 = m * i1;
    const double d2 = (a22 - l2 * a02) - l3 * m;
    const double z1 = r1 - l1 * r0, z2 = (r2 - l2 * r0) - l3 * z1;
    const double q2 = z2 / d2, q1 = z1 * i1 - l3 * q2, q0 = (r0 * i0 - l1 * q1) - l2 * q2;
    el.given[0][e] += softA * q0 + softB * q1;
    el.given[1][e] += softB * q0 + softA * q1;
    el.given[2][e] += softC * q2;
    const double s0 = scale * q0, s1 = scale * q1, s2 = scale * q2;
    const Gradient g{f.f00 * s0 + f.f01 * s2, f.f00 * s2 + f.f01 * s1, f.f10 * s0 + f.f11 * s2,
                     f.f10 * s2 + f.f11 * s1};
    spread(el, n.inverseMass, g, e, n.x, n.y);
  }
}

}  // namespace

StrainLoops strainLoopsScalar(StrainModel model) {
  if (model == StrainModel::NeoHookean) return {forceNeoHookean, projectNeoHookean};
  return {forceStVenantKirchhoff, projectStVenantKirchhoff};
}

}  // namespace froude
