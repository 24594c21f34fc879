// phasescan bench localize: single scans on maps that SLAM made, or cast on maps of others.
#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <optional>

#include "command_list.hpp"
#include "commands.hpp"
#include "eval/localize_bench.hpp"
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
  std::string map, cases;
};

LocalizePlaces make_places(const BenchLocalizeFlags& flags) {
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

/// A line per case: what the confidence is fitted on.
std::string case_lines(const std::vector<LocalizeCase>& cases, const std::vector<LocalizeRow>& rows) {
  std::string text;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const LocalizationUpdate& u = rows[i].update;
    const PoseEstimate none{};
    const PoseEstimate& second = u.hypotheses.size() > 1 ? u.hypotheses[1] : none;
    const Pose2& truth = cases[i].T_map_base;
    nlohmann::ordered_json line{{"status", to_string(u.status)},
                                {"right", rows[i].right()},
                                {"named", rows[i].named},
                                {"error_m", rows[i].error_m},
                                {"error_deg", rad_to_deg(rows[i].error_rad)},
                                {"confidence", u.confidence},
                                {"second", second.confidence},
                                {"explained", u.fit.explained},
                                {"contradicting", u.fit.contradicting},
                                {"log_likelihood", u.fit.log_likelihood},
                                {"margin", u.margin},
                                {"sigma_x", std::sqrt(u.covariance(0, 0))},
                                {"sigma_y", std::sqrt(u.covariance(1, 1))},
                                {"hits", cases[i].measurement.scan.hit_count()},
                                {"truth", {truth.x, truth.y, truth.theta}},
                                {"ms", rows[i].ms}};
    text += line.dump() + "\n";
  }
  return text;
}

int run_bench_localize(const BenchLocalizeFlags& flags) {
  const Config config = config_from(flags.common);
  std::optional<AtomicFile> file;
  if (!flags.cases.empty()) file.emplace(flags.cases);
  const LocalizePlaces places = make_places(flags);
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
      "\"ambiguous\": {}, \"ambiguous_named\": {}, \"lost\": {}, \"median_m\": {:.4f}, \"median_deg\": {:.3f}, \"calibration_error\": {:.4f}",
      places.name, map.free_area_m2(), s.n, s.right, s.within_half_m, s.ok, s.right_ok, s.wrong_ok, s.ambiguous,
      s.ambiguous_named, s.lost, s.median_m, s.median_deg, s.calibration_error);
  if (!flags.common.no_times) {
    line += fmt::format(", \"ms_p50\": {:.2f}, \"ms_p99\": {:.2f}, \"prepare_ms\": {:.0f}, \"map_mib\": {:.1f}",
                        s.ms_p50, s.ms_p99, 1e3 * prepared_s, static_cast<double>(map.memory_bytes()) / (1 << 20));
  }
  if (file) {
    file->write(case_lines(places.cases, rows));
    file->commit();
  }
  print(line + "}\n");
  return kDone;
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
  command->add_option("--cases", flags->cases, "write a line per scan to this file")->type_name("FILE");
  add_seed_flag(*command, flags->common);
  add_config_flag(*command, flags->common);
  add_no_times_flag(*command, flags->common);
  command->footer("Example:\n  phasescan bench localize --worlds building:31,building:32 --poses 200");
  command->callback([flags, &body] { body = [flags] { return run_bench_localize(*flags); }; });
}

}  // namespace phasescan::app
