// `froude chart` as a user runs it. This build has assertions, so errors are measured, and no times.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "program_runs/program.h"

namespace froude::testing {
namespace {

using Chart = ProgramTest;

std::ptrdiff_t lines(const std::string& text) { return std::count(text.begin(), text.end(), '\n'); }

TEST_F(Chart, measures_what_was_asked_for_once) {
  const Words words{"chart", "-o", "c", "--quick", "--cases", "drop", "--models", "pbf,apic"};
  const Outcome first = froude(words);
  EXPECT_EQ(first.code, 0) << first.err;
  EXPECT_EQ(first.lastLine(), "c");
  EXPECT_NE(first.err.find("[4/4] drop apic"), std::string::npos) << first.err;
  const std::string points = read("c/points.csv");
  EXPECT_EQ(lines(points), 5);
  // Half of them are gone, as when it had been stopped: only those are measured again.
  std::size_t end = 0;
  for (int i = 0; i < 3; ++i) end = points.find('\n', end) + 1;
  write("c/points.csv", points.substr(0, end));
  const Outcome second = froude(words);
  EXPECT_EQ(second.code, 0) << second.err;
  EXPECT_EQ(second.err.find("[2/4]"), std::string::npos) << second.err;
  EXPECT_NE(second.err.find("[3/4]"), std::string::npos) << second.err;
  EXPECT_EQ(read("c/points.csv"), points) << "the same bits, so the same errors";
}

TEST_F(Chart, refuses_what_there_is_not_and_writes_nothing) {
  for (const Words& words : {Words{"chart", "-o", "c", "--cases", "damm"}, Words{"chart", "-o", "c", "--models", "bpf"},
                             Words{"chart", "-o", ""}, Words{"chart", "--limit", "soon"}, Words{"chart", "c"}}) {
    const Outcome outcome = froude(words);
    EXPECT_EQ(outcome.code, 2) << outcome.err;
    EXPECT_FALSE(outcome.err.empty());
  }
  EXPECT_TRUE(files("").empty());
}

TEST_F(Chart, does_not_write_behind_something_else) {
  write("points.csv", "name,price\nfish,3\n");
  const Outcome outcome = froude({"chart", "-o", ".", "--quick", "--cases", "drop", "--models", "pbf"});
  EXPECT_EQ(outcome.code, 4) << outcome.err;
  EXPECT_NE(outcome.err.find("points.csv"), std::string::npos);
  EXPECT_EQ(read("points.csv"), "name,price\nfish,3\n");
}

}  // namespace
}  // namespace froude::testing
