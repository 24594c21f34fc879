// phasescan completion bash|zsh|fish: what a shell completes, from the commands' own definitions.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <memory>

#include "command_list.hpp"
#include "commands.hpp"

namespace phasescan::app {
namespace {

/// One flag or argument as completion sees it.
struct Value {
  std::vector<std::string> words;  ///< what it may be
  bool file = false;               ///< else nothing is offered for it
};

Value value_of(CLI::Option& option) {
  Value value{words_of(option), false};
  const std::string type = option.get_type_name();
  for (const char* of_file : {"FILE", "DIR", "F.", "T.tum", "R.tum", "LOG", "SPEC", "TEXT"})
    value.file = value.file || (type.starts_with(of_file) && type.find('{') == std::string::npos);
  return value;
}

std::vector<CLI::Option*> options_of(const CLI::App& command) {
  // CLI11 gives those of a command that may be changed by another name only.
  return const_cast<CLI::App&>(command).get_options([](CLI::Option* option) { return !option->get_lnames().empty(); });
}

std::vector<const CLI::App*> shown_commands(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App* command) { return !command->get_group().empty(); });
}

/// Text between single quotes of a shell, `special` characters behind a backslash.
std::string quoted(const std::string& text, std::string_view special = "") {
  std::string out;
  for (const char c : text) {
    if (c == '\'') {
      out += "'\\''";
      continue;
    }
    if (special.find(c) != std::string_view::npos) out += '\\';
    out += c;
  }
  return out;
}

/// The lines of a command and of those below it; `path` is "bench retrieval".
void bash_of(const CLI::App& command, const std::string& path, std::string& values, std::string& words) {
  std::string flags;
  for (CLI::Option* option : options_of(command)) {
    for (const std::string& name : option->get_lnames()) {
      flags += " --" + name;
      if (option->get_items_expected_max() == 0) continue;
      const Value value = value_of(*option);
      std::string reply = ":";
      if (!value.words.empty())
        reply = fmt::format("COMPREPLY=($(compgen -W '{}' -- \"$cur\"))",
                            quoted(fmt::format("{}", fmt::join(value.words, " "))));
      if (value.file) reply += "; compopt -o default";
      values += fmt::format("    '{} --{}') {}; return ;;\n", path, name, reply);
    }
  }
  std::string below;
  for (const CLI::App* sub : shown_commands(command)) {
    below += " " + sub->get_name();
    bash_of(*sub, path.empty() ? sub->get_name() : path + " " + sub->get_name(), values, words);
  }
  words += fmt::format("    '{}') flags='{}' commands='{}' ;;\n", path, flags, below);
}

std::string bash_script(const CLI::App& app) {
  std::string values, words;
  bash_of(app, "", values, words);
  std::string paths;
  for (const CLI::App* command : shown_commands(app)) {
    paths += (paths.empty() ? "'" : " | '") + command->get_name() + "'";
    for (const CLI::App* sub : shown_commands(*command))
      paths += " | '" + command->get_name() + " " + sub->get_name() + "'";
  }
  return fmt::format(R"bash(# bash completion of phasescan, made by `phasescan completion bash`
_phasescan() {{
  local cur=${{COMP_WORDS[COMP_CWORD]}} prev=${{COMP_WORDS[COMP_CWORD-1]}} command= flags= commands= i longer
  COMPREPLY=()
  for ((i = 1; i < COMP_CWORD; i++)); do
    longer="${{command:+$command }}${{COMP_WORDS[i]}}"
    case "$longer" in
      {}) command=$longer ;;
    esac
  done
  case "$command $prev" in
{}  esac
  case "$command" in
{}  esac
  if [[ $cur == -* ]]; then
    COMPREPLY=($(compgen -W "$flags" -- "$cur"))
  elif [ -n "$commands" ]; then
    COMPREPLY=($(compgen -W "$commands" -- "$cur"))
  else
    compopt -o default
  fi
}}
complete -F _phasescan phasescan
)bash",
                     paths, values, words);
}

void zsh_of(const CLI::App& command, const std::string& name, std::string& out) {
  const auto below = shown_commands(command);
  std::string body = fmt::format("{}() {{\n  local -a line\n  _arguments -C", name);
  for (CLI::Option* option : options_of(command)) {
    for (const std::string& flag : option->get_lnames()) {
      body += fmt::format(" \\\n    '*--{}[{}]", flag, quoted(option->get_description(), "[]:\\"));
      if (option->get_items_expected_max() > 0) {
        const Value value = value_of(*option);
        body += ":value:" + (!value.words.empty() ? "(" + quoted(fmt::format("{}", fmt::join(value.words, " "))) + ")"
                             : value.file         ? "_files"
                                                  : "");
      }
      body += "'";
    }
  }
  if (below.empty()) {
    out += body + " \\\n    '*:file:_files'\n}\n";
    return;
  }
  std::string list, cases;
  for (const CLI::App* sub : below) {
    list += fmt::format(" {}\\:\"{}\"", sub->get_name(), quoted(sub->get_description(), "\":\\"));
    cases += fmt::format("    {}) {}_{} ;;\n", sub->get_name(), name, sub->get_name());
    zsh_of(*sub, name + "_" + sub->get_name(), out);
  }
  out += body +
         fmt::format(" \\\n    '1:command:(({}))' \\\n    '*::arguments:->rest'\n  case $line[1] in\n{}  esac\n}}\n",
                     list.substr(1), cases);
}

std::string zsh_script(const CLI::App& app) {
  std::string out = "#compdef phasescan\n# zsh completion of phasescan, made by `phasescan completion zsh`\n";
  zsh_of(app, "_phasescan", out);
  return out + "_phasescan \"$@\"\n";
}

void fish_of(const CLI::App& command, const std::string& condition, std::string& out) {
  for (CLI::Option* option : options_of(command)) {
    for (const std::string& flag : option->get_lnames()) {
      const Value value = value_of(*option);
      std::string takes;
      if (option->get_items_expected_max() > 0) takes = value.file ? " -r -F" : " -x";
      if (!value.words.empty()) takes += " -a '" + quoted(fmt::format("{}", fmt::join(value.words, " ")), "\\") + "'";
      out += fmt::format("complete -c phasescan -n '{}' -l {}{} -d '{}'\n", condition, flag, takes,
                         quoted(option->get_description(), "\\"));
    }
  }
  for (const CLI::App* sub : shown_commands(command)) {
    out += fmt::format("complete -c phasescan -n '{}' -f -a {} -d '{}'\n", condition, sub->get_name(),
                       quoted(sub->get_description(), "\\"));
    fish_of(*sub, "__fish_seen_subcommand_from " + sub->get_name(), out);
  }
}

std::string fish_script(const CLI::App& app) {
  std::string out = "# fish completion of phasescan, made by `phasescan completion fish`\n";
  fish_of(app, "__fish_use_subcommand", out);
  return out;
}

}  // namespace

void add_completion_command(CLI::App& app, CommandBody& body) {
  auto* command = app.add_subcommand("completion", "the completion script of a shell")->group("");
  auto shell = std::make_shared<std::string>();
  command->add_option("SHELL", *shell, "bash, zsh or fish")->required()->check(one_of({"bash", "zsh", "fish"}));
  command->callback([shell, &app, &body] {
    body = [shell, &app] {
      print(*shell == "bash" ? bash_script(app) : *shell == "zsh" ? zsh_script(app) : fish_script(app));
      return kDone;
    };
  });
}

}  // namespace phasescan::app
