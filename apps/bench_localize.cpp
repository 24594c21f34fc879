// phasescan bench localize: single scans on maps that SLAM made, or cast on maps of others.
#include <fmt/format.h>

#include <optional>

#include "bench_localize_lines.hpp"
#include "command_list.hpp"
#include "commands.hpp"
#include "eval/localize_bench.hpp"
#include "eval/localize_places_file.hpp"
#include "eval/localize_runs.hpp"
#include "eval/localize_yardstick.hpp"
#include "io/file.hpp"
#include "output/map_file.hpp"
#include "phasescan/core/time.hpp"
#include "phasescan/io/error.hpp"

namespace phasescan::app {
namespace {

struct BenchLocalizeFlags {
  CommonFlags common;
  SimulatedPlacesSpec simulated;
  CastPlacesSpec cast;
  std::string map, cases, places, figure;
  bool yardstick = false, runs = false;
  LocalizeRunsSpec drives;
};

// About 20 s: an exhaustive search of a scan that says little is given up, and counted.
constexpr std::size_t kMostSteps = 20'000'000;

LocalizePlaces make_places(const BenchLocalizeFlags& flags) {
  if (!flags.places.empty() && has_places(flags.places)) return read_places(flags.places);
  if (!flags.map.empty()) {
    CastPlacesSpec spec = flags.cast;
    spec.poses = flags.simulated.poses;
    spec.seed = flags.common.seed;
    return cast_places(flags.map, read_map(flags.map), spec);
  }
  SimulatedPlacesSpec spec = flags.simulated;
  spec.seed = flags.common.seed;
  if (spec.worlds.empty()) spec.worlds = {"building:31"};
  Progress progress("worlds", spec.worlds.size());
  std::size_t done = 0;
  return simulated_places(spec, [&] { progress.step(++done); });
}

/// The exhaustive search on the same scans, as a part of the result's line.
std::string yardstick_part(const LocalizationMap& map, const std::vector<LocalizeCase>& cases,
                           const std::vector<LocalizeRow>& rows, const LocalizeOptions& options, bool no_times) {
  Progress progress("exhaustive search", cases.size());
  const auto yardstick = measure_all(map, cases, options, kMostSteps, [&](std::size_t done) { progress.step(done); });
  progress.end();
  const YardstickScore s = compare(yardstick, rows, options.ambiguous_gap);
  std::string text = fmt::format(
      ", \"yardstick\": {{\"unfinished\": {}, \"n\": {}, \"truth_among\": {}, \"ambiguous\": {}, \"our_ambiguous\": {}, \"clear\": {}, "
      "\"clear_right\": {}, \"clear_our_right\": {}, \"clear_our_right_ok\": {}, \"clear_our_wrong_ok\": {}, \"missed\": {}",
      s.unfinished, s.n, s.truth_among, s.ambiguous, s.our_ambiguous, s.clear, s.clear_right, s.clear_our_right,
      s.clear_our_right_ok, s.clear_our_wrong_ok, s.missed);
  if (!no_times) text += fmt::format(", \"s_p50\": {:.2f}, \"s_most\": {:.1f}", s.s_p50, s.s_most);
  return text + "}";
}

void write_reliability(std::optional<AtomicFile>& file, const std::vector<ReliabilityBin>& bins, double error) {
  if (!file) return;
  file->write(reliability_figure(bins, error));
  file->commit();
}

/// Drives, as one line of JSON.
int run_bench_drives(const BenchLocalizeFlags& flags, const LocalizeOptions& options) {
  LocalizeRunsSpec spec = flags.drives;
  spec.worlds = flags.simulated.worlds;
  if (spec.worlds.empty()) spec.worlds = {"flat:1"};
  spec.sensor = flags.simulated.sensor, spec.moved = flags.simulated.moved, spec.people = flags.simulated.people;
  spec.unmapped = flags.simulated.unmapped, spec.seed = flags.common.seed;
  Progress progress("worlds", spec.worlds.size());
  std::size_t done = 0;
  std::optional<AtomicFile> file, figure;
  if (!flags.cases.empty()) file.emplace(flags.cases);
  if (!flags.figure.empty()) figure.emplace(flags.figure);
  const auto write = [&file](const DrivenScan& scan) { file->write(scan_line(scan)); };
  const LocalizeRunsScore s = run_drives(
      spec, options, [&] { progress.step(++done); }, file ? std::function<void(const DrivenScan&)>(write) : nullptr);
  progress.end();
  if (file) file->commit();
  write_reliability(figure, reliability(s.judgements), calibration_error(s.judgements));
  const StartsScore t = score_of(s.starts);
  std::string line = fmt::format(
      "{{\"worlds\": {}, \"wrong_maps\": {}, \"kidnapped\": {}, \"noticed_late\": {}, \"recovered\": {}, \"recovery_s_mean\": {:.2f}, \"wrong_ok_over_1s\": {}, "
      "\"begun\": {}, \"begun_found\": {}, \"begun_ambiguous\": {}, \"begun_ambiguous_found\": {}, \"off_map\": {}, \"off_map_wrong_ok\": {}, \"scans\": {}, \"way_m\": {:.0f}, "
      "\"ok\": {}, \"right_ok\": {}, \"wrong_ok\": {}, \"degraded\": {}, \"ambiguous\": {}, \"lost\": {}, \"median_m\": {:.4f}, "
      "\"longest_lost_s\": {:.1f}, \"longest_wrong_ok_s\": {:.1f}",
      spec.worlds.size(), s.wrong_maps, t.kidnapped, t.noticed_late, t.recovered, t.recovery_s_mean, t.wrong_ok_long,
      t.begun, t.begun_found, t.begun_ambiguous, t.begun_ambiguous_found, s.off_map, s.off_map_wrong_ok, s.scans,
      s.way_m, s.ok, s.right_ok, s.wrong_ok, s.degraded, s.ambiguous, s.lost,
      s.errors_m.empty() ? 0.0 : quantile(s.errors_m, 0.5), s.longest_lost_s, s.longest_wrong_ok_s);
  line += fmt::format(", \"calibration_error\": {}", number_or_null(calibration_error(s.judgements), 4)) +
          reliability_part(reliability(s.judgements));
  if (!flags.common.no_times && !s.cpu_ms.empty())
    line += fmt::format(", \"ms_p50\": {:.3f}, \"ms_p99\": {:.3f}", quantile(s.cpu_ms, 0.5), quantile(s.cpu_ms, 0.99));
  print(line + "}\n");
  return kDone;
}

int run_bench_localize(const BenchLocalizeFlags& flags) {
  const Config config = config_from(flags.common);
  if (flags.runs) return run_bench_drives(flags, config.localize);
  std::optional<AtomicFile> file, figure;
  if (!flags.cases.empty()) file.emplace(flags.cases);
  if (!flags.figure.empty()) figure.emplace(flags.figure);
  const LocalizePlaces places = make_places(flags);
  if (!flags.places.empty() && !has_places(flags.places)) write_places(flags.places, places);
  const double cpu = thread_cpu_seconds();
  const LocalizationMap map = LocalizationMap::from_grid(places.map, config.localize);
  const double prepared_s = thread_cpu_seconds() - cpu;
  Progress progress("scans", places.cases.size());
  const std::vector<LocalizeRow> rows =
      answer_all(map, places.cases, config.localize, [&](std::size_t done) { progress.step(done); });
  progress.end();
  const LocalizeScore s = score_of(rows);
  std::string line = fmt::format(
      "{{\"map\": \"{}\", \"free_m2\": {:.0f}, \"n\": {}, \"right\": {}, \"within_0.5m\": {}, \"ok\": {}, \"right_ok\": {}, \"wrong_ok\": {}, "
      "\"ambiguous\": {}, \"ambiguous_named\": {}, \"degraded\": {}, \"wrong_degraded\": {}, \"unmapped\": {}, \"lost\": {}, \"median_m\": {}, \"median_deg\": {}, \"calibration_error\": {}",
      places.name, map.free_area_m2(), s.n, s.right, s.within_half_m, s.ok, s.right_ok, s.wrong_ok, s.ambiguous,
      s.ambiguous_named, s.degraded, s.wrong_degraded, s.unmapped, s.lost, number_or_null(s.median_m, 4),
      number_or_null(s.median_deg, 3), number_or_null(s.calibration_error, 4));
  line += reliability_part(s.reliability);
  if (!flags.common.no_times) {
    line += fmt::format(", \"ms_p50\": {:.2f}, \"ms_p99\": {:.2f}, \"prepare_ms\": {:.0f}, \"map_mib\": {:.1f}",
                        s.ms_p50, s.ms_p99, 1e3 * prepared_s, static_cast<double>(map.memory_bytes()) / (1 << 20));
  }
  if (flags.yardstick) line += yardstick_part(map, places.cases, rows, config.localize, flags.common.no_times);
  if (file) {
    file->write(case_lines(places.cases, rows));
    file->commit();
  }
  write_reliability(figure, s.reliability, s.calibration_error);
  print(line + "}\n");
  return kDone;
}

/// What is other than when the map was made, and what is done beside single scans.
void add_change_flags(CLI::App* command, BenchLocalizeFlags& flags) {
  const CLI::Range share(0.0, 1.0);
  command->add_option("--moved", flags.simulated.moved, "share of furniture and doors elsewhere than on the map")
      ->type_name("SHARE")
      ->check(share);
  command->add_option("--people", flags.simulated.people, "most people that stand about")
      ->type_name("N")
      ->check(CLI::Range(0, 100));
  command
      ->add_option("--unmapped", flags.simulated.unmapped, "share of the scans from rooms that are wiped from the map")
      ->type_name("SHARE")
      ->check(share);
  command->add_flag("--runs", flags.runs, "drives instead of single scans: kidnapped, begun anywhere, tracked");
  command->add_option("--kidnaps", flags.drives.kidnaps, "with --runs: times that the robot is carried away, a world")
      ->type_name("N")
      ->check(CLI::Range(0, 10000))
      ->capture_default_str();
  command->add_flag("--yardstick", flags.yardstick,
                    "also search exhaustively, to know what each scan can tell: seconds a scan");
}

}  // namespace

void add_bench_localize_command(CLI::App& app, CommandBody& body) {
  auto* bench = app.get_subcommand("bench");
  auto* command = bench->add_subcommand(
      "localize",
      "single scans on maps that slam made of simulated drives, or cast on a map: right, ok, ambiguous, time");
  auto flags = std::make_shared<BenchLocalizeFlags>();
  command->add_option("--worlds", flags->simulated.worlds, "simulated worlds, KIND:SEED, side by side on one map")
      ->delimiter(',');
  command->add_option("--sensor", flags->simulated.sensor, "a sensor or a YAML file")->capture_default_str();
  command->add_option("--map", flags->map, "cast rays on this map of map_server instead")->type_name("map.yaml");
  command->add_option("--poses", flags->simulated.poses, "places")
      ->type_name("N")
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str();
  command->add_option("--draws", flags->cast.draws, "with --map: scans at each place, with noise of their own")
      ->type_name("N")
      ->check(CLI::Range(1, 100'000))
      ->capture_default_str();
  command
      ->add_option("--places", flags->places,
                   "keep the map and its scans in this folder; where they are there, they are read instead of made")
      ->type_name("DIR");
  command->add_option("--cases", flags->cases, "write a line per scan to this file")->type_name("FILE");
  command->add_option("--figure", flags->figure, "draw confidence against the share of right answers to this SVG file")
      ->type_name("FILE");
  add_change_flags(command, *flags);
  add_seed_flag(*command, flags->common);
  add_config_flag(*command, flags->common);
  add_no_times_flag(*command, flags->common);
  command->footer("Example:\n  phasescan bench localize --worlds building:31,building:32 --poses 200");
  command->callback([flags, &body] { body = [flags] { return run_bench_localize(*flags); }; });
}

}  // namespace phasescan::app
