// phasescan slam LOG --out DIR: a trajectory and a map from a log.
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <optional>

#include "command_list.hpp"
#include "commands.hpp"
#include "phasescan/core/time.hpp"
#include "phasescan/io/error.hpp"
#include "io/file.hpp"
#include "phasescan/io/measurement.hpp"
#include "io/odometry_source.hpp"
#include "slam_mcap.hpp"
#include "slam_output.hpp"

namespace phasescan::app {
namespace {

struct SlamFlags {
  CommonFlags common;
  std::string log, out, odometry = "auto", mcap;
  LogOptions options;
  int beam_step = 1;
};

double wall_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// Scans done and scans/s, on a terminal.
class ScanProgress {
 public:
  ~ScanProgress() {
    if (shown_ && written_) std::fputs("\r\033[K", stderr);
  }
  void step(std::size_t scans) {
    if (!shown_ || scans % 100 != 0) return;
    std::fprintf(stderr, "\rslam %zu scans, %.0f scans/s\033[K", scans,
                 static_cast<double>(scans) / std::max(1e-3, wall_seconds() - start_));
    written_ = true;
  }

 private:
  bool shown_ = ::isatty(STDERR_FILENO) == 1, written_ = false;
  double start_ = wall_seconds();
};

/// Reads to the end of the log or until the user stops it.
void feed(JudgedLog& log, Slam& slam, InputCheck& check, const SlamFlags& flags, SlamRun& run) {
  ScanProgress progress;
  while (!InterruptGuard::interrupted()) {
    std::optional<LogEntry> entry = log.next();
    if (!entry) return;
    if (slam.records().empty()) run.T_base_laser = entry->T_base_laser, run.flipped = entry->flipped;
    if (flags.beam_step > 1) entry->scan = reduce_scan(entry->scan, 0.0, flags.beam_step);
    const bool fresh =
        check.add(entry->scan, entry->laser, entry->odometry, flags.log + ":" + std::to_string(entry->line));
    RangeMeasurement measurement = to_measurement(std::move(*entry));
    if (!run.odometry_used) measurement.T_odom_base.reset();
    const double cpu = thread_cpu_seconds(), wall = wall_seconds();
    float overlap = 0.0F;
    if (fresh) {
      const TrackerStep step = slam.add(measurement);
      overlap = static_cast<float>(step.diagnostics.overlap);
      run.tracked += step.tracked();
      run.searched += step.diagnostics.wide_search;
      run.caught += step.diagnostics.full_search;
      run.new_segments += step.diagnostics.new_segment;
      run.usable += measurement.scan.hit_count() > 0;
    } else {
      slam.repeat(measurement);
      overlap = run.overlap.empty() ? 0.0F : run.overlap.back();
    }
    const double spent = thread_cpu_seconds() - cpu;
    run.cpu_ms.push_back(static_cast<float>(1e3 * spent));
    run.tracking_ms.push_back(static_cast<float>(1e3 * (spent - slam.last_backend_cpu_s())));
    run.wall_ms.push_back(static_cast<float>(1e3 * (wall_seconds() - wall)));
    run.overlap.push_back(overlap);
    progress.step(slam.records().size());
  }
  run.complete = false;
}

int run_slam(const SlamFlags& flags) {
  const double cpu = process_cpu_seconds(), wall = wall_seconds();
  const Config config = config_from(flags.common);
  SlamRun run;
  run.log = flags.log;
  run.times = !flags.common.no_times;
  run.glass_blocks = config.slam.glass.block;
  const std::unique_ptr<LogReader> reader = open_log(flags.log, flags.options);
  run.format = reader->format();
  run.odometry_used = flags.odometry != "none" && config.slam.odometry.use_wheels;
  if (!flags.mcap.empty() && !can_be_read_again(flags.log)) {
    throw InputError(flags.log, 0, "is a pipe; expected a file with --mcap, which reads the log a second time");
  }
  make_folder(flags.out);
  std::optional<McapWriter> mcap;  // opened before the work, so that a name that cannot be written costs no minutes
  if (!flags.mcap.empty()) mcap.emplace(flags.mcap);
  Slam slam(config.slam, flags.common.threads);
  InputCheck check;
  run.check = &check;
  const InterruptGuard guard;  // until the results are in place: what was finished is not lost
  JudgedLog log(*reader);
  feed(log, slam, check, flags, run);
  const OdometrySource source = log.source();
  run.odometry_assumed = flags.odometry == "none"              ? "not used, as asked for"
                         : source.usable && !run.odometry_used ? "not used: odometry.use_wheels is false"
                                                               : source.assumed;
  run.odometry_used = run.odometry_used && source.usable;
  if (slam.records().empty()) {
    if (InterruptGuard::interrupted()) return stopped_with_nothing();
    if (reader->damage_count() > 0) return fail_unreadable(*reader, flags.log);
    return fail_no_scan(*reader, flags.log);
  }
  if (!run.complete)
    warn("stopped after " + std::to_string(slam.records().size()) + " scans; the results are of these");
  slam.finish();
  if (run.complete && InterruptGuard::interrupted())
    warn("asked to stop after the last scan; the results are of the whole log");
  run.total_cpu_s = process_cpu_seconds() - cpu;
  run.total_wall_s = wall_seconds() - wall;
  for (const LogDamage& damage : reader->damages()) ++run.damages[damage.kind];
  if (reader->damage_count() > reader->damages().size())
    run.damages["further damage"] = reader->damage_count() - reader->damages().size();
  FileSet files = slam_output(flags.out, slam, run);
  if (mcap) write_slam_mcap(*mcap, flags.log, flags.options, slam, run.glass_blocks);
  files.commit();
  for (const auto& [kind, oddity] : check.oddities()) {
    warn(oddity.first + (oddity.count > 1 ? " (" + std::to_string(oddity.count) + " times: " + kind + ")" : ""));
  }
  if (const std::size_t left_out = slam.scans_left_out(); left_out > 0) {
    warn(flags.log + ": the map is in " + std::to_string(slam.backend().pieces().count) +
         " pieces that nothing ties; " + std::to_string(left_out) + " scans are not on it");
  }
  report_remarks(*reader, flags.log);
  const int code = report_damages(*reader, check.damaged() ? kDamagedInput : kDone);
  if (slam.backend().keyframes().empty()) {
    std::fprintf(stderr, "phasescan: %s: not one scan with enough returns to match\n", flags.log.c_str());
    return kAnswerIsNo;
  }
  return code;
}

}  // namespace

void add_slam_command(CLI::App& app, CommandBody& body) {
  auto* command = app.add_subcommand("slam", "a trajectory and a map from a log");
  auto flags = std::make_shared<SlamFlags>();
  command->add_option("LOG", flags->log, "log of any readable format")->required();
  command->add_option("--out", flags->out, "folder for trajectory, map, graph, report")->required()->type_name("DIR");
  command->add_option("--odometry", flags->odometry, "auto: wheel odometry where the log has any; none: scans alone")
      ->check(CLI::IsMember({"auto", "none"}))
      ->capture_default_str();
  command->add_option("--beam-step", flags->beam_step, "keep every K-th beam")
      ->check(CLI::Range(1, 10000))
      ->type_name("K");
  command->add_option("--mcap", flags->mcap, "write scans, frames, path and map for Foxglove or Lichtblick")
      ->check(not_empty());
  add_log_flags(*command, flags->options);
  add_to_flag(*command, flags->options);
  add_config_flag(*command, flags->common);
  add_threads_flag(*command, flags->common);
  add_no_times_flag(*command, flags->common);
  command->callback([flags, &body] { body = [flags] { return run_slam(*flags); }; });
}

}  // namespace phasescan::app
