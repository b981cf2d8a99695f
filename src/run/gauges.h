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
///
/// A reading may be dear, so a gauge is read at a step end t only if one of its times lies in the step just taken, or
/// may lie in the next: t + 2 Δt ≥ time, where Δt is the step just taken (a step that was halved may double back). So
/// both step ends around a time are read; should a step grow by more than that, the last reading before it stands in,
/// which makes the interpolation longer. Which step ends are read depends on the steps and on the gauge alone. The mean
/// of a pressure is that of the piecewise linear course through all step ends in its window (cut at the start of the
/// run; stretches without a value do not count), so such a gauge is read at each of them.
class GaugeSet {
 public:
  /// Throws Error for a gauge that names an unknown type or body, or holds numbers that cannot be.
  GaugeSet(const std::vector<scene::GaugeDef>& gauges, const World& world);
  ~GaugeSet();
  GaugeSet(GaugeSet&&) noexcept;
  GaugeSet& operator=(GaugeSet&&) noexcept;

  const std::vector<GaugeColumn>& columns() const { return columns_; }

  /// Called once after construction of the world (t = 0) and at every step end. Appends to `rows` the lines of
  /// gauges.csv that have become due: a row at t = 0 and one at every multiple of `every`, values interpolated linearly
  /// between the two step ends around it; a gauge that is not due leaves its cell empty. Rows are in order of time. A
  /// time that a step end meets exactly is written with the next one, so that the run's last row can hold all gauges.
  void afterStep(const World& world, std::vector<std::string>& rows);
  /// What is still due, and the row at the end of the run (all gauges), unless the last row has that very time.
  void atEnd(const World& world, std::vector<std::string>& rows);

  /// First line of gauges.csv: "t" and the column names.
  std::string header() const;

  /// Readings that are still needed, and next times: saved with the checkpoint. A resumed run writes the same bytes.
  void archive(Archive& a);

  /// Area where φ ≥ ½ outside solids, on a grid of dx/2 [m²]: the "volume" gauge, also behind `volume_error`.
  static double fluidArea(const World& world);

 private:
  struct Gauge;
  void read(const World& world, bool all);
  void writeDue(double before, std::vector<std::string>& rows);
  void writeRow(double t, std::vector<std::string>& rows, bool all);

  std::vector<Gauge> gauges_;
  std::vector<GaugeColumn> columns_;
  bool started_ = false;
  double lastRow_ = -1.0;  // [s]
  double lastTime_ = 0.0;  // of the last step end [s]
  double lastStep_ = 0.0;  // [s]
};

}  // namespace froude::run
