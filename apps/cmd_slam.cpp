// phasescan slam LOG... --out DIR: a trajectory and a map from logs.
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <sstream>

#include "command_list.hpp"
#include "commands.hpp"
#include "phasescan/core/time.hpp"
#include "phasescan/io/error.hpp"
#include "in_the_way.hpp"
#include "io/file.hpp"
#include "people.hpp"
#include "phasescan/io/log.hpp"
#include "saved_run.hpp"
#include "slam_ending.hpp"
#include "slam_feed.hpp"
#include "slam_mcap.hpp"
#include "slam_output.hpp"

namespace phasescan::app {
namespace {

struct SlamFlags {
  CommonFlags common;
  std::vector<std::string> logs;
  std::string out, odometry = "auto", mcap, save, resume, extend;
  LogOptions options;
  int beam_step = 1;
  bool update = false;

  /// The state that is gone on from; empty: none.
  const std::string& from() const { return resume.empty() ? extend : resume; }
};

struct OpenLog {
  std::string name;
  std::unique_ptr<LogReader> reader;
};

double wall_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
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
void note_odometry(const SlamFlags& flags, const SlamOptions& options, SlamRun& run) {
  const bool asked = flags.odometry != "none" && options.odometry.use_wheels;
  run.odometry_assumed = flags.odometry == "none"      ? "not used, as asked for"
                         : run.source.usable && !asked ? "not used: odometry.use_wheels is false"
                                                       : run.source.assumed;
  run.odometry_used = asked && run.source.usable;
}

/// The run's time and its readers' damage, once all is done.
void note_end(double cpu, double wall, SlamRun& run) {
  run.total_cpu_s = process_cpu_seconds() - cpu;
  run.total_wall_s = wall_seconds() - wall;
  for (const SlamInput& input : run.inputs) {
    for (const auto& [kind, count] : input.damages) run.damages[kind] += count;
  }
}

/// What the logs say of frames and clocks: no verdict of the map alone knows of it.
void add_frame_reasons(const std::vector<OpenLog>& logs, SlamResult& result) {
  for (const OpenLog& log : logs) {
    for (const LogRemark& remark : log.reader->remarks()) {
      if (remark.kind == "several frames" || remark.kind == "tilted laser" ||
          remark.kind == "odometry of another clock")
        result.findings.push_back({"frames", 1, 0, remark.text, -1});
    }
  }
}

/// Warnings of a finished run, and its exit code.
int report_run(const std::vector<OpenLog>& logs, const SlamResult& result, const SlamFlags& flags, const SlamRun& run) {
  const bool damaged = warn_of_result(result, run, flags.out);
  int code = damaged || !run.damages.empty() ? kDamagedInput : kDone;
  for (const OpenLog& log : logs) {
    report_remarks(*log.reader, log.name);
    code = report_damages(*log.reader, code);
  }
  if (!result.keyframes.empty()) return report_verdict(result, run, code);
  std::fprintf(stderr, "phasescan: %s: not one scan with enough returns to match\n", run.log.c_str());
  return kAnswerIsNo;
}

/// What cuts the scans down: a run that goes on should read as it did before.
std::string reading_of(const SlamFlags& flags) {
  std::ostringstream text;
  text << "--odometry " << flags.odometry << " --beam-step " << flags.beam_step << " --range-min "
       << flags.options.range_min << " --range-max " << flags.options.range_max;
  for (const Sector& mask : flags.options.masks)
    text << " --mask " << rad_to_deg(mask.from) << ":" << rad_to_deg(mask.to);
  return text.str();
}

/// A run that is loaded, or a new one.
struct Begun {
  SlamOptions options;
  std::optional<SavedRun> saved;
  SlamRun run;
};

Begun begin(const SlamFlags& flags, const Config& config) {
  Begun begun{config.slam, std::nullopt, {}};
  if (!flags.from().empty()) {
    LoadedRun loaded = load_run(flags.from());
    begun.options = options_to_go_on(loaded.saved, flags.common.config, config.slam);
    begun.saved = std::move(loaded.saved);
    begun.run = std::move(loaded.run);
    if (flags.extend.empty() && begun.run.reading != reading_of(flags))
      warn(flags.from() + ": the saved run was read with " + begun.run.reading + ", and goes on with " +
           reading_of(flags));
  }
  begun.options.map.update = begun.options.map.update || flags.update;
  begun.run.reading = reading_of(flags);
  begun.run.times = !flags.common.no_times;
  begun.run.deskew_asked = begun.options.odometry.deskew;
  begun.run.glass_blocks = begun.options.glass.block;
  return begun;
}

int fail_without_scans(const std::vector<OpenLog>& logs, const SlamFlags& flags) {
  if (InterruptGuard::interrupted()) return stopped_with_nothing();
  const OpenLog& log = logs.front();
  if (log.reader->damage_count() > 0) return fail_unreadable(*log.reader, log.name);
  const bool older = std::filesystem::exists(flags.out + "/summary.json");
  return fail_no_scan(*log.reader, log.name, older ? "; " + flags.out + " holds the results of an earlier run" : "");
}

/// Last loops, the finished map, all files.
int finish(Slam& slam, const std::vector<OpenLog>& logs, const SlamFlags& flags, SlamRecording* recording, double cpu,
           double wall, SlamRun& run) {
  note_odometry(flags, slam.options(), run);
  if (!run.complete) warn("stopped after " + std::to_string(slam.scans()) + " scans; the results are of these");
  SlamResult result = slam.finish();
  add_frame_reasons(logs, result);
  if (run.complete && InterruptGuard::interrupted())
    warn("asked to stop after the last scan; the results are of the whole log");
  note_end(cpu, wall, run);
  FileSet files = slam_output(flags.out, result, run);
  if (recording != nullptr) recording->finish(result);
  write_parts(flags.out, result, run);
  files.commit();
  const int code = report_run(logs, result, flags, run);
  print_ending(slam_ending(result, run, flags.out));
  return code;
}

int run_slam(const SlamFlags& flags) {
  const double cpu = process_cpu_seconds(), wall = wall_seconds();
  const Config config = config_from(flags.common);
  warn_of_unread_sections(config, flags.common.config);
  Begun begun = begin(flags, config);
  SlamRun& run = begun.run;
  std::vector<OpenLog> logs;
  for (const std::string& log : flags.logs) logs.push_back({log, open_log(log, flags.options)});
  refuse_in_the_way("--mcap", flags.mcap, flags.logs, flags.out);
  refuse_in_the_way("--save", flags.save, flags.logs, flags.out);
  make_folder(flags.out);
  std::optional<SlamRecording> recording;  // opened before the work: a name that cannot be written costs no minutes
  if (!flags.mcap.empty()) recording.emplace(flags.mcap);
  SlamRecording* const recorder = recording ? &*recording : nullptr;
  std::optional<ThreadExecutor> executor;
  if (flags.common.threads > 1) executor.emplace();
  Executor* const beside = executor ? &*executor : nullptr;
  Slam slam = begun.saved ? Slam(begun.saved->state, begun.options, Schedule::kDeterministic, beside)
                          : Slam(begun.options, Schedule::kDeterministic, beside);
  begun.saved.reset();
  const InterruptGuard guard;  // until the results are in place: what was finished is not lost
  StateSaver saver(flags.save, begun.options.slam.autosave_s);
  FeedSettings settings;
  settings.first = flags.extend.empty() ? Joining::kGoesOn : Joining::kNewDrive;
  settings.use_odometry = flags.odometry != "none" && begun.options.odometry.use_wheels;
  settings.beam_step = flags.beam_step;
  settings.session_gap_s = begun.options.slam.session_gap_s;
  SlamFeed feed(slam, run, saver, recorder, settings);
  for (OpenLog& log : logs) run.complete = run.complete && feed.read(*log.reader, log.name);
  if (slam.scans() == 0) return fail_without_scans(logs, flags);
  saver.save(slam, run);
  return finish(slam, logs, flags, recorder, cpu, wall, run);
}

}  // namespace

void add_slam_command(CLI::App& app, CommandBody& body) {
  auto* command = app.add_subcommand("slam", "a trajectory and a map from one log or several");
  auto flags = std::make_shared<SlamFlags>();
  command->add_option("LOG", flags->logs, "logs of any readable format, in order of time")->required();
  command->add_option("--out", flags->out, "folder for trajectory, map, graph, report")->required()->type_name("DIR");
  add_reading_flags(*command, flags->odometry, flags->beam_step);
  command->add_option("--mcap", flags->mcap, "write scans, frames, path and map for Foxglove or Lichtblick")
      ->check(not_empty());
  command->add_option("--save", flags->save, "keep the run as it is before its last pass, to go on from")
      ->type_name("STATE")
      ->check(not_empty());
  auto* resume =
      command->add_option("--resume", flags->resume, "go on from a saved run: the log goes on where it ended")
          ->type_name("STATE")
          ->check(not_empty());
  command->add_option("--extend", flags->extend, "add another drive to a saved run, tied to it with no guess")
      ->type_name("STATE")
      ->check(not_empty())
      ->excludes(resume);
  command->add_flag("--update", flags->update, "where a later drive looked, what earlier ones saw fades (map.update)");
  command->footer(
      "Example:\n  phasescan slam drive.jsonl --out map --save drive.state\n"
      "  phasescan slam next-day.jsonl --extend drive.state --out both");
  add_log_flags(*command, flags->options);
  add_to_flag(*command, flags->options);
  add_config_flag(*command, flags->common);
  add_sensor_flag(*command, flags->common);
  add_threads_flag(*command, flags->common);
  add_no_times_flag(*command, flags->common);
  command->callback([flags, &body] { body = [flags] { return run_slam(*flags); }; });
}

}  // namespace phasescan::app
