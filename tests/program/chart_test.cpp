// Points of the chart: their file, the front, the pictures.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "plan/chart_page.h"
#include "plan/diagram.h"
#include "run/exit_codes.h"

namespace froude::plan {
namespace {

Point point(const std::string& subject, const std::string& model, double spacing, double error, double cost) {
  Point p{"splash", subject, model, spacing, 0.0};
  p.particles = 100;
  p.error = error;
  p.target = 0.02;
  p.wallSeconds = 2.0 * cost;
  p.simulatedSeconds = 2.0;
  p.particleSteps = 1e6;
  return p;
}

Point failed(const std::string& model) {
  Point p = point("dam", model, 0.1, std::nan(""), 1.0);
  p.state = "unstable: speed, \"of\" particles";
  return p;
}

class PointFile : public ::testing::Test {
 protected:
  void write(const std::string& text) const { std::ofstream(file_) << text; }
  ~PointFile() override { std::filesystem::remove(file_); }
  const std::string file_ = ::testing::TempDir() + "points_of_a_chart.csv";
};

TEST_F(PointFile, gives_back_what_was_written) {
  const Circumstances here = circumstances(2);
  const Point p = point("dam", "pbf", 0.02, 0.0125, 3.5);
  write(pointsHead() + pointLine(p, here, "2026-01-31") + pointLine(failed("apic"), here, "2026-02-01"));
  const PointTable table = readPoints(file_);
  EXPECT_EQ(table.where, here);
  EXPECT_EQ(table.date, "2026-02-01");
  ASSERT_EQ(table.points.size(), 2u);
  EXPECT_EQ(table.points[0].subject, "dam");
  EXPECT_EQ(table.points[0].model, "pbf");
  EXPECT_DOUBLE_EQ(table.points[0].spacing, 0.02);
  EXPECT_DOUBLE_EQ(table.points[0].error, 0.0125);
  EXPECT_DOUBLE_EQ(table.points[0].cost(), 3.5);
  EXPECT_NEAR(table.points[0].stepsPerSecond(), p.stepsPerSecond(), 1.0);
  EXPECT_FALSE(table.points[1].ended());
  EXPECT_EQ(table.points[1].state, failed("apic").state);
}

TEST_F(PointFile, leaves_out_what_another_build_or_machine_measured) {
  Circumstances other = circumstances(2);
  other.commit = "another";
  write(pointsHead() + pointLine(point("dam", "pbf", 0.02, 0.1, 1.0), other, "2026-01-01") +
        pointLine(point("dam", "apic", 0.02, 0.1, 1.0), circumstances(2), "2026-01-02"));
  const PointTable table = readPoints(file_);
  ASSERT_EQ(table.points.size(), 1u);
  EXPECT_EQ(table.points[0].model, "apic");
}

TEST_F(PointFile, of_something_else_is_refused_in_words) {
  write("case,metric\ndam,toe\n");
  EXPECT_THROW(readPoints(file_), run::InputError);
  write(pointsHead() + "splash,dam,pbf,wide,0,1,,,,,,,done,cpu,2,c,b,s,2,2026-01-01\n");
  try {
    readPoints(file_);
    FAIL() << "a spacing that is no number was taken";
  } catch (const run::InputError& e) {
    EXPECT_NE(std::string(e.what()).find("'wide' is no number"), std::string::npos) << e.what();
  }
}

TEST(ParetoFront, holds_what_no_other_point_beats_in_both) {
  // By hand: b is beaten by a in both, d by c in time with the same error; e did not end.
  const std::vector<Point> points{point("dam", "a", 0.1, 0.10, 1.0), point("dam", "b", 0.1, 0.20, 1.5),
                                  point("dam", "c", 0.1, 0.01, 4.0), point("dam", "d", 0.1, 0.01, 5.0), failed("e")};
  EXPECT_EQ(paretoFront(points), (std::vector<std::size_t>{0, 2}));
}

TEST(ParetoFront, of_equal_points_takes_the_first) {
  const std::vector<Point> points{point("dam", "a", 0.1, 0.1, 1.0), point("dam", "b", 0.1, 0.1, 1.0)};
  EXPECT_EQ(paretoFront(points), (std::vector<std::size_t>{0}));
  EXPECT_TRUE(paretoFront({}).empty());
}

TEST(Standings, count_the_cases_in_which_a_model_is_on_the_front) {
  const std::vector<Point> points{point("dam", "a", 0.1, 0.1, 1.0), point("dam", "b", 0.1, 0.2, 2.0),
                                  point("tank", "a", 0.1, 0.1, 2.0), point("tank", "b", 0.1, 0.2, 1.0),
                                  point("tank", "b", 0.05, 0.15, 1.5)};
  const std::vector<Panel> all = panels(points);
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[1].points.size(), 3u);
  const std::vector<Standing> standing = standings(all);
  ASSERT_EQ(standing.size(), 2u);
  EXPECT_EQ(standing[0].fronts, 2u);
  EXPECT_EQ(standing[1].fronts, 1u);
  EXPECT_EQ(standing[1].cases, 2u);
  EXPECT_EQ(standing[1].where, std::vector<std::string>{"tank"});
}

TEST(ChartPicture, is_drawn_as_svg_and_as_png_even_where_nothing_ended) {
  const std::vector<Point> points{point("dam", "pbf", 0.1, 0.1, 1.0), point("dam", "pbf", 0.05, 0.0, 8.0),
                                  failed("apic")};
  for (const std::vector<Panel>& all : {panels(points), panels(std::vector<Point>{failed("apic")}), panels({})}) {
    EXPECT_EQ(drawChart("a.png", all, "where").substr(1, 3), "PNG");
    const std::string svg = drawChart("a.svg", all, "a < b");
    EXPECT_NE(svg.find("<svg"), std::string::npos);
    EXPECT_NE(svg.find("<desc>a &lt; b</desc>"), std::string::npos);
  }
}

TEST(ChartPage, holds_every_point_also_those_that_did_not_end) {
  const std::string file = ::testing::TempDir() + "chart_page.html";
  const std::vector<Point> points{point("dam", "pbf", 0.1, 0.25, 1.0), failed("apic")};
  writeChartPage(file, panels(points), "where");
  std::stringstream text;
  text << std::ifstream(file).rdbuf();
  EXPECT_NE(text.str().find("\"error\":0.25"), std::string::npos);
  EXPECT_NE(text.str().find("\"error\":null"), std::string::npos);
  EXPECT_NE(text.str().find("\"front\":true"), std::string::npos);
  std::filesystem::remove(file);
}

}  // namespace
}  // namespace froude::plan
