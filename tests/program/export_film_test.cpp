// Films and the processes that make them. ffmpeg itself is stood in for by a script that notes how it was called.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cstdlib>

#include "export/film.h"
#include "export/frames.h"
#include "export_support.h"
#include "run/process.h"

namespace froude {
namespace {

using test::TemporaryFolder;

void writeScript(const std::string& file, const std::string& text) {
  std::ofstream(file) << "#!/bin/sh\n" << text;
  chmod(file.c_str(), 0755);
}

/// PATH is this alone while it lives.
class OnlyPath {
 public:
  explicit OnlyPath(const std::string& path) : before_(std::getenv("PATH")) { setenv("PATH", path.c_str(), 1); }
  ~OnlyPath() { setenv("PATH", before_.c_str(), 1); }

 private:
  std::string before_;
};

TEST(Process, hands_down_arguments_as_they_are) {
  TemporaryFolder folder;
  const std::string script = folder.file("show me");
  writeScript(script, "for a in \"$@\"; do printf '[%s]' \"$a\" >> said; done\npwd >> said\n");
  const std::vector<std::string> awkward = {"two words", "", "$HOME `id` \"'\\", "*", "n² \n end", "; rm -r x"};
  std::vector<std::string> arguments = {script};
  arguments.insert(arguments.end(), awkward.begin(), awkward.end());
  const run::ProcessResult result = run::runProcess(arguments, folder.path());
  EXPECT_TRUE(result.ok());
  std::string expected;
  for (const std::string& a : awkward) expected += "[" + a + "]";
  EXPECT_EQ(folder.text("said"), expected + std::filesystem::canonical(folder.path()).string() + "\n");
}

TEST(Process, tells_how_it_ended_and_what_it_complained_about) {
  TemporaryFolder folder;
  const std::string script = folder.file("script");
  writeScript(script, "echo said nothing; echo trouble >&2; cat; exit 7\n");  // cat: standard input is empty
  const run::ProcessResult result = run::runProcess({script});
  EXPECT_EQ(result.exitCode, 7);
  EXPECT_EQ(result.errors, "trouble\n");
  writeScript(script, "kill -TERM $$\n");
  EXPECT_EQ(run::runProcess({script}).exitCode, 128 + 15);
  writeScript(script, "i=0; while [ $i -lt 20000 ]; do echo 'a long complaint' >&2; i=$((i+1)); done; echo end >&2\n");
  const run::ProcessResult long_ = run::runProcess({script});
  EXPECT_TRUE(long_.ok());
  EXPECT_LE(long_.errors.size(), 4096u);
  EXPECT_EQ(long_.errors.substr(long_.errors.size() - 4), "end\n");
  EXPECT_THROW(run::runProcess({folder.file("nobody")}), Error);
  EXPECT_THROW(run::runProcess({script}, folder.file("nowhere")), Error);
  EXPECT_THROW(run::runProcess({}), Error);
}

TEST(Film, is_left_out_with_a_note_where_ffmpeg_is_not_installed) {
  TemporaryFolder folder;
  std::ofstream(folder.file("frame_00000.png")) << "a picture";
  const OnlyPath path(folder.path());
  const exporting::Film film = exporting::makeFilm(folder.path(), 0.02);
  EXPECT_TRUE(film.file.empty());
  EXPECT_NE(film.note.find("ffmpeg is not installed"), std::string::npos);
}

TEST(Film, is_made_of_the_numbered_pictures_whatever_the_folder_is_called) {
  TemporaryFolder tools, home;
  writeScript(tools.file("ffmpeg"),
              "for a in \"$@\"; do printf '%s\\n' \"$a\" >> calls; last=\"$a\"; done\nprintf film > \"$last\"\n");
  const std::string folder = home.file("50%d of 'it'; $x");
  std::filesystem::create_directory(folder);
  std::ofstream(folder + "/frame_00000.png") << "a picture";
  exporting::Film film;
  {
    const OnlyPath path(tools.path());
    film = exporting::makeFilm(folder, 0.04);
  }
  EXPECT_EQ(film.file, folder + "/film.mp4") << film.note;
  std::stringstream calls;
  calls << std::ifstream(folder + "/calls").rdbuf();
  const std::string said = calls.str();
  for (const char* wanted : {"-framerate\n25\n", "-i\nframe_%05d.png\n", "-pix_fmt\nyuv420p\n", "-nostdin\n"})
    EXPECT_NE(said.find(wanted), std::string::npos) << said;
  EXPECT_TRUE(std::filesystem::exists(folder + "/film.mp4"));
  EXPECT_FALSE(std::filesystem::exists(folder + "/film.mp4.part"));
}

TEST(Film, that_fails_is_a_note_and_leaves_nothing) {
  TemporaryFolder tools, folder;
  writeScript(tools.file("ffmpeg"),
              "for a; do last=\"$a\"; done\nprintf half > \"$last\"\necho 'no such codec' >&2\nexit 1\n");
  std::ofstream(folder.file("frame_00000.png")) << "a picture";
  const OnlyPath path(tools.path());
  const exporting::Film film = exporting::makeFilm(folder.path(), 0.02);
  EXPECT_TRUE(film.file.empty());
  EXPECT_NE(film.note.find("no such codec"), std::string::npos) << film.note;
  EXPECT_EQ(folder.files(), std::vector<std::string>{"frame_00000.png"});
}

TEST(Film, needs_pictures) {
  TemporaryFolder tools, folder;
  writeScript(tools.file("ffmpeg"), "exit 0\n");
  const OnlyPath path(tools.path());
  EXPECT_NE(exporting::makeFilm(folder.path(), 0.02).note.find("no pictures"), std::string::npos);
}

}  // namespace
}  // namespace froude
