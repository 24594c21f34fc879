// What the sub-commands share: common flags, configuration, interruption, messages. command_list.hpp lists them.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "config/config.hpp"
#include "phasescan/io/log.hpp"
#include "io/nearest_word.hpp"
#include "progress.hpp"
#include "words.hpp"

namespace phasescan::app {

/// Exit codes (README: exit codes).
enum ExitCode {
  kDone = 0,
  kAnswerIsNo = 1,
  kBadInput = 2,
  kSystemFailure = 3,
  kDamagedInput = 4,
  kStopped = 128,  ///< + the signal, as shells count: 130 after Ctrl-C, 143 after SIGTERM
};

/// What a command does once the flags are read; gives the exit code.
using CommandBody = std::function<int()>;
using AddCommand = void (*)(CLI::App& app, CommandBody& body);

/// Flags that more than one command has. Add those that apply with the functions below.
struct CommonFlags {
  std::string config;  ///< --config FILE.yaml
  std::string sensor;  ///< --sensor NAME|FILE.yaml
  std::string method;  ///< --method NAME (bench: comma-separated)
  bool fast = false;
  bool no_times = false;
  int threads = 1;
  std::uint64_t seed = 1;
};
void add_config_flag(CLI::App& command, CommonFlags& flags);
/// --sensor: what is known of the sensor that made the scans.
void add_sensor_flag(CLI::App& command, CommonFlags& flags);
void add_method_flags(CLI::App& command, CommonFlags& flags);
void add_threads_flag(CLI::App& command, CommonFlags& flags, int default_threads = 1);
void add_seed_flag(CLI::App& command, CommonFlags& flags);
void add_no_times_flag(CLI::App& command, CommonFlags& flags);
/// What of a log is read (topic, frame, part of its time, ranges, directions), and what a text does not say itself.
void add_log_flags(CLI::App& command, LogOptions& options);

/// --odometry auto|none and --beam-step K: what `slam` and `localize` take of what is read.
void add_reading_flags(CLI::App& command, std::string& odometry, int& beam_step);

/// --to S, which add_log_flags leaves out. Of convert it may be one of the `names` as well, which becomes `name`: the
/// flag had that meaning once.
void add_to_flag(CLI::App& command, LogOptions& options, const std::vector<std::string>& names = {},
                 std::string* name = nullptr);

/// Checks of a flag's text, before it is read as a number: what CLI11 would wrap, cut off or let pass (-1 and 2^64 as
/// unsigned numbers, NaN as positive) is refused in one short line.
CLI::Validator whole_number_from(std::uint64_t least);
CLI::Validator number_above_zero();
CLI::Validator number_from_zero();
/// Something rather than nothing: `--config "$UNSET"` is a mistake, not the default.
CLI::Validator not_empty();

/// Defaults, then --config, then --sensor (what the file leaves open), then --method (if it names one) and --fast.
/// @throws InputError, std::invalid_argument
Config config_from(const CommonFlags& flags);

/// The value of an enum by its name, as a flag says it. @throws std::invalid_argument naming the flag, the choices and
/// the nearest one.
template <class E>
E enum_of_flag(const std::string& flag, const std::string& text);

/// Numbers of a comma-separated flag such as --guess. @throws std::invalid_argument naming the flag and what was
/// expected.
std::vector<double> parse_numbers(const std::string& flag, const std::string& text, std::size_t count);

/// From here on Ctrl-C and SIGTERM end the process at once with kStopped + signal, and no temporary file stays; under
/// an InterruptGuard they only ask it to stop.
void handle_stop_signals();

/// Where a command has something to write when it is stopped: the first Ctrl-C or SIGTERM is told by `interrupted`, the
/// second one ends the process at once.
class InterruptGuard {
 public:
  InterruptGuard();
  ~InterruptGuard();
  InterruptGuard(const InterruptGuard&) = delete;
  InterruptGuard& operator=(const InterruptGuard&) = delete;
  /// Whether the user asked to stop.
  static bool interrupted();
  /// The exit code of a command: `code`, or that of the signal that it was stopped by.
  static int exit_code(int code);
};

/// The one line on stderr of a command that failed, "phasescan: REASON"; gives `code`.
int fail(std::string reason, int code);

/// For a command that was stopped before it had anything to write: says so, gives kDone (see
/// InterruptGuard::exit_code).
int stopped_with_nothing();

/// One warning line on stderr: "phasescan: warning: ...".
void warn(const std::string& text);

/// Prints each of a reader's damages as a warning; gives kDamagedInput if there are any, else `code`.
int report_damages(const LogReader& reader, int code);

/// Prints what the reader assumed or left out, a warning each.
void report_remarks(const LogReader& reader, const std::string& log);

/// The one line for a whole log without a scan; names its topics where it has others, and ends in `note`. Gives
/// kAnswerIsNo.
int fail_no_scan(const LogReader& reader, const std::string& log, const std::string& note = "");

/// The one line for a log that holds damage and not one scan: its first damage, and that there is nothing else. Gives
/// kBadInput.
int fail_unreadable(const LogReader& reader, const std::string& log);

/// Writes to standard output. @throws SystemError if it does not take it (disk full, pipe closed).
void print(std::string_view text);
/// Hands over what was printed so far. @throws as print
void flush();

template <class E>
E enum_of_flag(const std::string& flag, const std::string& text) {
  try {
    return enum_from_word<E>(text);
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(flag + ": " + error.what());
  }
}

}  // namespace phasescan::app
