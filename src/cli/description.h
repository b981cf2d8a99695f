// What the program's command line looks like, as plain data: for completion and the manual page.
#pragma once

#include <string>
#include <vector>

namespace froude::cli {

struct OptionText {
  std::vector<std::string> names;  // "--force", "-o"; of a positional argument its name
  std::string argument;            // "DIR"; empty for a flag
  std::string what;
  bool positional = false;
};

struct CommandText {
  std::string name, what;
  std::string footer;  // example and exit codes
  std::vector<OptionText> options;
};

struct ProgramText {
  std::string what, version;
  std::vector<CommandText> commands;
};

/// Read off the very parser that reads command lines.
ProgramText describeProgram();

/// A script that a shell of this name ("bash", "zsh" or "fish") loads. Throws run::UsageError for another.
std::string completionScript(const ProgramText& program, const std::string& shell);

/// froude(1), in the man macros.
std::string manualPage(const ProgramText& program);

}  // namespace froude::cli
