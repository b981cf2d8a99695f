// What one gauge reads off one state of a world.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "run/gauge_surface.h"
#include "run/gauges.h"

namespace froude::run {

/// Columns of a gauge; a pressure with a window has its mean as last column, which `readGauge` does not fill. Throws
/// Error for a type that is not known, a quantile outside [0, 1] or a profile without points.
std::vector<GaugeColumn> gaugeColumns(const scene::GaugeDef& def);

/// The state of a world and what several gauges need of it, computed when first asked for.
class GaugeInput {
 public:
  explicit GaugeInput(const World& world) : world_(world) {}
  const World& world() const { return world_; }
  FluidSurface& surface() {
    if (!surface_) surface_.emplace(world_);
    return *surface_;
  }

 private:
  const World& world_;
  std::optional<FluidSurface> surface_;
};

/// Writes the gauge's values at this state. `body`: index of the body or soft body it names, where it names one.
void readGauge(const scene::GaugeDef& def, std::size_t body, GaugeInput& input, std::span<double> values);

/// The q-quantile of the values [0 ≤ q ≤ 1], linear between the order statistics ⌊(n−1)q⌋ and the next one (Hyndman and
/// Fan's type 7, the default of NumPy and R). NaN where there are none. Cost: O(n).
double quantile(std::vector<double> values, double q);

}  // namespace froude::run
