// The strain loops over SIMD lanes, compiled once for each target. The formulas are those of strain_scalar.cpp, without
// fused multiply-adds, so that all targets agree to the bit.
#include <froude/solver/soft/strain_elements.h>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "froude/solver/soft/strain_wide.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace froude {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using D = hn::CappedTag<double, kElementLanes>;
using I = hn::Rebind<std::int64_t, D>;
using I32 = hn::Rebind<std::int32_t, D>;
using V = hn::Vec<D>;

HWY_INLINE V mul(V a, V b) { return hn::Mul(a, b); }
HWY_INLINE V add(V a, V b) { return hn::Add(a, b); }
HWY_INLINE V sub(V a, V b) { return hn::Sub(a, b); }
HWY_INLINE V set(double a) { return hn::Set(D(), a); }

// Elements e … e + lanes − 1: where their nodes stand, and F.
struct Lanes {
  hn::Vec<I> node[4];
  V b[6];
  V f00, f01, f10, f11;

  HWY_INLINE Lanes(const StrainElements& el, const NodeColumns& n, std::size_t e) {
    const D d;
    const I i;
    V x[4], y[4];
    for (std::size_t k = 0; k < 4; ++k) {
      const auto narrow = hn::LoadU(I32(), reinterpret_cast<const std::int32_t*>(el.node[k].data() + e));
      node[k] = hn::PromoteTo(i, narrow);
      x[k] = hn::GatherIndex(d, n.x, node[k]);
      y[k] = hn::GatherIndex(d, n.y, node[k]);
    }
    for (std::size_t k = 0; k < 6; ++k) b[k] = hn::LoadU(d, el.b[k].data() + e);
    const V x1 = sub(x[1], x[0]), x2 = sub(x[2], x[0]), x3 = sub(x[3], x[0]);
    const V y1 = sub(y[1], y[0]), y2 = sub(y[2], y[0]), y3 = sub(y[3], y[0]);
    f00 = add(add(mul(x1, b[0]), mul(x2, b[2])), mul(x3, b[4]));
    f01 = add(add(mul(x1, b[1]), mul(x2, b[3])), mul(x3, b[5]));
    f10 = add(add(mul(y1, b[0]), mul(y2, b[2])), mul(y3, b[4]));
    f11 = add(add(mul(y1, b[1]), mul(y2, b[3])), mul(y3, b[5]));
  }

  // As `spread` of the scalar loops.
  template <bool kWeighted>
  HWY_INLINE void spread(const double* weight, V g00, V g01, V g10, V g11, double* x, double* y) const {
    const D d;
    V sumX = hn::Zero(d), sumY = hn::Zero(d);
    for (std::size_t k = 3; k >= 1; --k) {
      V dx = add(mul(g00, b[2 * k - 2]), mul(g01, b[2 * k - 1]));
      V dy = add(mul(g10, b[2 * k - 2]), mul(g11, b[2 * k - 1]));
      sumX = add(sumX, dx);
      sumY = add(sumY, dy);
      if constexpr (kWeighted) {
        const V w = hn::GatherIndex(d, weight, node[k]);
        dx = mul(w, dx);
        dy = mul(w, dy);
      }
      hn::ScatterIndex(add(hn::GatherIndex(d, x, node[k]), dx), d, x, node[k]);
      hn::ScatterIndex(add(hn::GatherIndex(d, y, node[k]), dy), d, y, node[k]);
    }
    if constexpr (kWeighted) {
      const V w = hn::GatherIndex(d, weight, node[0]);
      sumX = mul(w, sumX);
      sumY = mul(w, sumY);
    }
    hn::ScatterIndex(sub(hn::GatherIndex(d, x, node[0]), sumX), d, x, node[0]);
    hn::ScatterIndex(sub(hn::GatherIndex(d, y, node[0]), sumY), d, y, node[0]);
  }
};

void forceNeoHookean(const Lame& lame, StrainElements& el, const NodeColumns& n, std::size_t begin, std::size_t end) {
  const D d;
  const double bulk = lame.lambda + lame.mu;
  const V gamma = set(1.0 + lame.mu / bulk), mu = set(lame.mu), k = set(bulk);
  for (std::size_t e = begin; e < end; e += hn::Lanes(d)) {
    const Lanes l(el, n, e);
    const V volume = sub(sub(mul(l.f00, l.f11), mul(l.f01, l.f10)), gamma);
    const V square = add(add(mul(l.f00, l.f00), mul(l.f01, l.f01)), add(mul(l.f10, l.f10), mul(l.f11, l.f11)));
    hn::StoreU(hn::Neg(hn::Sqrt(square)), d, el.given[0].data() + e);
    hn::StoreU(hn::Neg(volume), d, el.given[1].data() + e);
    const V area = hn::Neg(hn::LoadU(d, el.area.data() + e));
    const V p = mul(area, mu), q = mul(mul(area, k), volume);
    l.spread<false>(nullptr, add(mul(p, l.f00), mul(q, l.f11)), sub(mul(p, l.f01), mul(q, l.f10)),
                    sub(mul(p, l.f10), mul(q, l.f01)), add(mul(p, l.f11), mul(q, l.f00)), n.fx, n.fy);
  }
}

