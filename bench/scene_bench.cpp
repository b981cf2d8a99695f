// What does a whole scene cost? Runs scenes from t = 0 in turn, without output, and compares them by ratio.
//
//   scene_bench [--threads N] [--until SECONDS] [--runs N] [--set PATH=VALUE]... [--rows FILE] SCENE.toml...
//
// Runs alternate (first scene, second, first, …), so that a machine that grows slower slows all of them. Building the
// world is not timed. A row's item is a particle in one sub-step, of wcsph in one acoustic step, whose dt it states.
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include <froude/base/assert.h>
#include <froude/particles/neighbour_list.h>
#include <froude/solver/fluid/kernel.h>
#include <froude/version.h>
#include "run/machine.h"
#include "scene/scene.h"

namespace {

using namespace froude;

struct Options {
  int threads = 1, runs = 3;
  double until = 0.0;  // 0: the scene's duration [s]
  std::string rows;
  std::vector<std::string> scenes;
  std::vector<scene::Override> overrides;  // of all scenes
};

struct Outcome {
  std::vector<double> wall;  // of each run [s]
  double simulated = 0.0;    // [s]
  Ledger ledger;
  std::size_t particles = 0;
  double neighbours = 0.0, support = 0.0;  // mean at the end; [m]
};

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

double meanNeighbours(const ParticlePool& pool, const Box& box, double support) {
  CellGrid grid;
  grid.build(pool.x(), pool.y(), GridFrame::cover(box, support));
  std::vector<double> x, y;
  for (const std::uint32_t i : grid.order()) {
    x.push_back(pool.x()[i]);
    y.push_back(pool.y()[i]);
  }
  NeighbourList list;
  list.build(grid, x, y, support);
  return pool.empty() ? 0.0 : static_cast<double>(list.entryCount()) / static_cast<double>(pool.size());
}

// One run; false if the scene went unstable.
bool runOnce(const scene::Scene& scene, const Options& options, Outcome& outcome) {
  World world = scene::makeWorld(scene);
  const double end = options.until > 0.0 ? options.until : scene.duration;
  bool sound = true;
  const auto start = std::chrono::steady_clock::now();
  while (sound && world.time() < end * (1.0 - 1e-12)) sound = world.substep(end - world.time()).ok();
  outcome.wall.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  outcome.simulated = world.time();
  outcome.ledger = world.ledger();
  outcome.particles = (world.fluid() ? world.fluid()->size() : 0) + (world.bullets() ? world.bullets()->size() : 0);
  if (world.fluid() != nullptr) {
    outcome.support = kernel::kSupport * scene.world.fluid->spacing;
    outcome.neighbours = meanNeighbours(*world.fluid(), scene.world.domain.box, outcome.support);
  }
  if (!sound) std::fprintf(stderr, "%s: unstable at t = %g s\n", scene.file.c_str(), world.time());
  return sound;
}

void print(const scene::Scene& scene, const Outcome& o) {
  const auto steps = static_cast<double>(o.ledger.particleSteps), substeps = static_cast<double>(o.ledger.substeps);
  const double wall = median(o.wall);
  std::printf("%s\n", scene.name.c_str());
  std::printf("  particles %zu, simulated %g s, sub-steps %.0f, mean step %.3g s\n", o.particles, o.simulated, substeps,
              o.simulated / substeps);
  if (o.support > 0.0) {
    std::printf("  sweeps a sub-step %.2f, support radius %g m, neighbours %.1f\n",
                static_cast<double>(o.ledger.sweeps) / substeps, o.support, o.neighbours);
    std::printf("  million particle-iterations/s %.2f\n",
                1e-6 * steps * static_cast<double>(o.ledger.sweeps) / substeps / wall);
  }
  std::printf("  million particle-steps/s %.2f, wall per simulated second %.3f s (median of %zu; least %.3f s)\n",
              1e-6 * steps / wall, wall / o.simulated, o.wall.size(),
              *std::min_element(o.wall.begin(), o.wall.end()) / o.simulated);
}

bool writeRow(const Options& options, const scene::Scene& scene, const Outcome& o) {
  const bool fresh = !std::ifstream(options.rows).good();
  std::ofstream out(options.rows, std::ios::app);
  if (fresh) out << "question,case,cpu,cores,commit,build,simd,threads,dt,ns_median,ns_best,error,runs\n";
  const bool acoustic = scene.world.fluid && scene.world.fluid->model == "wcsph";
  const double substeps = static_cast<double>(o.ledger.substeps);
  const double parts = acoustic ? static_cast<double>(o.ledger.sweeps) / substeps : 1.0;
  const double steps = static_cast<double>(o.ledger.particleSteps) * parts;
  char numbers[160];
  std::snprintf(numbers, sizeof numbers, "%d,%.4g,%.4g,%.4g,%.3g,%zu", options.threads,
                o.simulated / (substeps * parts), 1e9 * median(o.wall) / steps,
                1e9 * *std::min_element(o.wall.begin(), o.wall.end()) / steps, o.ledger.maxDensityError, o.wall.size());
  char length[64];
  std::snprintf(length, sizeof length, "%zu particles to %g s%s", o.particles, o.simulated,
                acoustic ? ", acoustic steps of wcsph" : "");
  out << "scene,\"" << scene.name << ", " << length << "\",\"" << run::cpuName() << "\","
      << std::thread::hardware_concurrency() << ',' << FROUDE_COMMIT << ",release," << name(scene.world.simd) << ','
      << numbers << '\n';
  return out.good();
}

int usage() {
  std::fprintf(stderr,
               "usage: scene_bench [--threads N] [--until SECONDS] [--runs N] [--set PATH=VALUE]... [--rows FILE] "
               "SCENE.toml...\n");
  return 2;
}

}  // namespace

