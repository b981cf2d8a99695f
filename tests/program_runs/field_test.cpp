// `froude field` as a user runs it: exact answers, files whole or absent, codes.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <sstream>

#include "program_runs/program.h"

namespace froude::testing {
namespace {

class Field : public ProgramTest {
 protected:
  Field() { write("box.toml", "shape = { box = [0, 0, 2, 1] }\n"); }
};

std::vector<std::vector<double>> rowsOf(const std::string& csv) {
  std::vector<std::vector<double>> rows;
  std::istringstream lines(csv);
  std::string line;
  std::getline(lines, line);
  while (std::getline(lines, line)) {
    rows.emplace_back();
    std::istringstream cells(line);
    for (std::string cell; std::getline(cells, cell, ',');) rows.back().push_back(std::stod(cell));
  }
  return rows;
}

// Distances from exact fractions and 40-digit roots.
TEST_F(Field, answers_at_the_points_of_the_exact_table) {
  std::ifstream stream(std::string(FROUDE_TEST_DATA) + "/geometry_polygons.json");
  const nlohmann::json polygons = nlohmann::json::parse(stream)["polygons"];
  for (const auto& [name, polygon] : polygons.items()) {
    if (!polygon.contains("signed_distance")) continue;
    const nlohmann::json& loops = polygon["loops"];
    nlohmann::json holes = nlohmann::json::array();
    for (std::size_t k = 1; k < loops.size(); ++k) holes.push_back(loops[k]);
    write("shape.toml", "shape = { polygon = " + loops[0].dump() + ", holes = " + holes.dump() + " }\n");
    std::ostringstream points;
    points.precision(17);
    for (const auto& row : polygon["signed_distance"])
      points << row[0].get<double>() << ',' << row[1].get<double>() << '\n';
    write("points.csv", points.str());
    const Outcome outcome = froude({"field", "shape.toml", "--at", "points.csv"});
    ASSERT_EQ(outcome.code, 0) << name << outcome.err;
    ASSERT_TRUE(outcome.out.starts_with("x,y,distance,normal_x,normal_y,closest_x,closest_y\n"));
    const auto rows = rowsOf(outcome.out);
    ASSERT_EQ(rows.size(), polygon["signed_distance"].size()) << name;
    for (std::size_t k = 0; k < rows.size(); ++k) {
      const std::vector<double>& r = rows[k];
      const auto& right = polygon["signed_distance"][k];
      ASSERT_EQ(r.size(), 7u);
      EXPECT_EQ(r[0], right[0].get<double>());
      EXPECT_EQ(r[1], right[1].get<double>());
      EXPECT_NEAR(r[2], right[2].get<double>(), 4e-15) << name << " row " << k;
      EXPECT_NEAR(std::hypot(r[3], r[4]), 1.0, 1e-12);
      EXPECT_NEAR(r[0] - r[2] * r[3], r[5], 1e-14);
      EXPECT_NEAR(r[1] - r[2] * r[4], r[6], 1e-14);
    }
  }
}

TEST_F(Field, is_exact_far_from_the_shape_and_deep_within) {
  write("points.csv", "1e9,0.5\n-3e12,4e12\n1,0.5\n2,1\n1e-300,0\n");
  const Outcome outcome = froude({"field", "box.toml", "--at", "points.csv"});
  const auto rows = rowsOf(outcome.out);
  ASSERT_EQ(rows.size(), 5u);
  EXPECT_EQ(rows[0][2], 1e9 - 2.0);
  EXPECT_NEAR(rows[1][2], std::hypot(3e12, 4e12 - 1.0), 1e-3);
  EXPECT_EQ(rows[2][2], -0.5);
  EXPECT_EQ(rows[3][2], 0.0);
  EXPECT_NEAR(rows[4][2], 0.0, 1e-299);
  EXPECT_EQ(outcome.out.find("-0,"), std::string::npos) << outcome.out;
}

TEST_F(Field, a_table_goes_to_a_file_whole_or_not_at_all) {
  write("points.csv", "0.5,0.5\n");
  const Outcome outcome = froude({"field", "box.toml", "--at", "points.csv", "-o", "answers.csv"});
  EXPECT_EQ(outcome.code, 0);
  EXPECT_EQ(outcome.lastLine(), "answers.csv");
  EXPECT_EQ(read("answers.csv"), froude({"field", "box.toml", "--at", "points.csv"}).out);
  Circumstances small;
  small.fileSizeLimit = 10;
  EXPECT_EQ(froude({"field", "box.toml", "--at", "points.csv", "-o", "more.csv"}, small).code, 4);
  EXPECT_EQ(froude({"field", "box.toml", "-o", "more.png"}, small).code, 4);
  EXPECT_EQ(files(""), (Words{"answers.csv", "box.toml", "points.csv"}));
}

TEST_F(Field, draws_both_kinds_of_pictures) {
  for (const char* name : {"a.png", "a.svg"}) {
    const Outcome outcome = froude({"field", "box.toml", "-o", name, "--offset", "0.1"});
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_EQ(outcome.out, std::string(name) + "\n");
    EXPECT_EQ(outcome.err, "");
    const std::string bytes = read(name);
    froude({"field", "box.toml", "-o", name, "--offset", "0.1"});
    EXPECT_EQ(read(name), bytes) << "the same picture again";
  }
  EXPECT_TRUE(read("a.png").starts_with("\x89PNG"));
  EXPECT_TRUE(read("a.svg").starts_with("<?xml"));
}

TEST_F(Field, what_is_wrong_ends_with_2_and_writes_nothing) {
  write("points.csv", "0.5,0.5\n1\n");
  const auto expectRefusal = [&](const Words& words, const std::string& part) {
    const Outcome outcome = froude(words);
    EXPECT_EQ(outcome.code, 2) << outcome.err;
    EXPECT_EQ(outcome.out, "");
    EXPECT_NE(outcome.err.find(part), std::string::npos) << part << " in " << outcome.err;
  };
  expectRefusal({"field", "box.toml", "--at", "points.csv"}, "points.csv:2:1: row");
  expectRefusal({"field", "box.toml", "--at", "points.csv", "-o", "a.csv"}, "points.csv:2:1: row");
  expectRefusal({"field", "box.toml", "--at", "absent.csv"}, "absent.csv:0:0: file: there is no such file");
  expectRefusal({"field", "absent.toml", "-o", "a.png"}, "absent.toml:0:0: file: there is no such file");
  expectRefusal({"field", "box.toml", "-o", "a.gif"}, "FILE.svg or FILE.html");
  expectRefusal({"field", "box.toml"}, "nothing is asked");
  EXPECT_EQ(files(""), (Words{"box.toml", "points.csv"}));
}

TEST_F(Field, repairs_are_told_on_stderr) {
  write("v.csv", "0,0\n0,1\n1,1\n1,0\n0,0\n");
  write("points.csv", "0.5,0.25\n");
  const Outcome outcome = froude({"field", "v.csv", "--at", "points.csv"});
  EXPECT_EQ(outcome.code, 0);
  EXPECT_NE(outcome.err.find("v.csv: note: "), std::string::npos);
  EXPECT_EQ(rowsOf(outcome.out).at(0).at(2), -0.25);
}

}  // namespace
}  // namespace froude::testing
