// Shell completion and the manual page, by the very shells and formatters that use them.
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <string>

#include "program_runs/program.h"

namespace froude::testing {
namespace {

class Describe : public ProgramTest {
 protected:
  /// Both outputs of a shell command in the test's folder; ends with "exit N" where N is not 0.
  std::string shell(const std::string& command) const {
    const std::string line = "cd '" + home_.string() + "' && ( " + command + " ) 2>&1 || echo exit $?";
    FILE* pipe = popen(line.c_str(), "r");
    std::string text;
    char buffer[512];
    while (std::fgets(buffer, sizeof buffer, pipe) != nullptr) text += buffer;
    pclose(pipe);
    return text;
  }
  bool has(const std::string& program) const { return shell("command -v " + program + " > /dev/null").empty(); }
  /// What bash offers behind these words, the last of them half-typed.
  std::string offered(const std::string& words, int last) const {
    return shell("bash -c '. ./froude.bash; COMP_WORDS=(" + words + "); COMP_CWORD=" + std::to_string(last) +
                 "; _froude; echo ${COMPREPLY[*]}'");
  }
};

TEST_F(Describe, bash_completes_commands_options_values_and_files) {
  if (!has("bash")) GTEST_SKIP() << "there is no bash";
  write("froude.bash", froude({"completion", "bash"}).out);
  write("dam.toml", "");
  EXPECT_EQ(shell("bash -n froude.bash"), "");
  EXPECT_EQ(offered("froude b", 1), "batch bench\n");
  EXPECT_EQ(offered("froude ch", 1), "check chart\n");
  EXPECT_EQ(offered("froude batch --s", 2), "--sweep --slurm --set --simd\n");
  EXPECT_EQ(offered("froude run d", 2), "dam.toml\n");
  EXPECT_EQ(offered("froude run --simd a", 3), "avx2 avx3\n");
  EXPECT_EQ(offered("froude run --threads \"\"", 3), "\n");
  EXPECT_EQ(offered("froude batch --baseline d", 3), "dam.toml\n");
}

TEST_F(Describe, zsh_and_fish_take_their_scripts) {
  for (const std::string shellName : {"zsh", "fish"}) {
    const Outcome outcome = froude({"completion", shellName});
    EXPECT_EQ(outcome.code, 0);
    EXPECT_NE(outcome.out.find("sweep"), std::string::npos);
    write("script", outcome.out);
    if (has(shellName)) {
      EXPECT_EQ(shell(shellName + " -n script"), "") << shellName;
    }
  }
  const Outcome other = froude({"completion", "tcsh"});
  EXPECT_EQ(other.code, 2);
  EXPECT_NE(other.err.find("bash, zsh and fish"), std::string::npos) << other.err;
}

TEST_F(Describe, the_manual_page_has_every_command_and_option_and_formats_without_a_warning) {
  const Outcome outcome = froude({"man"});
  EXPECT_EQ(outcome.code, 0);
  write("froude.1", outcome.out);
  if (!has("groff")) GTEST_SKIP() << "there is no groff";
  EXPECT_EQ(shell("groff -man -ww -z -Tutf8 froude.1"), "");
  const std::string page = shell("groff -man -Tascii -P-cbou froude.1");
  for (const char* part : {"froude run", "froude batch", "--sweep PATH=V1,V2,...", "--trace-leaks", "SCENE", "-o DIR",
                           "Exit codes: 0 done"})
    EXPECT_NE(page.find(part), std::string::npos) << part << "\n" << page;
}

}  // namespace
}  // namespace froude::testing
