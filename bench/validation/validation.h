// Validation cases: what one is, and where all of them are found.
//
// A case is one file in bench/validation/cases: it names a shipped scene, the spacings to run it at, and what is
// measured. It knows no fluid method, so a new method runs through all of them without a change. A case of soft bodies
// names the models that it is about.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <froude/solver/world.h>
#include "scene/scene.h"

namespace froude::validation {

/// A number that says how far a run is from its reference.
struct Metric {
  std::string name;
  std::string unit;              // "1" for a ratio
  double error = 0.0;            // 0 is right; its size is judged, its sign is kept
  std::optional<double> target;  // |error| should stay below
  bool converges = true;         // false for counts and free parameters: no order is fitted
};

/// Reads one run. Looks at the world only.
class Measure {
 public:
  virtual ~Measure() = default;
  /// At t = 0, at the first step end at or after each multiple of `Case::every`, and at the last step end. t is the
  /// world's time [s], at which the reference is to be taken: steps are never cut to meet one.
  virtual void read(const World& world, double t) = 0;
  /// After the last reading, in an order that does not depend on the run.
  virtual std::vector<Metric> results() const = 0;
};

/// At which spacings, and with what changed in the scene.
struct Form {
  std::vector<double> spacings;            // coarse to fine [m]
  std::vector<scene::Override> overrides;  // besides the method and the spacing
};

/// Kinds of flow, each with a norm of its own: what "within 5 %" means of a splash, of a confined flow, …
enum class FlowKind { None, Splash, Surface, Confined, AtRest, Soft, Bullets };
const char* flowName(FlowKind flow);

struct Case {
  std::string name;
  std::string measures;  // one sentence: what is measured, against what
  std::string scene;     // scenes/SCENE.toml
  double every = 0.0;    // between readings [s]; 0: every step end
  Form full, quick;
  std::function<std::unique_ptr<Measure>(const scene::Scene&)> measure;
  std::function<void(World&)> prepare{};  // before t = 0: what a scene cannot say; empty: nothing
  /// Of a case of soft bodies: models of the first one, whose spacing is the case's. Empty: a case of fluids.
  std::vector<std::string> softModels{};
  /// Of a case that stands on the chart: its kind, and the metrics whose root mean square is its error there.
  FlowKind flow = FlowKind::None;
  std::vector<std::string> norm{};
};

/// Of all files in cases/, by name.
std::span<const Case> allCases();

/// A case's file holds one of these for each of its cases: `const Registered kCase{{...}};`.
struct Registered {
  explicit Registered(Case entry);
};

/// Where the shipped scenes and the published curves are: beside an installed program, else in the source tree that
/// this was built from.
std::string scenePath(const std::string& name);
std::string dataPath(const std::string& file);

}  // namespace froude::validation
