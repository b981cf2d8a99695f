// Gauges: numbers read off a world at step ends, interpolated to their own times.
#pragma once

#include <string>
#include <vector>

#include <froude/solver/world.h>
#include "scene/scene.h"

namespace froude::run {

/// One column of gauges.csv.
struct GaugeColumn {
  std::string name;  // NAME or NAME.PART
  std::string unit;
};

/// Evaluates all gauges of a scene. Reads the world only; evaluating never alters a step.
class GaugeSet {
 public:
  GaugeSet(const std::vector<scene::GaugeDef>& gauges, const World& world);

  const std::vector<GaugeColumn>& columns() const { return columns_; }

  /// Called once after construction of the world (t = 0) and at every step end. Appends to `rows` the lines of gauges.csv
  /// that have become due: a row at t = 0 and one at every multiple of `every`, values interpolated linearly between the
  /// two step ends around it; a gauge that is not due leaves its cell empty. Rows are in order of time.
  void afterStep(const World& world, std::vector<std::string>& rows);
  /// The row at the end of the run (all gauges), unless the last row has that very time.
  void atEnd(const World& world, std::vector<std::string>& rows);

  /// First line of gauges.csv: "t" and the column names.
  std::string header() const;

  /// Values of the previous step end, running means and next times: saved with the checkpoint.
  void archive(Archive& a);

  /// Area where φ ≥ ½ outside solids, on a grid of dx/2 [m²]: the "volume" gauge, also behind `volume_error`.
  static double fluidArea(const World& world);

 private:
  struct Gauge;
  std::vector<Gauge> gauges_;
  std::vector<GaugeColumn> columns_;
  double lastRow_ = -1.0;  // [s]
};

}  // namespace froude::run
