#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <unistd.h>

#include <csignal>
#include <new>
#include <sstream>
#include <stdexcept>

#include "command_list.hpp"
#include "commands.hpp"
#include "phasescan/io/error.hpp"
#include "io/file.hpp"
#include "people.hpp"

namespace phasescan::app {
namespace {

/// A flag that swallowed the next one, as in `--out $UNSET --no-times`, is a mistake, not a folder of that name.
void refuse_flags_as_values(const CLI::App& command) {
  for (const CLI::Option* option : command.get_options()) {
    for (const std::string& value : option->results()) {
      if (value.starts_with("--") && command.get_option_no_throw(value) != nullptr)
        throw std::invalid_argument(option->get_name() + ": has no value before " + value + "; expected one");
    }
  }
  for (const CLI::App* sub : command.get_subcommands()) refuse_flags_as_values(*sub);
}

/// For the first word that no command took: the flag or sub-command that may have been meant.
std::string meant(const CLI::App& app) {
  const CLI::App* command = &app;
  while (!command->get_subcommands().empty()) command = command->get_subcommands().front();
  for (const std::string& word : app.remaining(true)) {
    const std::vector<std::string> words = word.starts_with("-") ? flags_of(*command) : commands_of(*command);
    const std::string near = did_you_mean(word.substr(0, word.find('=')), std::span<const std::string>(words));
    if (!near.empty()) return near;
  }
  return "";
}

int run(int argc, char** argv) {
  CLI::App app{"phasescan: the motion between two lidar scans, with no first guess, and maps from it", "phasescan"};
  app.set_version_flag("--version", PHASESCAN_VERSION);
  app.require_subcommand(1);
  CommandBody body;
  for (const AddCommand add : kCommands) add(app, body);
  // Commands take over the footer that stands when they are added.
  app.footer("Example:\n  phasescan simulate --world flat --out drive.jsonl && phasescan slam drive.jsonl --out map");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) {  // --help, --version
      std::ostringstream text;
      app.exit(error, text);
      print(text.str());
      flush();
      return kDone;
    }
    const auto used = app.get_subcommands();
    if (used.empty() && argc > 1 && argv[1][0] != '-') {
      const std::vector<std::string> commands = commands_of(app);
      std::string names;
      for (const std::string& name : commands) names += (names.empty() ? "" : ", ") + name;
      return fail("unknown command " + quote_text(argv[1]) + "; expected one of " + names +
                      did_you_mean(argv[1], std::span<const std::string>(commands)),
                  kBadInput);
    }
    const std::string help = used.empty() ? "phasescan --help" : "phasescan " + used.front()->get_name() + " --help";
    return fail(std::string(error.what()) + "; expected what `" + help + "` says" + meant(app), kBadInput);
  }
  refuse_flags_as_values(app);
  const int code = body();
  flush();
  return InterruptGuard::exit_code(code);
}

}  // namespace
}  // namespace phasescan::app

int main(int argc, char** argv) {
  using namespace phasescan;
  std::signal(SIGXFSZ, SIG_IGN);  // a file beyond the limit (ulimit -f) is a write that fails, like a full disk
  app::handle_stop_signals();
  const auto logger = spdlog::stderr_color_st(
      "phasescan", app::has_colors(STDERR_FILENO) ? spdlog::color_mode::always : spdlog::color_mode::never);
  logger->set_pattern("%n: %^%l%$: %v");
  spdlog::set_default_logger(logger);
  try {
    return app::run(argc, argv);
  } catch (const SystemError& error) {
    return app::fail(error.what(), app::kSystemFailure);
  } catch (const InputError& error) {
    return app::fail(error.what(), app::kBadInput);
  } catch (const std::invalid_argument& error) {
    return app::fail(error.what(), app::kBadInput);
  } catch (const std::bad_alloc&) {
    return app::fail("out of memory", app::kSystemFailure);
  } catch (const std::exception& error) {
    return app::fail(std::string("unexpected failure: ") + error.what(), app::kSystemFailure);
  }
}
