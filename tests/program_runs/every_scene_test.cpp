// Every shipped scene, with every fluid model that takes it: stopped and resumed at random moments on other numbers of
// threads it ends with the bits of a run that never stopped on one.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include "program_runs/program.h"

namespace froude::testing {
namespace {

namespace fs = std::filesystem;

class LongEveryScene : public ProgramTest {
 protected:
  LongEveryScene() {
    fs::copy(std::string(FROUDE_SOURCE_DIR) + "/scenes", path("scenes"), fs::copy_options::recursive);
  }

  Words scenes() const {
    Words found;
    for (const auto& entry : fs::directory_iterator(path("scenes")))
      if (entry.path().extension() == ".toml") found.push_back("scenes/" + entry.path().filename().string());
    std::sort(found.begin(), found.end());
    return found;
  }

  // Stops the scene at so many moments before `until` and goes on from each; false where the model refuses the scene.
  // `model` is a word for --set, or "" for the scene's own.
  bool endsTheSame(const std::string& scene, const std::string& model, double until, int stops) {
    Words words{"--quiet", "--frames", "none"};
    if (!model.empty()) words.insert(words.end(), {"--set", model});
    const auto run = [&](Words head, double end, int threads) {
      head.insert(head.end(), {"--until", std::to_string(end), "--threads", std::to_string(threads)});
      return froude(head);
    };
    const auto begin = [&](const std::string& folder, double end, int threads) {
      Words head{"run", scene, "-o", folder, "--force"};
      head.insert(head.end(), words.begin(), words.end());
      return run(head, end, threads);
    };
    const Outcome straight = begin("straight", until, 1);
    if (straight.code == 2 && !model.empty()) return false;
    // A scene that cannot be stepped to its end says so with 3, and ends so however often it is stopped.
    EXPECT_TRUE(straight.code == 0 || straight.code == 3) << scene << model << straight.err;
    std::vector<double> moments(static_cast<std::size_t>(stops));
    for (double& moment : moments) moment = until * (0.05 + 0.9 * static_cast<double>(random_()) / 4294967296.0);
    std::sort(moments.begin(), moments.end());
    Outcome last = begin("stopped", moments.front(), 2);
    for (std::size_t i = 1; i <= moments.size() && last.code == 0; ++i) {
      const int threads[] = {3, 7, 1, 2};
      last = run({"resume", "stopped", "--quiet"}, i < moments.size() ? moments[i] : until, threads[i % 4]);
    }
    EXPECT_EQ(last.code, straight.code) << scene << model << last.err;
    EXPECT_EQ(stateHash("stopped"), stateHash("straight")) << scene << " " << model;
    EXPECT_EQ(read("stopped/gauges.csv"), read("straight/gauges.csv")) << scene << " " << model;
    return true;
  }

 private:
  std::mt19937 random_{2026};  // the same moments in every session
};

TEST_F(LongEveryScene, ends_with_the_same_bits_when_it_is_stopped_and_resumed) {
  const bool all = std::getenv("FROUDE_LONG") != nullptr;
  for (const std::string& scene : scenes()) EXPECT_TRUE(endsTheSame(scene, "", all ? 0.1 : 0.01, all ? 6 : 2)) << scene;
}

TEST_F(LongEveryScene, does_so_with_every_fluid_model_that_takes_it) {
  const bool all = std::getenv("FROUDE_LONG") != nullptr;
  const Words names = scenes();
  for (const std::string model : {"pbf", "dfsph", "wcsph", "apic"}) {
    std::size_t taken = 0;
    for (std::size_t i = all ? 0 : 2; i < names.size(); i += all ? 1 : 4) {
      if (read(names[i]).find("[[fluid") == std::string::npos) continue;
      taken += endsTheSame(names[i], "model.fluid=" + model, all ? 0.1 : 0.01, all ? 4 : 1) ? 1 : 0;
    }
    EXPECT_GE(taken, all ? 10u : 3u) << model;
  }
}

}  // namespace
}  // namespace froude::testing
