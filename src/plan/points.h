// Measured points: what a model at a spacing with a step reached in a case, and what it took. The chart draws them.
#pragma once

#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

namespace froude::plan {

/// One run of one case.
struct Point {
  std::string flow;      // the kind of flow, "splash", "confined", …
  std::string subject;   // the case
  std::string model;     // fluid method or model of soft bodies
  double spacing = 0.0;  // [m]
  double courant = 0.0;  // as in a scene; 0: the model's or the scene's own
  std::size_t particles = 0;
  double error = std::numeric_limits<double>::quiet_NaN();  // the norm of the flow, 0 is right; NaN unless it ended
  double target = 0.0;                                      // that the case asks for; 0: none
  double wallSeconds = 0.0, simulatedSeconds = 0.0;
  double particleSteps = 0.0;  // particles times sub-steps
  std::string state = "done";  // or why it did not end, in words

  bool ended() const { return std::isfinite(error); }
  /// Wall time of a simulated second: the horizontal axis.
  double cost() const { return wallSeconds / simulatedSeconds; }
  double stepsPerSecond() const { return particleSteps / wallSeconds; }
};

/// Under which circumstances points were measured; points of other circumstances are never drawn together.
struct Circumstances {
  std::string cpu, commit, build, simd;
  int cores = 1, threads = 1;
  bool operator==(const Circumstances&) const = default;
};

/// Of this build on this machine.
Circumstances circumstances(int threads);

/// Points measured by one program on one machine, and where and when.
struct PointTable {
  Circumstances where;
  std::string date;  // of the newest, "2026-01-31"
  std::vector<Point> points;
};

/// Header and lines of the file of points, each with its end.
std::string pointsHead();
std::string pointLine(const Point& point, const Circumstances& where, const std::string& date);

/// Reads a file of points. Those of other circumstances than the last line's are left out. Throws run::InputError for a
/// file that cannot be read or holds something else.
PointTable readPoints(const std::string& file);

}  // namespace froude::plan
