// phasescan localize (--map map.yaml | --state STATE) LOG --out DIR: where a log's scans lie on a map that is known.
#include <filesystem>
#include <optional>
#include <set>
#include <stdexcept>

#include "command_list.hpp"
#include "commands.hpp"
#include "io/file.hpp"
#include "io/odometry_source.hpp"
#include "known_map.hpp"
#include "localize_output.hpp"
#include "phasescan/core/time.hpp"
#include "phasescan/io/error.hpp"
#include "phasescan/io/log.hpp"
#include "phasescan/localize/localizer.hpp"

namespace phasescan::app {
namespace {

struct LocalizeFlags {
  CommonFlags common;
  std::string log, out, map, state, initial, odometry = "auto";
  LogOptions options;
  int beam_step = 1;
  bool each = false, keep_prepared = false;
};

void warn_of_sections_not_read(const Config& config, const std::string& file) {
  const std::set<std::string> read{"localize", "odometry"};
  for (const std::string& section : config.sections_set) {
    if (!read.contains(section)) warn(file + ": section " + quote_text(section) + " is not read by localize");
  }
}

/// Scans one after the other, each by itself or followed.
class LocalizeFeed {
 public:
  LocalizeFeed(const LocalizeFlags& flags, const Config& config, const KnownMap& known, LocalizeRun& run)
      : flags_(flags), config_(config), known_(known), run_(run) {
    if (!flags.each) localizer_.emplace(known.map, config.localize, config.slam.odometry);
    if (!flags.initial.empty()) give_initial();
  }

  void read(LogReader& reader) {
    Progress progress("localize", reader);
    JudgedLog log(reader, true);
    while (!InterruptGuard::interrupted()) {
      std::optional<LogEntry> entry = log.next();
      if (!entry) {
        run_.complete = true;
        break;
      }
      run_.complete = false;
      add(std::move(*entry));
      progress.step(run_.updates.size());
    }
    note(log, reader);
  }

 private:
  void give_initial() {
    const std::vector<double> numbers = parse_numbers("--initial", flags_.initial, 3);
    const Pose2 pose{numbers[0], numbers[1], wrap_angle(deg_to_rad(numbers[2]))};
    // As good as a click into a map on a screen.
    constexpr double kM = 0.3, kRad = 0.15;
    if (localizer_) localizer_->initialize(pose, Eigen::Vector3d(kM * kM, kM * kM, kRad * kRad).asDiagonal());
  }

  void add(LogEntry entry) {
    if (flags_.beam_step > 1) entry.scan = reduce_scan(entry.scan, 0.0, flags_.beam_step);
    RangeMeasurement measurement = to_measurement(std::move(entry));
    if (flags_.odometry == "none" || !config_.slam.odometry.use_wheels) measurement.T_odom_base.reset();
    const double cpu = thread_cpu_seconds();
    LocalizationUpdate update =
        localizer_ ? localizer_->add(measurement) : locate(known_.map, measurement, config_.localize);
    run_.cpu_ms.push_back(static_cast<float>(1e3 * (thread_cpu_seconds() - cpu)));
    update.scan = static_cast<ScanId>(run_.updates.size());
    run_.updates.push_back(std::move(update));
  }

  void note(const JudgedLog& log, const LogReader& reader) {
    const OdometrySource source = log.source();
    const bool asked = flags_.odometry != "none" && config_.slam.odometry.use_wheels && !flags_.each;
    run_.odometry_assumed = flags_.odometry == "none" ? "not used, as asked for"
                            : flags_.each             ? "not used: every scan stands by itself"
                            : source.usable && !asked ? "not used: odometry.use_wheels is false"
                                                      : source.assumed;
    run_.odometry_used = asked && source.usable;
    for (const LogDamage& damage : reader.damages()) ++run_.damages[damage.kind];
    if (reader.damage_count() > reader.damages().size())
      run_.damages["further damage"] = reader.damage_count() - reader.damages().size();
  }

