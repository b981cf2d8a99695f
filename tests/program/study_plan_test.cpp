// Sweeps, batch files and the plan that they make.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <set>
#include <string>
#include <vector>

#include "run/exit_codes.h"
#include "scene/document.h"
#include "study/batch_file.h"
#include "study/plan.h"

namespace froude::study {
namespace {

namespace fs = std::filesystem;
using Texts = std::vector<std::string>;

Texts listed(const std::string& toml) {
  const scene::Node document = scene::parseDocument("b.toml", "v = " + toml + "\n");
  return sweepValues("b.toml", "v", *document.find("v"));
}

template <typename Refusal, typename Call>
std::string refusal(Call call) {
  try {
    call();
  } catch (const Refusal& e) {
    return e.what();
  }
  return {};
}

TEST(Sweep, values_are_split_at_commas_outside_brackets_and_quotes) {
  const Sweep sweep = parseSweep("gravity=[0.0, -9.81],[0.0,-1.62], \"a,b\" ,{ a = [1,2], b = 'x,]' },pbf");
  EXPECT_EQ(sweep.path, "gravity");
  EXPECT_EQ(sweep.values, (Texts{"[0.0, -9.81]", "[0.0,-1.62]", "\"a,b\"", "{ a = [1,2], b = 'x,]' }", "pbf"}));
}

TEST(Sweep, what_is_no_sweep_is_refused_with_what_would_be_right) {
  for (const char* text : {"model.spacing", "=1,2", "a=", "a=1,,2", "a=[1,2", "a=1,1"}) {
    const std::string said = refusal<run::UsageError>([&] { parseSweep(text); });
    EXPECT_NE(said.find(text), std::string::npos) << text << said;
  }
  EXPECT_NE(refusal<run::UsageError>([&] { parseSweep("a=2,1,2"); }).find("twice"), std::string::npos);
}

TEST(Sweep, lists_keep_the_values_as_they_are_written) {
  EXPECT_EQ(listed("[0.02, 1e-6, 3, true, \"pbf\", \"2\", [0.0, 1], { a = 1 }]"),
            (Texts{"0.02", "1e-06", "3", "true", "pbf", "\"2\"", "[0.0, 1]", "{ a = 1 }"}));
}

TEST(Sweep, ranges_go_by_step_or_by_count_and_meet_both_ends) {
  EXPECT_EQ(listed("{ from = 1, to = 4, step = 1 }"), (Texts{"1", "2", "3", "4"}));
  EXPECT_EQ(listed("{ from = 0.1, to = 0.3, step = 0.1 }"), (Texts{"0.1", "0.2", "0.3"}));
  EXPECT_EQ(listed("{ from = 3, to = 1, step = 1 }"), (Texts{"3", "2", "1"}));
  EXPECT_EQ(listed("{ from = 0, to = 1, count = 5 }"), (Texts{"0", "0.25", "0.5", "0.75", "1"}));
  EXPECT_EQ(listed("{ from = 1e-6, to = 1e-3, count = 4, scale = \"log\" }"),
            (Texts{"1e-06", "1e-05", "0.0001", "0.001"}));
  EXPECT_EQ(listed("{ from = 2, to = 9, count = 1 }"), (Texts{"2"}));
}

TEST(Sweep, ranges_that_cannot_be_meant_are_refused_at_their_place) {
  for (const char* text :
       {"{ from = 1, to = 2 }", "{ from = 1, to = 2, step = 1, count = 2 }", "{ from = 1, to = 2, step = 0 }",
        "{ from = 0, to = 2, count = 2, scale = \"log\" }", "{ from = 1, to = 2, stp = 1 }", "{ from = 1, step = 1 }",
        "{ from = 0, to = 1e9, step = 1e-3 }", "3", "[]", "[1, 1]", "{ from = 1, to = 1, count = 3 }"}) {
    const std::string said = refusal<scene::SceneError>([&] { listed(text); });
    EXPECT_EQ(said.rfind("b.toml:1:", 0), 0u) << text << ": " << said;
  }
}

TEST(Sweep, the_product_has_all_combinations_and_zip_goes_side_by_side) {
  const std::vector<Sweep> sweeps{{"a", {"1", "2"}}, {"b", {"x", "y"}}};
  EXPECT_EQ(combinations(sweeps, Combination::Product),
            (std::vector<Texts>{{"1", "x"}, {"1", "y"}, {"2", "x"}, {"2", "y"}}));
  EXPECT_EQ(combinations(sweeps, Combination::Zip), (std::vector<Texts>{{"1", "x"}, {"2", "y"}}));
  EXPECT_EQ(combinations({}, Combination::Zip).size(), 1u);
}

class Plan : public testing::Test {
 protected:
  Plan() {
    std::string pattern = (fs::temp_directory_path() / "froude-plan-XXXXXX").string();
    home_ = mkdtemp(pattern.data());
    for (const char* name : {"dam.toml", "drop.toml"}) write(name, "format = 1\n");
  }
  ~Plan() override { fs::remove_all(home_); }
  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(home_ / name) << text;
    return (home_ / name).string();
  }
  static Texts folders(const BatchPlan& plan) {
    Texts names;
    for (const PlannedRun& run : plan.runs) names.push_back(run.folder);
    return names;
  }
  std::string complaint(const std::string& text) const {
    const std::string file = write("b.toml", text);
    return refusal<scene::SceneError>([&] { readBatchFile(file); });
  }
  fs::path home_;
};

TEST_F(Plan, folders_are_named_by_the_parameters) {
  const std::string dam = (home_ / "dam.toml").string(), drop = (home_ / "drop.toml").string();
  EXPECT_EQ(folders(makePlan({{dam}, {}, {}})), Texts{"dam"});
  EXPECT_EQ(folders(makePlan({{dam}, {{"model.spacing", {"0.02", "0.01"}}, {"seed", {"1"}}}, {}})),
            (Texts{"spacing=0.02_seed=1", "spacing=0.01_seed=1"}));
  EXPECT_EQ(folders(makePlan({{dam, drop}, {{"seed", {"1"}}}, {}})), (Texts{"dam_seed=1", "drop_seed=1"}));
  // Last words that are the same are told apart by all of the path; values that look the same by a number.
  EXPECT_EQ(folders(makePlan({{dam}, {{"body.a.angle", {"1"}}, {"body.b.angle", {"2"}}}, {}})),
            Texts{"body.a.angle=1_body.b.angle=2"});
  EXPECT_EQ(folders(makePlan({{dam}, {{"gravity", {"[0.0, 1.0]", "[ 0.0, 1.0 ]", "../x"}}}, {}})),
            (Texts{"gravity=0.0_1.0", "gravity=0.0_1.0-2", "gravity=.._x"}));
}

TEST_F(Plan, long_names_are_cut_and_stay_different) {
  const std::string dam = (home_ / "dam.toml").string(), word(300, 'x');
  const Texts names = folders(makePlan({{dam}, {{"title", {word + "1", word + "2"}}}, {}}));
  EXPECT_NE(names[0], names[1]);
  EXPECT_LT(names[0].size(), 200u);
}

TEST_F(Plan, a_batch_file_brings_scenes_settings_and_sweeps) {
  const std::string file = write("b.toml", R"toml([batch]
scenes = ["dam.toml", "drop.toml"]
combine = "zip"
set = { output.frames = [], duration = 0.5 }

[batch.sweep]
model.spacing = [0.02, 0.01]
"fluid.viscosity" = { from = 1e-6, to = 1e-5, count = 2 }
)toml");
  EXPECT_TRUE(isBatchFile(file));
  EXPECT_FALSE(isBatchFile((home_ / "dam.toml").string()));
  const BatchPlan plan = makePlan({{file}, {{"seed", {"1", "2"}}}, {{"title", "t"}}});
  EXPECT_EQ(plan.parameters, (Texts{"model.spacing", "fluid.viscosity", "seed"}));
  EXPECT_EQ(folders(plan),
            (Texts{"dam_spacing=0.02_viscosity=1e-06_seed=1", "dam_spacing=0.02_viscosity=1e-06_seed=2",
                   "dam_spacing=0.01_viscosity=1e-05_seed=1", "dam_spacing=0.01_viscosity=1e-05_seed=2",
                   "drop_spacing=0.02_viscosity=1e-06_seed=1", "drop_spacing=0.02_viscosity=1e-06_seed=2",
                   "drop_spacing=0.01_viscosity=1e-05_seed=1", "drop_spacing=0.01_viscosity=1e-05_seed=2"}));
  const std::vector<scene::Override> changes{{"output.frames", "[]"},   {"duration", "0.5"},          {"title", "t"},
                                             {"model.spacing", "0.02"}, {"fluid.viscosity", "1e-06"}, {"seed", "1"}};
  EXPECT_EQ(plan.runs.front().changes, changes);
  EXPECT_TRUE(difference(plan, planFromJson(toJson(plan), "batch.json")).empty());
  EXPECT_EQ(toJson(planFromJson(toJson(plan), "batch.json")), toJson(plan));
}

TEST_F(Plan, mistakes_in_a_batch_file_are_told_with_their_place) {
  for (const auto& [text, part] : std::vector<std::pair<std::string, std::string>>{
           {"[batch]\n", "scenes"},
           {"[batch]\nscenes = []\n", "scenes"},
           {"[batch]\nscenes = [\"absent.toml\"]\n", "absent.toml"},
           {"[batch]\nscenes = [\"b.toml\"]\n", "batch file"},
           {"[batch]\nscenes = [\"dam.toml\"]\nsweeps = 1\n", "sweep"},
           {"[batch]\nscenes = [\"dam.toml\"]\nsweep = 1\n", "batch.sweep"},
           {"[batch]\nscenes = [\"dam.toml\"]\n[batch.sweep]\nseed = 1\n", "seed"},
           {"[batch]\nscenes = [\"dam.toml\"]\ncombine = \"all\"\n", "zip"},
           {"[batch]\nscenes = [\"dam.toml\"]\ncombine = \"zip\"\n[batch.sweep]\nseed = [1]\nduration = [1, 2]\n",
            "length"},
           {"format = 1\n[batch]\nscenes = [\"dam.toml\"]\n", "format"}}) {
    const std::string said = complaint(text);
    EXPECT_NE(said.find("b.toml:"), std::string::npos) << text << said;
    EXPECT_NE(said.find(part), std::string::npos) << text << said;
  }
}

TEST_F(Plan, a_key_that_is_swept_twice_is_refused) {
  const std::string dam = (home_ / "dam.toml").string();
  EXPECT_NE(refusal<run::UsageError>([&] {
              makePlan({{dam}, {{"seed", {"1"}}, {"seed", {"2"}}}, {}});
            }).find("seed"),
            std::string::npos);
}

TEST_F(Plan, another_batch_is_told_apart_in_words) {
  const std::string dam = (home_ / "dam.toml").string();
  const BatchPlan plan = makePlan({{dam}, {{"seed", {"1", "2"}}}, {}});
  EXPECT_NE(difference(plan, makePlan({{dam}, {{"seed", {"1"}}}, {}})).find("2 runs"), std::string::npos);
  EXPECT_NE(difference(plan, makePlan({{dam}, {{"seed", {"1", "3"}}}, {}})).find("seed=3"), std::string::npos);
  BatchPlan until = plan;
  until.until = 0.5;
  EXPECT_NE(difference(plan, until).find("--until"), std::string::npos);
  write("dam.toml", "format = 1 \n");
  EXPECT_NE(difference(plan, makePlan({{dam}, {{"seed", {"1", "2"}}}, {}})).find("changed"), std::string::npos);
}

}  // namespace
}  // namespace froude::study