int main(int argc, char** argv) {
  if (kAssertionsOn || !kOptimized) {
    std::fprintf(stderr,
                 "scene_bench: this build is not the one of the preset 'bench'; its rates would mean nothing\n");
    return 2;
  }
  Options options;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word.rfind("--benchmark_", 0) == 0) continue;  // `bootstrap bench` hands its words to all
    if (word.rfind("--", 0) != 0) {
      options.scenes.push_back(word);
    } else if (i + 1 == argc) {
      return usage();
    } else if (word == "--threads") {
      options.threads = std::max(1, std::atoi(argv[++i]));
    } else if (word == "--until") {
      options.until = std::atof(argv[++i]);
    } else if (word == "--runs") {
      options.runs = std::max(1, std::atoi(argv[++i]));
    } else if (word == "--set") {
      const std::string text = argv[++i];
      const std::size_t equals = text.find('=');
      if (equals == std::string::npos) return usage();
      options.overrides.push_back({text.substr(0, equals), text.substr(equals + 1)});
    } else if (word == "--rows") {
      options.rows = argv[++i];
    } else {
      return usage();
    }
  }
  if (options.scenes.empty()) {
    std::printf("scene_bench: no scene given, nothing to do\n");
    return 0;
  }
  try {
    std::vector<scene::Scene> scenes;
    for (const std::string& file : options.scenes) scenes.push_back(scene::load(file, options.overrides));
    std::vector<Outcome> outcomes(scenes.size());
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism,
                                      static_cast<std::size_t>(options.threads));
    tbb::task_arena arena(options.threads);
    for (int k = 0; k < options.runs; ++k) {
      for (std::size_t s = 0; s < scenes.size(); ++s) {
        if (!arena.execute([&] { return runOnce(scenes[s], options, outcomes[s]); })) return 3;
      }
    }
    for (std::size_t s = 0; s < scenes.size(); ++s) print(scenes[s], outcomes[s]);
    for (std::size_t s = 1; s < scenes.size(); ++s) {
      std::vector<double> ratios;
      for (std::size_t k = 0; k < outcomes[s].wall.size(); ++k) {
        ratios.push_back(outcomes[s].wall[k] * outcomes[0].simulated / outcomes[s].simulated / outcomes[0].wall[k]);
      }
      std::printf("%s takes %.3f of the wall time of %s a simulated second\n", scenes[s].name.c_str(), median(ratios),
                  scenes[0].name.c_str());
    }
    for (std::size_t s = 0; s < scenes.size() && !options.rows.empty(); ++s) {
      if (!writeRow(options, scenes[s], outcomes[s])) {
        std::fprintf(stderr, "scene_bench: cannot write %s\n", options.rows.c_str());
        return 4;
      }
    }
  } catch (const Error& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 2;
  }
  return 0;
}
