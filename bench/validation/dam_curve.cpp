#include "validation/dam_curve.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "run/gauge_surface.h"
#include "validation/read_off.h"

namespace froude::validation {

void DamCurve::read(const World& world, double t) {
  const Moments m = moments(*world.fluid());
  toe.add(t, run::FluidSurface(world).toe());
  centreX.add(t, m.centre.x());
  centreY.add(t, m.centre.y());
}

std::string damTruthFile() { return dataPath("dam_truth.csv"); }

DamCurve readDamCurve(const std::string& file) {
  return {readCurve(file, 0, 1), readCurve(file, 0, 2), readCurve(file, 0, 3)};
}

void writeDamCurve(const DamCurve& curve, const std::string& remark, const std::string& file) {
  std::ofstream out(file);
  out << "# " << remark << "\nt,toe,com_x,com_y\n";
  for (std::size_t i = 0; i < curve.toe.t.size(); ++i)
    out << fmt::format("{:.6f},{:.6f},{:.6f},{:.6f}\n", curve.toe.t[i], curve.toe.z[i], curve.centreX.z[i],
                       curve.centreY.z[i]);
  if (!out.flush()) throw Error("cannot write " + file);
}

DamDistance distance(const DamCurve& a, const DamCurve& b) {
  constexpr int kTimes = 1000;
  const double end = std::min(a.toe.t.back(), b.toe.t.back());
  DamDistance sum;
  for (int k = 0; k < kTimes; ++k) {
    const double t = end * (k + 0.5) / kTimes;
    sum.toe += std::abs(a.toe.at(t) - b.toe.at(t)) / kTimes;
    sum.centre += std::hypot(a.centreX.at(t) - b.centreX.at(t), a.centreY.at(t) - b.centreY.at(t)) / kTimes;
  }
  return sum;
}

}  // namespace froude::validation
