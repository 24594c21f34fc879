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

#include "phasescan/core/pose2.hpp"
#include "phasescan/io/error.hpp"
#include "io/file.hpp"
#include "io/number.hpp"
#include "sim/lidar.hpp"
#include "sim/pairs_spec.hpp"

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

namespace {

/// "FROM:TO" in degrees.
void add_masks(const std::vector<std::string>& texts, LogOptions& options) {
  for (const std::string& text : texts) {
    const std::size_t colon = text.find(':');
    const auto from = parse_number<double>(std::string_view(text).substr(0, colon));
    const auto to =
        colon == std::string::npos ? std::nullopt : parse_number<double>(std::string_view(text).substr(colon + 1));
    if (!from || !to || !(std::abs(*from) <= 720.0) || !(std::abs(*to) <= 720.0)) {
      throw CLI::ValidationError("--mask", quote_text(text) + " is no sector; expected FROM:TO in degrees");
    }
    options.masks.push_back({deg_to_rad(*from), deg_to_rad(*to)});
  }
}

}  // namespace

void add_config_flag(CLI::App& command, CommonFlags& flags) {
  command.add_option("--config", flags.config, "YAML file with options (see `phasescan config --dump`)")
      ->type_name("FILE.yaml")
      ->check(not_empty());
}

void add_log_flags(CLI::App& command, LogOptions& options) {
  const auto degrees = [&command](const char* name, std::optional<double>& radians, const char* what, double least,
                                  double most) {
    command
        .add_option_function<double>(
            name, [&radians](double value) { radians = deg_to_rad(value); }, what)
        ->type_name("DEG")
        ->check(CLI::Range(least, most));
  };
  const auto metres = [&command](const char* name, double& value, const char* what) {
    command.add_option(name, value, what)->type_name("M")->check(number_above_zero());
  };
  const auto seconds = [&command](const char* name, std::optional<double>& value, const char* what) {
    command.add_option(name, value, what)->type_name("S")->check(number_from_zero());
  };
  command.add_option("--topic", options.topic, "ROS logs: only this scan topic");
  command.add_option("--frame", options.frame, "ROS logs: only scans with this frame_id");
  command.add_option("--columns", options.columns,
                     "text logs without a header: names of the columns, e.g. angle_deg,range_mm");
  degrees("--fov", options.beams.field_of_view, "text logs: from the first beam to the last; 360 is a full turn", 1e-3,
          360.0);
  degrees("--angle-min", options.beams.angle_min, "text logs: direction of the first beam", -720.0, 720.0);
  degrees("--angle-increment", options.beams.angle_increment, "text logs: between two beams, a size", 1e-4, 180.0);
  command.add_flag("--clockwise", options.beams.clockwise, "text logs: beams turn clockwise");
  command.add_option("--stamp-unit", options.stamp_unit, "text logs: unit of the stamps")
      ->check(one_of({"s", "ms", "us", "ns"}));
  command
      .add_option_function<std::vector<std::string>>(
          "--mask", [&options](const std::vector<std::string>& texts) { add_masks(texts, options); },
          "leave out beams in these directions of the laser, counter-clockwise; may be repeated")
      ->type_name("FROM:TO")
      ->allow_extra_args(false);
  metres("--range-min", options.range_min, "nearer hits count as too near");
  metres("--range-max", options.range_max, "farther hits count as out of range: a cheaper sensor");
  seconds("--from", options.from, "scans from this time after the first one on");
}

void add_reading_flags(CLI::App& command, std::string& odometry, int& beam_step) {
  command.add_option("--odometry", odometry, "auto: wheel odometry where the log has any; none: scans alone")
      ->check(one_of({"auto", "none"}))
      ->capture_default_str();
  command.add_option("--beam-step", beam_step, "keep every K-th beam")->check(CLI::Range(1, 10000))->type_name("K");
}

void add_to_flag(CLI::App& command, LogOptions& options, const std::vector<std::string>& names, std::string* name) {
  const auto take = [&options, names, name](const std::string& text) {
    const auto seconds = parse_number<double>(text);
    if (std::find(names.begin(), names.end(), text) != names.end()) {
      *name = text;
    } else if (seconds && *seconds >= 0.0 && std::isfinite(*seconds)) {
      options.to = *seconds;
    } else {
      throw CLI::ValidationError("--to", quote_text(text) + " is no number from 0 on");
    }
  };
  command.add_option_function<std::string>("--to", take, "scans up to this time after the first one")->type_name("S");
}

void add_sensor_flag(CLI::App& command, CommonFlags& flags) {
  command
      .add_option(
          "--sensor", flags.sensor,
          "the sensor that made the scans: a name of `simulate --help` or a file of `calibrate`; says by how much "
          "whole revolutions turn, which widens covariances")
      ->check(not_empty());
}

void add_method_flags(CLI::App& command, CommonFlags& flags) {
  command.add_option("--method", flags.method, "icp, ndt, fft, fft-icp1, fft-icp2 or global")
      ->type_name("NAME")
      ->check(not_empty())
      ->check(offers(enum_names<MatchMethod>()));
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
  if (!flags.sensor.empty()) {
    const double turn_deg = rad_to_deg(sim::revolution_turn_sigma(sim::read_lidar(flags.sensor)));
    for (double* option : {&config.match.match.general.revolution_turn_deg,
                           &config.slam.match.match.revolution_turn_deg, &config.localize.revolution_turn_deg})
      if (*option < 0.0) *option = turn_deg;
  }
  if (!flags.method.empty()) config.match.match.method = enum_of_flag<MatchMethod>("--method", flags.method);
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

void report_remarks(const LogReader& reader, const std::string& log) {
  for (const LogRemark& remark : reader.remarks()) warn(log + ": " + remark.text);
}

int fail_no_scan(const LogReader& reader, const std::string& log, const std::string& note) {
  std::string reason = "holds no scan; expected at least one";
  for (const LogRemark& remark : reader.remarks()) {
    if (remark.kind == "no scans" || remark.kind == "tilted laser") reason = "holds no scan: " + remark.text;
  }
  return fail(InputError(log, 0, reason + note).what(), kAnswerIsNo);
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
