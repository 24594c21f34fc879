#include "commands.hpp"

#include <spdlog/spdlog.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <utility>

#include "phasescan/io/error.hpp"
#include "io/file.hpp"
#include "io/number.hpp"

namespace phasescan::app {
namespace {

std::atomic<int> stop_signal{0}, guards{0};
static_assert(std::atomic<int>::is_always_lock_free);

extern "C" void stop(int signal_number) {
  if (stop_signal.exchange(signal_number) == 0 && guards > 0) return;
  drop_unfinished_files();
  ::_exit(kStopped + signal_number);
}

[[noreturn]] void refuse_output() {
  throw SystemError("standard output", std::string("cannot be written: ") + std::strerror(errno));
}

}  // namespace

void add_config_flag(CLI::App& command, CommonFlags& flags) {
  command.add_option("--config", flags.config, "YAML file with options (see `phasescan config --dump`)")
      ->type_name("FILE.yaml")
      ->check(not_empty());
}

void add_log_flags(CLI::App& command, LogOptions& options) {
  command.add_option("--topic", options.topic, "ROS logs: only this scan topic");
  command.add_option("--columns", options.columns,
                     "text logs without a header: names of the columns, e.g. angle_deg,range_mm");
}

void add_method_flags(CLI::App& command, CommonFlags& flags) {
  command.add_option("--method", flags.method, "icp, ndt, fft, fft-icp1, fft-icp2 or global")
      ->type_name("NAME")
      ->check(not_empty());
  command.add_flag("--fast", flags.fast, "trade a little robustness for time (global)");
}

void add_threads_flag(CLI::App& command, CommonFlags& flags, int default_threads) {
  flags.threads = default_threads;
  command.add_option("--threads", flags.threads, "threads; the answers are the same for any number")
      ->type_name("N")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
}

void add_seed_flag(CLI::App& command, CommonFlags& flags) {
  command.add_option("--seed", flags.seed, "seed where chance is involved")
      ->type_name("N")
      ->check(whole_number_from(0))
      ->capture_default_str();
}

void add_no_times_flag(CLI::App& command, CommonFlags& flags) {
  command.add_flag("--no-times", flags.no_times, "leave times out: same input, same bytes");
}

CLI::Validator whole_number_from(std::uint64_t least) {
  return {[least](std::string& text) {
            const auto number = parse_number<std::uint64_t>(text);
            return number && *number >= least
                       ? std::string()
                       : quote_text(text) + " is no whole number from " + std::to_string(least) + " to 2^64 - 1";
          },
          ""};
}

CLI::Validator number_above_zero() {
  return {[](std::string& text) {
            const auto number = parse_number<double>(text);
            return number && *number > 0.0 && std::isfinite(*number) ? std::string()
                                                                     : quote_text(text) + " is no number above 0";
          },
          ""};
}

CLI::Validator number_from_zero() {
  return {[](std::string& text) {
            const auto number = parse_number<double>(text);
            return number && *number >= 0.0 && std::isfinite(*number) ? std::string()
                                                                      : quote_text(text) + " is no number from 0 on";
          },
          ""};
}

CLI::Validator not_empty() {
  return {[](std::string& text) { return text.empty() ? std::string("is empty") : std::string(); }, ""};
}

Config config_from(const CommonFlags& flags) {
  Config config = flags.config.empty() ? Config{} : load_config(flags.config);
  if (!flags.method.empty()) {
    try {
      config.match.match.method = enum_from_string<MatchMethod>(flags.method);
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument(std::string("--method: ") + error.what());
    }
  }
  if (flags.fast) config.match.match.general.fast = true;
  return config;
}

std::vector<double> parse_numbers(const std::string& flag, const std::string& text, std::size_t count) {
  std::vector<double> numbers;
  for (std::size_t from = 0; from <= text.size();) {
    const std::size_t comma = std::min(text.find(',', from), text.size());
    const auto number = parse_number<double>(std::string_view(text).substr(from, comma - from));
    if (!number || !(std::abs(*number) < 1e9)) numbers.resize(count + 1);
    if (numbers.size() > count) break;
    numbers.push_back(*number);
    from = comma + 1;
  }
  if (numbers.size() != count) {
    throw std::invalid_argument(flag + ": " + quote_text(text) + " is not " + std::to_string(count) +
                                " numbers; expected them separated by commas");
  }
  return numbers;
}

void handle_stop_signals() {
  std::signal(SIGINT, stop);
  std::signal(SIGTERM, stop);
}

InterruptGuard::InterruptGuard() {
  ++guards;
}
InterruptGuard::~InterruptGuard() {
  --guards;
}
bool InterruptGuard::interrupted() {
  return stop_signal != 0;
}
int InterruptGuard::exit_code(int code) {
  return interrupted() ? kStopped + stop_signal : code;
}

Progress::Progress(std::string what, std::size_t total)
    : what_(std::move(what)), total_(total), shown_(::isatty(STDERR_FILENO) == 1) {}

Progress::~Progress() {
  if (shown_ && last_percent_ >= 0) std::fputs("\r\033[K", stderr);
}

void Progress::step(std::size_t done) {
  if (!shown_) return;
  const int percent =
      total_ > 0 ? static_cast<int>(100 * std::min(done, total_) / total_) : static_cast<int>(done / 50 % 1'000'000);
  if (percent == last_percent_) return;
  last_percent_ = percent;
  if (total_ == 0) {
    std::fprintf(stderr, "\r%s %zu\033[K", what_.c_str(), done);
  } else {
    const int bars = percent * 30 / 100;
    std::fprintf(stderr, "\r%s [%-30s] %3d %%\033[K", what_.c_str(),
                 std::string(static_cast<std::size_t>(bars), '#').c_str(), percent);
  }
  std::fflush(stderr);
}

int fail(std::string reason, int code) {
  for (char& c : reason) {  // one line, whatever the reason holds
    if (c == '\n' || c == '\r') c = ' ';
  }
  std::fflush(stdout);
  std::fprintf(stderr, "phasescan: %s\n", reason.c_str());
  return code;
}

int stopped_with_nothing() {
  warn("stopped before there was anything to write; nothing is written");
  return kDone;
}

void warn(const std::string& text) {
  spdlog::warn("{}", text);
}

int report_damages(const LogReader& reader, int code) {
  for (const LogDamage& damage : reader.damages()) warn(damage.text);
  const std::size_t untold = reader.damage_count() - reader.damages().size();
  if (untold > 0) warn("and " + std::to_string(untold) + " more places like these");
  return reader.damage_count() > 0 ? kDamagedInput : code;
}

int fail_unreadable(const LogReader& reader, const std::string& log) {
  std::string reason =
      reader.damages().empty() ? InputError(log, 0, "is damaged").what() : reader.damages().front().text;
  reason += "; nothing in it could be read";
  if (reader.damage_count() > 1)
    reason += ", " + std::to_string(reader.damage_count() - 1) + " more places are damaged";
  return fail(reason, kBadInput);
}

void print(std::string_view text) {
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size()) refuse_output();
}

void flush() {
  if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) refuse_output();
}

}  // namespace phasescan::app
