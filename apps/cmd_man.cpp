// phasescan man [COMMAND]: a manual page, from the commands' own definitions.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <memory>

#include "command_list.hpp"
#include "commands.hpp"
#include "io/file.hpp"

namespace phasescan::app {
namespace {

/// Text as roff takes it: backslashes and hyphens as they stand, no line that begins with a control character.
std::string roff(const std::string& text) {
  std::string out;
  bool line_start = true;
  for (const char c : text) {
    if (line_start && (c == '.' || c == '\'')) out += "\\&";
    if (c == '\\') {
      out += "\\e";
    } else if (c == '-') {
      out += "\\-";
    } else {
      out += c;
    }
    line_start = c == '\n';
  }
  return out;
}

std::string name_of(const CLI::Option& option) {
  std::string text;
  for (const std::string& name : option.get_snames()) text += (text.empty() ? "\\-" : ", \\-") + roff(name);
  for (const std::string& name : option.get_lnames()) text += (text.empty() ? "\\-\\-" : ", \\-\\-") + roff(name);
  return text.empty() ? roff(option.get_name()) : text;
}

std::string options_text(const CLI::App& command) {
  std::string text;
  for (const CLI::Option* option : command.get_options()) {
    text += fmt::format(".TP\n\\fB{}\\fR", name_of(*option));
    if (option->get_items_expected_max() > 0 && !option->get_positional())
      text += fmt::format(" \\fI{}\\fR", roff(option->get_type_name()));
    text += "\n" + roff(option->get_description());
    if (!option->get_default_str().empty()) text += fmt::format(" (default {})", roff(option->get_default_str()));
    text += "\n";
  }
  return text;
}

std::string synopsis(const CLI::App& command, const std::string& name) {
  std::string text = fmt::format("\\fB{}\\fR", roff(name));
  for (const CLI::Option* option : command.get_options()) {
    if (option->get_positional()) text += fmt::format(" \\fI{}\\fR", roff(option->get_name()));
    if (!option->get_positional() && option->get_required())
      text += fmt::format(" {} \\fI{}\\fR", name_of(*option), roff(option->get_type_name()));
  }
  return text + " [\\fIoptions\\fR]\n";
}

/// The example of `--help`, its heading left out.
std::string example_of(const CLI::App& command) {
  const std::string footer = command.get_footer();
  const std::size_t line = footer.find('\n');
  return line == std::string::npos ? "" : roff(footer.substr(line + 1));
}

constexpr const char* kExitCodes = R"(.SH EXIT STATUS
.IP 0
done
.IP 1
it ran, and the answer is no
.IP 2
wrong usage or bad input: one line says what and where
.IP 3
the system said no (disk full, permission)
.IP 4
done, but the input was damaged
.IP "130, 143"
stopped by Ctrl\-C or SIGTERM; what was finished is written
)";

std::string page(const CLI::App& command, const std::string& name, bool root) {
  std::string title;
  for (const char c : name) title += c == ' ' ? '-' : static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  std::string hyphened = name;
  for (char& c : hyphened) c = c == ' ' ? '-' : c;
  std::string description = command.get_description();
  if (root) description = description.substr(description.find(": ") + 2);
  std::string text = fmt::format(".TH \"{}\" 1 \"\" \"phasescan {}\" \"User Commands\"\n.SH NAME\n{} \\- {}\n",
                                 roff(title), PHASESCAN_VERSION, roff(hyphened), roff(description));
  text += ".SH SYNOPSIS\n";
  if (root)
    text += "\\fBphasescan\\fR \\fICOMMAND\\fR [\\fIoptions\\fR]\n";
  else
    text += synopsis(command, name);
  const auto below = command.get_subcommands([](const CLI::App* sub) { return !sub->get_group().empty(); });
  text += ".SH OPTIONS\n" + options_text(command);
  if (!below.empty()) text += ".SH COMMANDS\n";
  for (const CLI::App* sub : below) {
    text += fmt::format(".SS {}\n{}\n", roff(sub->get_name()), roff(sub->get_description()));
    if (root)
      text += fmt::format(".br\nSee \\fBphasescan\\-{}\\fR(1).\n", roff(sub->get_name()));
    else
      text += options_text(*sub);
  }
  if (const std::string example = example_of(command); !example.empty())
    text += ".SH EXAMPLE\n.nf\n" + example + "\n.fi\n";
  text += kExitCodes;
  if (!root) text += ".SH SEE ALSO\n\\fBphasescan\\fR(1)\n";
  return text;
}

}  // namespace

void add_man_command(CLI::App& app, CommandBody& body) {
  auto* command = app.add_subcommand("man", "a manual page: of all, or of one command")->group("");
  auto name = std::make_shared<std::string>();
  command->add_option("COMMAND", *name, "a command; without: phasescan itself");
  command->callback([name, &app, &body] {
    body = [name, &app] {
      if (name->empty()) {
        print(page(app, "phasescan", true));
        return kDone;
      }
      const std::vector<std::string> commands = commands_of(app);
      if (std::find(commands.begin(), commands.end(), *name) == commands.end()) {
        throw std::invalid_argument("unknown command " + quote_text(*name) +
                                    did_you_mean(*name, std::span<const std::string>(commands)));
      }
      print(page(*app.get_subcommand(*name), "phasescan " + *name, false));
      return kDone;
    };
  });
}

}  // namespace phasescan::app
