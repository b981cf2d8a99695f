// The table of `froude field SHAPE --check`.
#include "cli/field_check.h"

#include <gtest/gtest.h>

#include <sstream>
#include <vector>

#include "openvdb/shapes.h"

namespace froude::cli {
namespace {

std::vector<std::string> printed(const std::string& shape) {
  std::ostringstream out;
  EXPECT_EQ(printFieldCheck(test::goldenShapes().at(shape), shape, out), 0);
  std::vector<std::string> lines;
  std::istringstream in(out.str());
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

TEST(FieldCheck, prints_a_row_a_voxel_size_and_says_whether_the_two_agree) {
  const std::vector<std::string> lines = printed("tri_345");
  ASSERT_EQ(lines.size(), 10u);
  EXPECT_EQ(lines[0].rfind("tri_345: 3 edges, 4 m x 3 m, against OpenVDB ", 0), 0u) << lines[0];
  for (std::size_t k = 3; k < 7; ++k) {
    EXPECT_EQ(lines[k].size(), lines[3].size()) << lines[k];
    EXPECT_EQ(lines[k].find('|'), lines[3].find('|')) << lines[k];
  }
  EXPECT_NE(lines[4].find("0.0625"), std::string::npos) << lines[4];
  EXPECT_NE(lines.back().find("agree to single precision"), std::string::npos) << lines.back();
}

TEST(FieldCheck, says_what_could_not_be_compared) {
  const std::vector<std::string> lines = printed("plate_1_1024");
  bool told = false;
  for (const std::string& line : lines) told = told || line.find("no point is clear of corners") != std::string::npos;
  EXPECT_TRUE(told);
}

}  // namespace
}  // namespace froude::cli
