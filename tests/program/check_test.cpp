// froude check: verdicts on stdout, problems on stderr, an exit code for scripts.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "program/scene_support.h"
#include "scene/estimate.h"

namespace froude {
namespace {

using froude::testing::kFluid;
using froude::testing::kHead;
using froude::testing::loadText;
using froude::testing::SceneFile;

struct Output {
  int code = -1;
  std::string out, err;
};

Output check(const std::vector<std::string>& files, bool strict = false, bool json = false) {
  ::testing::internal::CaptureStdout();
  ::testing::internal::CaptureStderr();
  Output o;
  std::vector<scene::CheckItem> items;
  for (const std::string& file : files) items.push_back({file, file, {}});
  o.code = scene::checkCommand(items, strict, json);
  o.out = ::testing::internal::GetCapturedStdout();
  o.err = ::testing::internal::GetCapturedStderr();
  return o;
}

const std::string kWarned = kHead + kFluid + "[[body]]\nname = \"thin\"\nshape = { box = [1.5, 0.0, 1.51, 0.5] }\n";

TEST(Check, a_sound_scene_is_0_and_says_what_it_holds) {
  const SceneFile file(kHead + kFluid);
  const Output o = check({file.path()});
  EXPECT_EQ(o.code, 0);
  EXPECT_EQ(o.out.rfind(file.path() + ": sound: 50 fluid particles, 0 bullets, 0 bodies, ", 0), 0u) << o.out;
  EXPECT_EQ(o.err, "");
}

TEST(Check, a_wrong_scene_is_2_and_the_others_are_judged_all_the_same) {
  const SceneFile good(kHead + kFluid), bad(kHead + "[model]\nspacin = 1\n");
  const Output o = check({bad.path(), "/no/such.toml", good.path()});
  EXPECT_EQ(o.code, 2);
  EXPECT_NE(o.err.find(bad.path() + ":6:1: model.spacin: unknown key"), std::string::npos) << o.err;
  EXPECT_NE(o.err.find("/no/such.toml:0:0: file: "), std::string::npos) << o.err;
  EXPECT_NE(o.out.find(good.path() + ": sound"), std::string::npos) << o.out;
  EXPECT_NE(o.out.find(bad.path() + ": wrong"), std::string::npos) << o.out;
}

TEST(Check, warnings_are_0_and_strictly_2) {
  const SceneFile file(kWarned);
  const Output o = check({file.path()});
  EXPECT_EQ(o.code, 0);
  EXPECT_NE(o.out.find("runs, with 1 warning"), std::string::npos) << o.out;
  EXPECT_NE(o.err.find(":15:9: body.thin.shape: warning: is 0.01 m thin"), std::string::npos) << o.err;
  EXPECT_EQ(check({file.path()}, true).code, 2);
}

TEST(Check, the_same_as_JSON) {
  const SceneFile warned(kWarned), bad(kHead + "[model]\nspacin = 1\n", "\xFF.toml");
  const Output o = check({warned.path(), bad.path()}, false, true);
  EXPECT_EQ(o.code, 2);
  const nlohmann::json all = nlohmann::json::parse(o.out);
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0]["ok"], true);
  EXPECT_EQ(all[0]["fluid_particles"], 50);
  EXPECT_EQ(all[0]["bodies"], 1);
  EXPECT_EQ(all[0]["warnings"][0]["key"], "body.thin.shape");
  EXPECT_EQ(all[0]["scene_sha256"].get<std::string>().size(), 64u);
  EXPECT_GT(all[0]["memory_bytes"].get<double>(), 0.0);
  EXPECT_GT(all[0]["estimated_substeps"].get<double>(), 1.0);
  EXPECT_EQ(all[1]["ok"], false);
  EXPECT_EQ(all[1]["errors"][0]["line"], 6);
  EXPECT_EQ(all[1]["errors"][0]["column"], 1);
  EXPECT_EQ(all[1]["errors"][0]["key"], "model.spacin");
}

TEST(Check, the_expected_speed_is_that_of_free_fall_and_of_the_fastest_start) {
  const scene::Scene s = loadText(kHead +
                                  "[model]\nspacing = 0.1\n[[fluid.block]]\nshape = { box = [0, 0.5, 1, 1] }\n"
                                  "velocity = [3, 0]\n[[bullet.block]]\ncount = 1\nshape = { box = [0, 0, 1, 1] }\n"
                                  "velocity = [0, 50]\n");
  EXPECT_NEAR(scene::expectedSpeed(s, false), std::sqrt(9.0 + 2 * 9.81 * 0.95), 1e-12);
  EXPECT_GT(scene::expectedSpeed(s, true), 50.0);
}

TEST(Check, a_literal_sub_step_is_counted_exactly) {
  const scene::Estimate e =
      scene::estimate(loadText(kHead + "[model]\nspacing = 0.1\ntime_step = 0.01\n[[fluid.block]]\n"
                                       "shape = { box = [0, 0, 1, 0.5] }\n"));
  EXPECT_EQ(e.substeps, 100.0);
  ASSERT_EQ(e.bounds.size(), 1u);
  EXPECT_EQ(e.bounds[0].limit, StepLimit::Literal);
}

// Sound at ten times the speed of free fall, over half the kernel's support a step.
TEST(Check, acoustic_steps_of_wcsph_are_counted) {
  const auto steps = [](const std::string& keys) {
    return scene::estimate(loadText(kHead + "[model]\nfluid = \"wcsph\"\nspacing = 0.1\n" + keys +
                                    "[[fluid.block]]\nshape = { box = [0, 0, 1, 0.5] }\n"));
  };
  const scene::Estimate e = steps("support = 2.0\n");
  EXPECT_NEAR(e.acousticSteps, 1.0 * 11.0 * e.speed / 0.1, 1.0);
  EXPECT_GT(e.acousticSteps, 2.0 * e.substeps);
  EXPECT_NEAR(steps("support = 4.0\n").acousticSteps, 0.5 * e.acousticSteps, 1.0);
  EXPECT_EQ(scene::estimate(loadText(kHead + kFluid)).acousticSteps, 0.0);
}

TEST(Check, every_bound_of_the_sub_step_has_its_value) {
  const scene::Estimate e = scene::estimate(loadText(
      kHead + kFluid +
      "[[body]]\nname = \"mill\"\nmotion = \"scripted\"\nspin = 50.0\nshape = { box = [-0.1, -0.1, 0.1, 0.1] }\n"
      "position = [1.6, 0.5]\n"));
  const auto value = [&](StepLimit limit) {
    for (const scene::NamedBound& b : e.bounds)
      if (b.limit == limit) return b.dt;
    return -1.0;
  };
  EXPECT_EQ(value(StepLimit::Spin), 0.01);
  EXPECT_GT(value(StepLimit::Courant), 0.0);
  EXPECT_GT(value(StepLimit::Acceleration), 0.0);
  EXPECT_GT(value(StepLimit::Viscosity), 0.0);
  EXPECT_EQ(e.substep, e.bounds.front().dt);
}

}  // namespace
}  // namespace froude