  const LocalizeFlags& flags_;
  const Config& config_;
  const KnownMap& known_;
  LocalizeRun& run_;
  std::optional<Localizer> localizer_;
};

void check_flags(const LocalizeFlags& flags) {
  if (flags.map.empty() == flags.state.empty())
    throw std::invalid_argument("expected one of --map map.yaml and --state STATE: the map that is known");
  if (flags.each && !flags.initial.empty())
    throw std::invalid_argument("--initial: every scan stands by itself with --each; expected one of them");
}

int run_localize(const LocalizeFlags& flags) {
  check_flags(flags);
  if (!flags.initial.empty()) static_cast<void>(parse_numbers("--initial", flags.initial, 3));
  const Config config = config_from(flags.common);
  warn_of_sections_not_read(config, flags.common.config);
  const std::unique_ptr<LogReader> reader = open_log(flags.log, flags.options);
  const double cpu = process_cpu_seconds();
  const KnownMap known = load_known_map(flags.map, flags.state, config.localize, flags.keep_prepared);
  LocalizeRun run;
  run.prepare_cpu_s = process_cpu_seconds() - cpu;
  run.log = flags.log;
  run.map_name = std::filesystem::path(flags.map.empty() ? flags.state : flags.map).filename().string();
  run.format = reader->format();
  run.each = flags.each;
  run.times = !flags.common.no_times;
  run.min_confidence = config.localize.min_confidence;
  if (flags.keep_prepared) run.map_was_kept = known.was_kept;
  run.free_area_m2 = known.map.free_area_m2();
  run.views = known.map.views();
  run.map_bytes = known.map.memory_bytes();
  make_folder(flags.out);
  const InterruptGuard guard;
  LocalizeFeed(flags, config, known, run).read(*reader);
  if (run.updates.empty()) {
    if (InterruptGuard::interrupted()) return stopped_with_nothing();
    return reader->damage_count() > 0 ? fail_unreadable(*reader, flags.log) : fail_no_scan(*reader, flags.log);
  }
  if (!run.complete) warn("stopped after " + std::to_string(run.updates.size()) + " scans; the results are of these");
  const LocalizeVerdict verdict = judge_run(run);
  localize_output(flags.out, known.drawn, run, verdict).commit();
  report_remarks(*reader, flags.log);
  int code = report_damages(*reader, kDone);
  print_ending(localize_ending(run, verdict, flags.out));
  const std::string strongest = verdict.reasons.empty() ? "" : ": " + verdict.reasons.front().what;
  if (verdict.word == "failed") return fail(flags.log + ": not localised" + strongest, kAnswerIsNo);
  if (verdict.word == "doubtful") warn(flags.log + ": doubtful" + strongest);
  return code;
}

}  // namespace

void add_localize_command(CLI::App& app, CommandBody& body) {
  auto* command = app.add_subcommand("localize", "where a log's scans lie on a map that is known, with no guess");
  auto flags = std::make_shared<LocalizeFlags>();
  command->add_option("LOG", flags->log, "a log of any readable format")->required();
  command->add_option("--out", flags->out, "folder for trajectory, statuses, report")->required()->type_name("DIR");
  command->add_option("--map", flags->map, "a map of map_server: yaml with its image")
      ->type_name("map.yaml")
      ->check(not_empty());
  command->add_option("--state", flags->state, "the map of a saved run of slam")
      ->type_name("STATE")
      ->check(not_empty());
  add_keep_prepared_flag(*command, flags->keep_prepared);
  command->add_flag("--each", flags->each, "every scan by itself: no motion between them");
  command->add_option("--initial", flags->initial, "where the first scan was taken, about")
      ->type_name("X,Y,THETA_DEG")
      ->check(not_empty());
  add_reading_flags(*command, flags->odometry, flags->beam_step);
  command->footer(
      "Example:\n  phasescan slam drive.jsonl --out map\n"
      "  phasescan localize --map map/map.yaml next-day.jsonl --out where");
  add_log_flags(*command, flags->options);
  add_to_flag(*command, flags->options);
  add_config_flag(*command, flags->common);
  add_sensor_flag(*command, flags->common);
  add_threads_flag(*command, flags->common);
  add_no_times_flag(*command, flags->common);
  command->callback([flags, &body] { body = [flags] { return run_localize(*flags); }; });
}

}  // namespace phasescan::app
