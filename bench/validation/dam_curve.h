// The falling column of scenes/dam_speed.toml as three curves over time. No experiment and no formula gives them; two
// methods that agree at their finest spacings do.
#pragma once

#include <string>

#include "validation/curve.h"
#include "validation/validation.h"

namespace froude::validation {

struct DamCurve {
  Curve toe, centreX, centreY;  // [m] over [s]
  void read(const World& world, double t);
};

constexpr double kDamCurveEnd = 2.0;  // [s]

/// tests/data/dam_truth.csv, which the case `dam` compares with once it is there.
std::string damTruthFile();

/// CSV: t,toe,com_x,com_y, behind lines of remarks that begin with '#'. Throws Error for a file that cannot be read.
DamCurve readDamCurve(const std::string& file);
void writeDamCurve(const DamCurve& curve, const std::string& remark, const std::string& file);

/// Means over time, up to the end of the shorter curve, of |difference| in m: the column is 1 m wide and tall.
struct DamDistance {
  double toe = 0.0, centre = 0.0;
};
DamDistance distance(const DamCurve& a, const DamCurve& b);

}  // namespace froude::validation
