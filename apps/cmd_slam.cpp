// phasescan slam LOG --out DIR: a trajectory and a map from a log.
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <map>
#include <optional>
#include <set>

#include "command_list.hpp"
#include "commands.hpp"
#include "phasescan/core/time.hpp"
#include "phasescan/io/error.hpp"
#include "io/file.hpp"
#include "people.hpp"
#include "phasescan/io/log.hpp"
#include "io/odometry_source.hpp"
#include "slam_ending.hpp"
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

/// Keeps where each kind of oddity was first seen.
class FirstSeen final : public SlamObserver {
 public:
  FirstSeen(const std::string& log, std::map<std::string, std::string>& out) : log_(log), out_(out) {}
  /// Of the next scan.
  void add_line(long line) { lines_.push_back(line); }
  void on_warning(ScanId scan, const std::string& kind, const std::string& what, bool) override {
    out_.emplace(kind, log_ + ":" + std::to_string(lines_.at(static_cast<std::size_t>(scan))) + ": " + what);
  }

 private:
  const std::string& log_;
  std::map<std::string, std::string>& out_;
  std::vector<long> lines_;  // of each scan
};

void count(const ScanUpdate& update, bool usable, SlamRun& run) {
  const TrackingDiagnostics& d = update.diagnostics;
  if (update.repeated) {
    run.overlap.push_back(run.overlap.empty() ? 0.0F : run.overlap.back());
    return;
  }
  run.overlap.push_back(static_cast<float>(d.overlap));
  run.tracked += is_tracked(update.status);
  run.searched += d.wide_search;
  run.caught += d.full_search;
  run.new_segments += d.new_segment;
  run.usable += usable;
}

/// Reads to the end of the log or until the user stops it.
void feed(JudgedLog& log, const LogReader& reader, Slam& slam, SlamRecording* recording, const SlamFlags& flags,
          SlamRun& run) {
  Progress progress("slam", reader);
  FirstSeen first_seen(flags.log, run.first_seen);
  slam.set_observer(&first_seen);
  while (!InterruptGuard::interrupted()) {
    std::optional<LogEntry> entry = log.next();
    if (!entry) return slam.set_observer(nullptr);
    if (slam.scans() == 0) run.T_base_laser = entry->T_base_laser, run.flipped = entry->flipped;
    if (flags.beam_step > 1) entry->scan = reduce_scan(entry->scan, 0.0, flags.beam_step);
    if (recording != nullptr) recording->add(*entry);
    first_seen.add_line(entry->line);
    RangeMeasurement measurement = to_measurement(std::move(*entry));
    if (!run.odometry_used) measurement.T_odom_base.reset();
    const double cpu = thread_cpu_seconds(), wall = wall_seconds();
    const ScanUpdate update = slam.add(measurement);
    const double spent = thread_cpu_seconds() - cpu;
    run.shown.add(slam.scans() - 1, measurement.scan, measurement.T_base_laser);
    count(update, measurement.scan.hit_count() > 0, run);
    run.cpu_ms.push_back(static_cast<float>(1e3 * spent));
    run.tracking_ms.push_back(static_cast<float>(1e3 * (spent - slam.last_backend_cpu_s())));
    run.wall_ms.push_back(static_cast<float>(1e3 * (wall_seconds() - wall)));
    progress.step(slam.scans());
  }
  slam.set_observer(nullptr);
  run.complete = false;
}

/// Sections of the configuration that this command has no use for: said, not passed over.
void warn_of_unread_sections(const Config& config, const std::string& file) {
  std::set<std::string> read{"match", "global"};
  SlamOptions::visit_sections(config.slam, [&](std::string_view name, const auto&) { read.emplace(name); });
  for (const std::string& section : config.sections_set) {
    if (!read.contains(section)) warn(file + ": section " + quote_text(section) + " is not read by slam");
  }
}

/// What was assumed of the log's odometry, once it is read.
void note_odometry(const OdometrySource& source, const SlamFlags& flags, SlamRun& run) {
  run.odometry_assumed = flags.odometry == "none"              ? "not used, as asked for"
                         : source.usable && !run.odometry_used ? "not used: odometry.use_wheels is false"
                                                               : source.assumed;
  run.odometry_used = run.odometry_used && source.usable;
}

/// The run's time and the reader's damage, once all is done.
void note_end(const LogReader& reader, double cpu, double wall, SlamRun& run) {
  run.total_cpu_s = process_cpu_seconds() - cpu;
  run.total_wall_s = wall_seconds() - wall;
  for (const LogDamage& damage : reader.damages()) ++run.damages[damage.kind];
  if (reader.damage_count() > reader.damages().size())
    run.damages["further damage"] = reader.damage_count() - reader.damages().size();
}

