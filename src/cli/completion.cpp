// Completion scripts: commands, options, and files behind whatever takes one.
#include <fmt/format.h>

#include <algorithm>

#include "cli/description.h"
#include "run/exit_codes.h"

namespace froude::cli {
namespace {

// Words that complete an option's argument; empty: files do; "-": nothing does.
std::string choicesOf(const OptionText& option) {
  if (option.argument == "TARGET") return "scalar sse4 avx2 avx3";
  if (option.argument == "LIST") return "png h5 vdb none";
  if (option.argument == "N" || option.argument == "SECONDS" || option.argument == "METRES" ||
      option.argument == "PIXELS" || option.argument == "P%" || option.argument.starts_with("PATH="))
    return "-";
  return {};
}

std::string joinNames(const CommandText& command) {
  std::string words;
  for (const OptionText& option : command.options)
    if (!option.positional) words += (words.empty() ? "" : " ") + fmt::format("{}", fmt::join(option.names, " "));
  return words;
}

// Text within single quotes of a shell.
std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out;
}

std::string bash(const ProgramText& program) {
  std::string names;
  for (const CommandText& command : program.commands) names += (names.empty() ? "" : " ") + command.name;
  std::string text = "# bash completion of froude; `froude completion bash` writes it.\n_froude() {\n";
  text += "  local word=\"${COMP_WORDS[COMP_CWORD]}\" before=\"${COMP_WORDS[COMP_CWORD-1]}\" options=\"\"\n";
  text += "  COMPREPLY=()\n";
  text += fmt::format(
      "  if [ \"$COMP_CWORD\" -eq 1 ]; then\n    COMPREPLY=($(compgen -W \"{} --help --version\" -- "
      "\"$word\"))\n    return\n  fi\n  case \"${{COMP_WORDS[1]}} $before\" in\n",
      names);
  for (const CommandText& command : program.commands) {
    for (const OptionText& option : command.options) {
      if (option.positional || option.argument.empty()) continue;
      const std::string choices = choicesOf(option);
      const std::string action = choices.empty() ? "COMPREPLY=($(compgen -f -- \"$word\"))"
                                 : choices == "-"
                                     ? ""
                                     : fmt::format("COMPREPLY=($(compgen -W \"{}\" -- \"$word\"))", choices);
      for (const std::string& name : option.names)
        text += fmt::format("    '{} {}') {}{}return ;;\n", command.name, name, action, action.empty() ? "" : "; ");
    }
  }
  text += "  esac\n  case \"${COMP_WORDS[1]}\" in\n";
  for (const CommandText& command : program.commands)
    text += fmt::format("    {}) options=\"{}\" ;;\n", command.name, joinNames(command));
  text += "  esac\n  if [[ $word == -* ]]; then\n    COMPREPLY=($(compgen -W \"$options\" -- \"$word\"))\n  else\n";
  text += "    COMPREPLY=($(compgen -f -- \"$word\"))\n  fi\n}\ncomplete -o filenames -F _froude froude\n";
  return text;
}

std::string zsh(const ProgramText& program) {
  const auto plain = [](std::string what) {
    std::replace_if(
        what.begin(), what.end(), [](char c) { return c == '[' || c == ']' || c == ':'; }, ' ');
    return escaped(what);
  };
  std::string text = "#compdef froude\n# zsh completion of froude; `froude completion zsh` writes it.\n_froude() {\n";
  text += "  local -a commands\n  commands=(\n";
  for (const CommandText& command : program.commands)
    text += fmt::format("    '{}:{}'\n", command.name, plain(command.what));
  text += "  )\n  if (( CURRENT == 2 )); then\n    _describe command commands\n    return\n  fi\n";
  text += "  local name=$words[2]\n  shift words\n  (( CURRENT-- ))\n  case $name in\n";
  for (const CommandText& command : program.commands) {
    text += fmt::format("    {}) _arguments", command.name);
    for (const OptionText& option : command.options) {
      if (option.positional) continue;
      const std::string choices = choicesOf(option);
      const std::string action = option.argument.empty() ? ""
                                 : choices.empty()       ? ":file:_files"
                                 : choices == "-"        ? ":value: "
                                                         : ":value:(" + choices + ")";
      for (const std::string& name : option.names)
        text += fmt::format(" \\\n      '*{}[{}]{}'", name, plain(option.what), action);
    }
    text += " \\\n      '*:file:_files' ;;\n";
  }
  return text + "  esac\n}\n_froude \"$@\"\n";
}

std::string fish(const ProgramText& program) {
  std::string text = "# fish completion of froude; `froude completion fish` writes it.\n";
  for (const CommandText& command : program.commands) {
    text += fmt::format("complete -c froude -n __fish_use_subcommand -f -a {} -d '{}'\n", command.name,
                        escaped(command.what));
    for (const OptionText& option : command.options) {
      if (option.positional) continue;
      std::string line = fmt::format("complete -c froude -n '__fish_seen_subcommand_from {}'", command.name);
      for (const std::string& name : option.names)
        line += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
      const std::string choices = choicesOf(option);
      if (!option.argument.empty()) line += choices.empty() ? " -r -F" : " -x";
      if (!choices.empty() && choices != "-") line += " -a '" + choices + "'";
      text += line + " -d '" + escaped(option.what) + "'\n";
    }
  }
  return text;
}

}  // namespace

std::string completionScript(const ProgramText& program, const std::string& shell) {
  if (shell == "bash") return bash(program);
  if (shell == "zsh") return zsh(program);
  if (shell == "fish") return fish(program);
  throw run::UsageError("completion " + shell + ": there are scripts for bash, zsh and fish");
}

}  // namespace froude::cli