void projectNeoHookean(const Lame& lame, double dtSquared, StrainElements& el, const NodeColumns& n, std::size_t begin,
                       std::size_t end) {
  const D d;
  const double bulk = lame.lambda + lame.mu;
  const V gamma = set(1.0 + lame.mu / bulk), softD = set(1.0 / lame.mu), softH = set(1.0 / bulk);
  const V one = set(1.0), dt2 = set(dtSquared);
  for (std::size_t e = begin; e < end; e += hn::Lanes(d)) {
    const Lanes l(el, n, e);
    const V xx = hn::LoadU(d, el.inertia[0].data() + e), xy = hn::LoadU(d, el.inertia[1].data() + e);
    const V yy = hn::LoadU(d, el.inertia[2].data() + e);
    const V square = add(add(mul(l.f00, l.f00), mul(l.f01, l.f01)), add(mul(l.f10, l.f10), mul(l.f11, l.f11)));
    const V length = hn::Max(hn::Sqrt(square), set(1e-12)), inverse = hn::Div(one, length);
    const V givenD = hn::LoadU(d, el.given[0].data() + e), givenH = hn::LoadU(d, el.given[1].data() + e);
    const V rD = sub(hn::Neg(length), givenD);
    const V rH = sub(sub(gamma, sub(mul(l.f00, l.f11), mul(l.f01, l.f10))), givenH);
    const V u00 = add(mul(l.f00, xx), mul(l.f01, xy)), u01 = add(mul(l.f00, xy), mul(l.f01, yy));
    const V u10 = add(mul(l.f10, xx), mul(l.f11, xy)), u11 = add(mul(l.f10, xy), mul(l.f11, yy));
    const V c00 = l.f11, c01 = hn::Neg(l.f10), c10 = hn::Neg(l.f01), c11 = l.f00;
    const V t00 = add(mul(c00, xx), mul(c01, xy)), t01 = add(mul(c00, xy), mul(c01, yy));
    const V t10 = add(mul(c10, xx), mul(c11, xy)), t11 = add(mul(c10, xy), mul(c11, yy));
    const V scale = mul(dt2, hn::LoadU(d, el.area.data() + e));
    const V dd = add(mul(mul(mul(scale, inverse), inverse),
                         add(add(mul(u00, l.f00), mul(u01, l.f01)), add(mul(u10, l.f10), mul(u11, l.f11)))),
                     softD);
    const V dh = mul(mul(scale, inverse), add(add(mul(u00, c00), mul(u01, c01)), add(mul(u10, c10), mul(u11, c11))));
    const V hh = add(mul(scale, add(add(mul(t00, c00), mul(t01, c01)), add(mul(t10, c10), mul(t11, c11)))), softH);
    const V divisor = hn::Div(one, sub(mul(dd, hh), mul(dh, dh)));
    const V qD = mul(sub(mul(hh, rD), mul(dh, rH)), divisor), qH = mul(sub(mul(dd, rH), mul(dh, rD)), divisor);
    hn::StoreU(add(givenD, mul(softD, qD)), d, el.given[0].data() + e);
    hn::StoreU(add(givenH, mul(softH, qH)), d, el.given[1].data() + e);
    const V p = mul(mul(scale, qD), inverse), q = mul(scale, qH);
    l.spread<true>(n.inverseMass, add(mul(p, l.f00), mul(q, c00)), add(mul(p, l.f01), mul(q, c01)),
                   add(mul(p, l.f10), mul(q, c10)), add(mul(p, l.f11), mul(q, c11)), n.x, n.y);
  }
}

void forceStVenantKirchhoff(const Lame& lame, StrainElements& el, const NodeColumns& n, std::size_t begin,
                            std::size_t end) {
  const D d;
  const V half = set(0.5), one = set(1.0), lambda = set(lame.lambda), mu = set(lame.mu), twoMu = set(2.0 * lame.mu);
  for (std::size_t e = begin; e < end; e += hn::Lanes(d)) {
    const Lanes l(el, n, e);
    const V e0 = mul(half, sub(add(mul(l.f00, l.f00), mul(l.f10, l.f10)), one));
    const V e1 = mul(half, sub(add(mul(l.f01, l.f01), mul(l.f11, l.f11)), one));
    const V e2 = add(mul(l.f00, l.f01), mul(l.f10, l.f11));
    hn::StoreU(hn::Neg(e0), d, el.given[0].data() + e);
    hn::StoreU(hn::Neg(e1), d, el.given[1].data() + e);
    hn::StoreU(hn::Neg(e2), d, el.given[2].data() + e);
    const V trace = mul(lambda, add(e0, e1)), area = hn::Neg(hn::LoadU(d, el.area.data() + e));
    const V s0 = mul(area, add(trace, mul(twoMu, e0))), s1 = mul(area, add(trace, mul(twoMu, e1)));
    const V s2 = mul(mul(area, mu), e2);
    l.spread<false>(nullptr, add(mul(l.f00, s0), mul(l.f01, s2)), add(mul(l.f00, s2), mul(l.f01, s1)),
                    add(mul(l.f10, s0), mul(l.f11, s2)), add(mul(l.f10, s2), mul(l.f11, s1)), n.fx, n.fy);
  }
}

