#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <csignal>
#include <new>
#include <sstream>
#include <stdexcept>

#include "command_list.hpp"
#include "commands.hpp"
#include "phasescan/io/error.hpp"
#include "io/file.hpp"

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

int run(int argc, char** argv) {
  CLI::App app{"phasescan: the motion between two lidar scans, with no first guess, and maps from it", "phasescan"};
  app.set_version_flag("--version", PHASESCAN_VERSION);
  app.require_subcommand(1);
  CommandBody body;
  for (const AddCommand add : kCommands) add(app, body);
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
      std::string names;
      for (const CLI::App* command : app.get_subcommands([](CLI::App*) { return true; }))
        names += (names.empty() ? "" : ", ") + command->get_name();
      return fail("unknown command " + quote_text(argv[1]) + "; expected one of " + names, kBadInput);
    }
    const std::string help = used.empty() ? "phasescan --help" : "phasescan " + used.front()->get_name() + " --help";
    return fail(std::string(error.what()) + "; expected what `" + help + "` says", kBadInput);
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
  const auto logger = spdlog::stderr_color_st("phasescan");
  logger->set_pattern("%n: %l: %v");
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