/// Warnings of a finished run, and its exit code.
int report_run(const LogReader& reader, const SlamResult& result, const SlamFlags& flags, const SlamRun& run) {
  bool damaged = false;
  for (const auto& [kind, oddity] : result.oddities) {
    damaged |= oddity.damage;
    const std::string times = " (" + std::to_string(oddity.count) + " times: " + kind + ")";
    warn(run.first_seen.at(kind) + (oddity.count > 1 ? times : ""));
  }
  if (const std::size_t left_out = result.scans_off_the_map(); left_out > 0) {
    warn(flags.log + ": the map is in " + std::to_string(result.pieces) + " pieces that nothing ties; " +
         std::to_string(left_out) + " scans are not on it");
  }
  if (!result.deskewed && run.deskew_asked) {
    warn(flags.log +
         ": turns show that the beams of a scan are of one time, whatever time_increment says; motion is not "
         "taken out of the scans");
  }
  report_remarks(reader, flags.log);
  const int code = report_damages(reader, damaged ? kDamagedInput : kDone);
  if (!result.keyframes.empty()) return code;
  std::fprintf(stderr, "phasescan: %s: not one scan with enough returns to match\n", flags.log.c_str());
  return kAnswerIsNo;
}

/// A recording in the place of the log, or of one of the results, would destroy it.
void refuse_mcap_in_the_way(const SlamFlags& flags) {
  namespace fs = std::filesystem;
  if (flags.mcap.empty()) return;
  std::error_code ignored;
  if (fs::equivalent(flags.mcap, flags.log, ignored))
    throw std::invalid_argument("--mcap: " + quote_text(flags.mcap) + " is the log itself; expected another file");
  const fs::path mcap(flags.mcap);
  const fs::path folder = fs::weakly_canonical(mcap.has_parent_path() ? mcap.parent_path() : ".", ignored);
  if (folder != fs::weakly_canonical(flags.out, ignored)) return;
  for (const char* name : {"trajectory.tum", "scans.jsonl", "graph.g2o", "map.pgm", "map.yaml", "map.png",
                           "report.html", "timing.json", "summary.json"}) {
    if (mcap.filename() == name)
      throw std::invalid_argument("--mcap: " + quote_text(flags.mcap) + " is a file of --out; expected another name");
  }
}

int run_slam(const SlamFlags& flags) {
  const double cpu = process_cpu_seconds(), wall = wall_seconds();
  const Config config = config_from(flags.common);
  warn_of_unread_sections(config, flags.common.config);
  SlamRun run;
  run.log = flags.log;
  run.times = !flags.common.no_times;
  run.deskew_asked = config.slam.odometry.deskew;
  run.glass_blocks = config.slam.glass.block;
  const std::unique_ptr<LogReader> reader = open_log(flags.log, flags.options);
  run.format = reader->format();
  run.odometry_used = flags.odometry != "none" && config.slam.odometry.use_wheels;
  refuse_mcap_in_the_way(flags);
  make_folder(flags.out);
  std::optional<SlamRecording> recording;  // opened before the work: a name that cannot be written costs no minutes
  if (!flags.mcap.empty()) recording.emplace(flags.mcap);
  std::optional<ThreadExecutor> executor;
  if (flags.common.threads > 1) executor.emplace();
  Slam slam(config.slam, Schedule::kDeterministic, executor ? &*executor : nullptr);
  const InterruptGuard guard;  // until the results are in place: what was finished is not lost
  JudgedLog log(*reader, true);
  feed(log, *reader, slam, recording ? &*recording : nullptr, flags, run);
  note_odometry(log.source(), flags, run);
  if (slam.scans() == 0) {
    if (InterruptGuard::interrupted()) return stopped_with_nothing();
    if (reader->damage_count() > 0) return fail_unreadable(*reader, flags.log);
    const bool older = std::filesystem::exists(flags.out + "/summary.json");
    return fail_no_scan(*reader, flags.log, older ? "; " + flags.out + " holds the results of an earlier run" : "");
  }
  if (!run.complete) warn("stopped after " + std::to_string(slam.scans()) + " scans; the results are of these");
  const SlamResult result = slam.finish();
  if (run.complete && InterruptGuard::interrupted())
    warn("asked to stop after the last scan; the results are of the whole log");
  note_end(*reader, cpu, wall, run);
  FileSet files = slam_output(flags.out, result, run);
  if (recording) recording->finish(result);
  files.commit();
  const int code = report_run(*reader, result, flags, run);
  print_ending(slam_ending(result, run, flags.out));
  return code;
}

}  // namespace

void add_slam_command(CLI::App& app, CommandBody& body) {
  auto* command = app.add_subcommand("slam", "a trajectory and a map from a log");
  auto flags = std::make_shared<SlamFlags>();
  command->add_option("LOG", flags->log, "log of any readable format")->required();
  command->add_option("--out", flags->out, "folder for trajectory, map, graph, report")->required()->type_name("DIR");
  command->add_option("--odometry", flags->odometry, "auto: wheel odometry where the log has any; none: scans alone")
      ->check(one_of({"auto", "none"}))
      ->capture_default_str();
  command->add_option("--beam-step", flags->beam_step, "keep every K-th beam")
      ->check(CLI::Range(1, 10000))
      ->type_name("K");
  command->add_option("--mcap", flags->mcap, "write scans, frames, path and map for Foxglove or Lichtblick")
      ->check(not_empty());
  command->footer("Example:\n  phasescan slam drive.jsonl --out map");
  add_log_flags(*command, flags->options);
  add_to_flag(*command, flags->options);
  add_config_flag(*command, flags->common);
  add_threads_flag(*command, flags->common);
  add_no_times_flag(*command, flags->common);
  command->callback([flags, &body] { body = [flags] { return run_slam(*flags); }; });
}

}  // namespace phasescan::app