void projectStVenantKirchhoff(const Lame& lame, double dtSquared, StrainElements& el, const NodeColumns& n,
                              std::size_t begin, std::size_t end) {
  const D d;
  const double unit = 1.0 / (4.0 * lame.mu * (lame.lambda + lame.mu));
  const V softA = set(unit * (lame.lambda + 2.0 * lame.mu)), softB = set(-unit * lame.lambda);
  const V softC = set(1.0 / lame.mu), half = set(0.5), one = set(1.0), two = set(2.0), dt2 = set(dtSquared);
  for (std::size_t e = begin; e < end; e += hn::Lanes(d)) {
    const Lanes l(el, n, e);
    const V xx = hn::LoadU(d, el.inertia[0].data() + e), xy = hn::LoadU(d, el.inertia[1].data() + e);
    const V yy = hn::LoadU(d, el.inertia[2].data() + e);
    const V c0 = add(mul(l.f00, l.f00), mul(l.f10, l.f10)), c1 = add(mul(l.f01, l.f01), mul(l.f11, l.f11));
    const V c2 = add(mul(l.f00, l.f01), mul(l.f10, l.f11));
    const V given0 = hn::LoadU(d, el.given[0].data() + e), given1 = hn::LoadU(d, el.given[1].data() + e);
    const V given2 = hn::LoadU(d, el.given[2].data() + e);
    const V r0 = sub(mul(half, sub(one, c0)), given0), r1 = sub(mul(half, sub(one, c1)), given1);
    const V r2 = sub(hn::Neg(c2), given2);
    const V scale = mul(dt2, hn::LoadU(d, el.area.data() + e));
    const V a00 = add(mul(scale, mul(c0, xx)), softA), a11 = add(mul(scale, mul(c1, yy)), softA);
    const V a01 = add(mul(scale, mul(c2, xy)), softB);
    const V a02 = mul(scale, add(mul(c0, xy), mul(c2, xx))), a12 = mul(scale, add(mul(c2, yy), mul(c1, xy)));
    const V a22 = add(mul(scale, add(add(mul(c0, yy), mul(c1, xx)), mul(two, mul(c2, xy)))), softC);
    const V i0 = hn::Div(one, a00), l1 = mul(a01, i0), l2 = mul(a02, i0);
    const V d1 = sub(a11, mul(l1, a01)), m = sub(a12, mul(l1, a02)), i1 = hn::Div(one, d1), l3 = mul(m, i1);
    const V d2 = sub(sub(a22, mul(l2, a02)), mul(l3, m));
    const V z1 = sub(r1, mul(l1, r0)), z2 = sub(sub(r2, mul(l2, r0)), mul(l3, z1));
    const V q2 = hn::Div(z2, d2), q1 = sub(mul(z1, i1), mul(l3, q2));
    const V q0 = sub(sub(mul(r0, i0), mul(l1, q1)), mul(l2, q2));
    hn::StoreU(add(given0, add(mul(softA, q0), mul(softB, q1))), d, el.given[0].data() + e);
    hn::StoreU(add(given1, add(mul(softB, q0), mul(softA, q1))), d, el.given[1].data() + e);
    hn::StoreU(add(given2, mul(softC, q2)), d, el.given[2].data() + e);
    const V s0 = mul(scale, q0), s1 = mul(scale, q1), s2 = mul(scale, q2);
    l.spread<true>(n.inverseMass, add(mul(l.f00, s0), mul(l.f01, s2)), add(mul(l.f00, s2), mul(l.f01, s1)),
                   add(mul(l.f10, s0), mul(l.f11, s2)), add(mul(l.f10, s2), mul(l.f11, s1)), n.x, n.y);
  }
}

}  // namespace

StrainLoops wideStrainLoops(StrainModel model) {
  if (model == StrainModel::NeoHookean) return {forceNeoHookean, projectNeoHookean};
  return {forceStVenantKirchhoff, projectStVenantKirchhoff};
}

}  // namespace HWY_NAMESPACE
}  // namespace froude
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace froude {

StrainLoops strainLoops(StrainModel model, SimdTarget target) {
  switch (target) {
#if (HWY_TARGETS & HWY_AVX3)
    case SimdTarget::Avx3:
      return N_AVX3::wideStrainLoops(model);
#endif
#if (HWY_TARGETS & HWY_AVX2)
    case SimdTarget::Avx2:
      return N_AVX2::wideStrainLoops(model);
#endif
#if (HWY_TARGETS & HWY_SSE4)
    case SimdTarget::Sse4:
      return N_SSE4::wideStrainLoops(model);
#endif
    default:
      return strainLoopsScalar(model);
  }
}

}  // namespace froude
#endif
