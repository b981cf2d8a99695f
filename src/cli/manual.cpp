// The manual page, in the man macros of groff.
#include <fmt/format.h>

#include <sstream>

#include "cli/description.h"

namespace froude::cli {
namespace {

// A line of text as roff reads it back: no escapes, hyphens as typed, no request at its beginning.
std::string roff(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '\\') {
      out += "\\e";
    } else if (c == '-') {
      out += "\\-";
    } else {
      out += c;
    }
  }
  return !out.empty() && (out[0] == '.' || out[0] == '\'') ? "\\&" + out : out;
}

std::string options(const CommandText& command) {
  std::string text;
  for (const OptionText& option : command.options) {
    std::string head;
    for (const std::string& name : option.names) head += (head.empty() ? "\\fB" : ", \\fB") + roff(name) + "\\fR";
    if (!option.argument.empty()) head += " \\fI" + roff(option.argument) + "\\fR";
    text += ".TP\n" + head + "\n" + roff(option.what) + "\n";
  }
  return text;
}

// Examples keep their lines; sentences are filled.
std::string footer(const std::string& text) {
  std::string out;
  std::istringstream lines(text);
  bool example = false;
  for (std::string line; std::getline(lines, line);) {
    const bool indented = line.starts_with("  ");
    if (indented != example) out += indented ? ".nf\n" : ".fi\n";
    example = indented;
    out += line.empty() ? ".P\n" : roff(line) + "\n";
  }
  return out + (example ? ".fi\n" : "");
}

}  // namespace

std::string manualPage(const ProgramText& program) {
  std::string text = fmt::format(".TH FROUDE 1 \"\" \"froude {}\" \"User Commands\"\n", program.version);
  text += ".SH NAME\nfroude \\- particles, fluids and soft bodies among rigid polygons\n.SH SYNOPSIS\n";
  for (const CommandText& command : program.commands) {
    std::string places;
    for (const OptionText& option : command.options)
      if (option.positional) places += " \\fI" + roff(option.names.front()) + "\\fR";
    text += ".B froude " + roff(command.name) + "\n[\\fIoptions\\fR]" + places + "\n.br\n";
  }
  text += ".SH DESCRIPTION\n" + roff(program.what) + "\n.SH COMMANDS\n";
  for (const CommandText& command : program.commands) {
    text += ".SS froude " + roff(command.name) + "\n" + roff(command.what) + "\n" + options(command);
    text += ".P\n" + footer(command.footer);
  }
  return text;
}

}  // namespace froude::cli
