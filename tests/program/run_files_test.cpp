// Whole files, growing files and the folder of a run.
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "export/frames.h"
#include "run/atomic_file.h"
#include "run/exit_codes.h"
#include "run/gauge_log.h"
#include "run/run_folder.h"

namespace froude::run {
namespace {

namespace fs = std::filesystem;

std::string contentsOf(const fs::path& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

void write(const fs::path& file, const std::string& text) { std::ofstream(file) << text; }

// A folder of its own, which is also the working folder, for each test.
class RunFiles : public testing::Test {
 protected:
  RunFiles() {
    std::string pattern = (fs::temp_directory_path() / "froude-files-XXXXXX").string();
    home_ = mkdtemp(pattern.data());
    before_ = fs::current_path();
    fs::current_path(home_);
  }
  ~RunFiles() override {
    fs::current_path(before_);
    fs::remove_all(home_);
  }
  // A folder as a run leaves it.
  void makeRun(const std::string& folder) {
    fs::create_directories(folder + "/frames");
    for (const char* name :
         {"scene.toml", "summary.json", "checkpoint.h5", "gauges.csv", "frame_00000.png", "frame_00123.png",
          "frames.h5", "frames.xdmf", "film.mp4", "frames/0000.h5", "checkpoint.h5.part"}) {
      write(fs::path(folder) / name, "old");
    }
  }
  fs::path home_, before_;
};

TEST_F(RunFiles, a_whole_file_replaces_the_old_one_and_leaves_nothing_beside) {
  write("a.json", "old and longer");
  writeWholeFile("a.json", "new");
  EXPECT_EQ(contentsOf("a.json"), "new");
  EXPECT_EQ(readWholeFile("a.json"), "new");
  EXPECT_FALSE(fs::exists("a.json.part"));
}

TEST_F(RunFiles, a_pending_file_that_is_not_committed_goes_away) {
  write("a.png", "old");
  {
    const PendingFile pending("a.png");
    write(pending.path(), "half");
  }
  EXPECT_EQ(contentsOf("a.png"), "old");
  EXPECT_FALSE(fs::exists("a.png.part"));
}

TEST_F(RunFiles, a_file_below_a_file_cannot_be_written_and_the_error_names_it) {
  write("plain", "");
  try {
    writeWholeFile("plain/a.json", "x");
    FAIL() << "no error";
  } catch (const exporting::OutputError& e) {
    EXPECT_NE(std::string(e.what()).find("plain/a.json"), std::string::npos) << e.what();
  }
}

TEST_F(RunFiles, a_missing_file_cannot_be_read) { EXPECT_THROW(readWholeFile("absent"), InputError); }

TEST_F(RunFiles, the_gauge_log_appends_whole_lines) {
  GaugeLog log("g.csv", std::string("t,a"));
  log.append({"0,1", "1,2"});
  log.append({});
  EXPECT_EQ(contentsOf("g.csv"), "t,a\n0,1\n1,2\n");
  EXPECT_EQ(log.bytes(), 12u);
}

TEST_F(RunFiles, a_resumed_gauge_log_drops_what_is_later_than_its_checkpoint) {
  write("g.csv", "t,a\n0,1\n1,2\n2,");
  GaugeLog log("g.csv", std::uint64_t{8});
  log.append({"1,9"});
  EXPECT_EQ(contentsOf("g.csv"), "t,a\n0,1\n1,9\n");
}

TEST_F(RunFiles, a_gauge_log_that_lost_rows_is_refused) {
  write("g.csv", "t,a\n");
  EXPECT_THROW(GaugeLog("g.csv", std::uint64_t{100}), InputError);
}

TEST_F(RunFiles, without_a_name_runs_get_numbered_folders) {
  const RunFolder first = RunFolder::create("", "dam", false);
  const RunFolder second = RunFolder::create("", "dam", false);
  const RunFolder third = RunFolder::create("", "dam", false);
  EXPECT_EQ(first.path(), "out/dam");
  EXPECT_EQ(second.path(), "out/dam-2");
  EXPECT_EQ(third.path(), "out/dam-3");
}

TEST_F(RunFiles, a_named_folder_may_be_absent_or_empty) {
  fs::create_directory("empty");
  EXPECT_EQ(RunFolder::create("empty", "s", false).path(), "empty");
  EXPECT_EQ(RunFolder::create("a/b/c/", "s", false).path(), "a/b/c");
}

TEST_F(RunFiles, a_folder_with_a_run_is_refused_without_force) {
  makeRun("run");
  EXPECT_THROW(RunFolder::create("run", "s", false), UsageError);
  EXPECT_EQ(contentsOf("run/summary.json"), "old");
}

TEST_F(RunFiles, force_removes_the_runs_files_and_keeps_foreign_ones) {
  makeRun("run");
  write("run/notes.txt", "mine");
  write("run/frame_x.png", "mine");
  write("run/frames/keep.h5", "mine");
  {
    const RunFolder folder = RunFolder::create("run", "s", true);
    EXPECT_EQ(folder.path(), "run");
  }
  std::vector<std::string> left;
  for (const auto& entry : fs::recursive_directory_iterator("run")) left.push_back(fs::relative(entry.path(), "run"));
  std::sort(left.begin(), left.end());
  EXPECT_EQ(left, (std::vector<std::string>{"frame_x.png", "frames", "frames/keep.h5", "notes.txt"}));
}

TEST_F(RunFiles, force_does_not_touch_a_folder_without_a_run) {
  fs::create_directory("photos");
  write("photos/frame_00001.png", "mine");
  EXPECT_THROW(RunFolder::create("photos", "s", true), UsageError);
  EXPECT_EQ(contentsOf("photos/frame_00001.png"), "mine");
}

TEST_F(RunFiles, force_replaces_what_a_run_left_that_was_killed_before_its_first_summary) {
  fs::create_directory("killed");
  write("killed/scene.toml", "format = 1\n");
  write("killed/summary.json.part", "{");
  EXPECT_THROW(RunFolder::create("killed", "s", false), UsageError);
  RunFolder::create("killed", "s", true);
  EXPECT_TRUE(fs::is_empty("killed"));
}

TEST_F(RunFiles, force_without_a_name_takes_the_first_folder) {
  makeRun("out/dam");
  EXPECT_EQ(RunFolder::create("", "dam", true).path(), "out/dam");
  EXPECT_FALSE(fs::exists("out/dam/summary.json"));
}

TEST_F(RunFiles, a_file_in_the_folders_place_is_refused) {
  write("plain", "");
  EXPECT_THROW(RunFolder::create("plain", "s", false), UsageError);
  EXPECT_THROW(RunFolder::create("plain/below", "s", false), exporting::OutputError);
}

TEST_F(RunFiles, two_runs_cannot_have_one_folder) {
  makeRun("run");
  {
    const RunFolder mine = RunFolder::open("run");
    EXPECT_THROW(RunFolder::open("run"), UsageError);
    EXPECT_THROW(RunFolder::create("run", "s", true), UsageError);
  }
  EXPECT_NO_THROW(RunFolder::open("run"));
  EXPECT_FALSE(fs::exists("run/.lock"));
}

TEST_F(RunFiles, a_lock_left_by_a_crash_does_not_make_a_folder_full) {
  fs::create_directory("run");
  write("run/.lock", "");
  EXPECT_NO_THROW(RunFolder::create("run", "s", false));
}

TEST_F(RunFiles, only_the_folder_of_a_run_can_be_opened) {
  fs::create_directory("empty");
  EXPECT_THROW(RunFolder::open("empty"), UsageError);
  EXPECT_THROW(RunFolder::open("absent"), UsageError);
}

TEST_F(RunFiles, an_abandoned_start_leaves_nothing) {
  {
    RunFolder folder = RunFolder::create("fresh", "s", false);
    write(folder.file("scene.toml"), "x");
    write(folder.file("summary.json.part"), "x");
    folder.abandon();
  }
  EXPECT_FALSE(fs::exists("fresh"));
}

}  // namespace
}  // namespace froude::run
