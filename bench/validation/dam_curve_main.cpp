// The course of the dam as one method sees it, for tests/data/dam_truth.csv.
//
//   dam_curve METHOD SPACING FILE     runs scenes/dam_speed.toml to 2 s; writes t, toe and centre of mass
//   dam_curve --compare A.csv B.csv   how far two such curves are apart
//
// A truth is what two methods agree on at their finest spacings, to within what `--compare` says of them.
#include <fmt/format.h>

#include <cstdlib>

#include <froude/version.h>
#include "validation/dam_curve.h"

namespace {

using namespace froude;
using namespace froude::validation;

constexpr double kEvery = 0.01;  // s

int simulate(const std::string& method, const std::string& spacing, const std::string& file) {
  const scene::Scene scene = scene::load(scenePath("dam_speed"), {{"model.fluid", method}, {"model.spacing", spacing}});
  World world = scene::makeWorld(scene);
  DamCurve curve;
  double due = 0.0;
  for (;;) {
    if (world.time() >= due || world.time() >= kDamCurveEnd) {
      curve.read(world, world.time());
      due = world.time() + kEvery;
    }
    if (world.time() >= kDamCurveEnd) break;
    const StepReport report = world.substep();
    if (!report.ok()) {
      fmt::print(stderr, "dam_curve: {} went unstable ({}) at t = {:.4g} s; nothing was written\n", method,
                 name(report.trouble), world.time());
      return 3;
    }
  }
  writeDamCurve(curve,
                fmt::format("scenes/dam_speed.toml by {}, spacing {} m, {} particles, commit {}; t [s], the rest [m]",
                            method, spacing, world.fluid()->size(), FROUDE_COMMIT),
                file);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    if (argc == 4 && std::string(argv[1]) == "--compare") {
      const DamDistance off = distance(readDamCurve(argv[2]), readDamCurve(argv[3]));
      fmt::print("mean distance of the toes {:.4g} m, of the centres of mass {:.4g} m\n", off.toe, off.centre);
      return 0;
    }
    if (argc == 4) return simulate(argv[1], argv[2], argv[3]);
  } catch (const Error& e) {
    fmt::print(stderr, "dam_curve: {}\n", e.what());
    return 2;
  }
  fmt::print(stderr, "usage: dam_curve METHOD SPACING FILE\n       dam_curve --compare A.csv B.csv\n");
  return 2;
}
