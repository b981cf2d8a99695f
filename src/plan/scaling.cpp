#include "plan/scaling.h"

#include <fmt/format.h>
#include <malloc.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include <froude/base/parallel.h>
#include "run/shipped.h"
#include "run/threads.h"

namespace froude::plan {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kWarmUp = 3;                 // sub-steps that are not counted: pools and grids grow in them
constexpr std::size_t kFewest = 3;         // that are
constexpr std::size_t kTriad = 8'000'000;  // elements of an array: far more than the caches hold
constexpr int kTriadRuns = 7;

double since(Clock::time_point begin) { return std::chrono::duration<double>(Clock::now() - begin).count(); }

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

/// Bytes that are allocated now, or 0.
double allocatedBytes() {
#if defined(__GLIBC__) && __GLIBC_PREREQ(2, 33)
  const auto info = mallinfo2();
  return static_cast<double>(info.uordblks + info.hblkhd);
#else
  return 0.0;
#endif
}

std::size_t particlesOf(const World& world) {
  std::size_t count = 0;
  for (const ParticlePool* pool : {world.fluid(), world.bullets(), world.soft()})
    if (pool != nullptr) count += pool->size();
  return count;
}

void step(World& world, const std::string& name) {
  const StepReport report = world.substep();
  if (!report.ok())
    throw Error(fmt::format("{} went unstable at t = {:.3g} s: {}", name, world.time(), froude::name(report.trouble)));
}

World warmedUp(const scene::Scene& scene) {
  World world = scene::makeWorld(scene);
  for (int i = 0; i < kWarmUp; ++i) step(world, scene.name);
  return world;
}

std::function<std::vector<scene::Override>(double)> fluid(const std::string& model) {
  return [model](double k) {
    std::vector<scene::Override> changes{{"model.fluid", model},
                                         {"model.spacing", fmt::format("{:.10g}", 0.01 / std::sqrt(k))}};
    if (model == "wcsph") changes.emplace_back("model.support", "2");
    return changes;
  };
}

}  // namespace

const std::vector<Subject>& scalingSubjects() {
  static const std::vector<Subject> kSubjects{
      {"apic", "dam_speed", fluid("apic"), 128.0},
      {"bullets", "bullets",
       [](double k) {
         return std::vector<scene::Override>{{"bullet.block.0.count", fmt::format("{:.0f}", 1e4 * k)}};
       },
       128.0},
      {"dfsph", "dam_speed", fluid("dfsph"), 128.0},
      {"pbf", "dam_speed", fluid("pbf"), 128.0},
      {"soft", "jelly_rain",
       [](double k) {
         // Of the shipped 0.0094 m come 40,000 particles.
         return std::vector<scene::Override>{{"soft.0.spacing", fmt::format("{:.10g}", 0.0188 / std::sqrt(k))}};
       },
       16.0},
      {"wcsph", "dam_speed", fluid("wcsph"), 128.0},
  };
  return kSubjects;
}

std::vector<Sample> measureScaling(const Subject& subject, double k, std::span<const int> threads, double seconds,
                                   int rounds) {
  const scene::Scene scene = scene::load(run::shippedFile("scenes/" + subject.scene + ".toml"), subject.changes(k));
  const bool acoustic = scene.world.fluid && scene.world.fluid->model == "wcsph";
  std::vector<Sample> samples(threads.size());
  std::vector<std::vector<double>> times(threads.size());
  std::size_t substeps = 0;  // known after the first
  for (int round = 0; round < rounds; ++round) {
    for (std::size_t t = 0; t < threads.size(); ++t) {
      run::inArena(threads[t], [&] {
        const double before = allocatedBytes();
        World world = warmedUp(scene);
        const Ledger first = world.ledger();
        const Clock::time_point begin = Clock::now();
        std::size_t done = 0;
        while (substeps > 0 ? done < substeps : done < kFewest || since(begin) < seconds) {
          step(world, scene.name);
          ++done;
        }
        const double wall = since(begin);
        substeps = done;
        const Ledger last = world.ledger();
        const double sweeps = static_cast<double>(last.sweeps - first.sweeps) / static_cast<double>(done);
        const double steps = static_cast<double>(last.particleSteps - first.particleSteps) * (acoustic ? sweeps : 1.0);
        times[t].push_back(1e9 * wall / steps);
        const double particles = static_cast<double>(particlesOf(world));
        samples[t] = {subject.name,
                      particlesOf(world),
                      threads[t],
                      done,
                      sweeps,
                      0.0,
                      0.0,
                      rounds,
                      before > 0.0 ? (allocatedBytes() - before) / particles : 0.0};
      });
    }
  }
  for (std::size_t t = 0; t < threads.size(); ++t) {
    samples[t].median = median(times[t]);
    samples[t].best = *std::min_element(times[t].begin(), times[t].end());
  }
  return samples;
}

double triadScaling(int threads) {
  std::vector<double> a(kTriad, 1.0), b(kTriad, 2.0), c(kTriad, 3.0);
  const auto seconds = [&](int n) {
    double wall = 0.0;
    run::inArena(n, [&] {
      const Clock::time_point begin = Clock::now();
      parallelFor(kTriad, 65536, [&](std::size_t from, std::size_t to) {
        for (std::size_t i = from; i < to; ++i) a[i] = b[i] + 0.5 * c[i];
      });
      wall = since(begin);
    });
    return wall;
  };
  seconds(threads);  // pages come in
  std::vector<double> ratios;
  for (int i = 0; i < kTriadRuns; ++i) ratios.push_back(seconds(1) / seconds(threads));
  return median(ratios);
}

}  // namespace froude::plan
