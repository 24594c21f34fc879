// phasescan simulate: logs with their truth, and pairs files.
#include <algorithm>
#include <filesystem>

#include "command_list.hpp"
#include "commands.hpp"
#include "core/parallel.hpp"
#include "people.hpp"
#include "phasescan/core/time.hpp"
#include "phasescan/io/error.hpp"
#include "io/pairs.hpp"
#include "io/scan_log.hpp"
#include "io/tum.hpp"
#include "sim/drive.hpp"
#include "sim/pairs.hpp"
#include "sim/pairs_spec.hpp"
#include "sim/world_file.hpp"

namespace phasescan::app {
namespace {

struct SimulateFlags {
  CommonFlags common;
  std::string world;
  std::string sensor = "rplidar-a1";
  std::string path = "tour";
  std::string out;
  std::uint64_t pairs = 0;
  std::vector<std::string> classes;
  sim::PathOptions drive;
  sim::DriveOptions what;
  bool no_motion = false;
  const CLI::App* command = nullptr;

  bool given(const std::string& flag) const { return command->count(flag) > 0; }
};

/// A flag that means nothing here is a mistake, not something to pass over.
void refuse(const SimulateFlags& flags, std::initializer_list<const char*> names, const std::string& why) {
  for (const char* name : names) {
    if (flags.given(name)) throw std::invalid_argument(std::string(name) + ": " + why);
  }
}

template <class Names>
std::string joined(const Names& names) {
  std::string text;
  for (const auto& name : names) text += (text.empty() ? "" : ", ") + std::string(name);
  return text;
}

sim::PairsSpec pairs_spec(const SimulateFlags& flags) {
  if (flags.given("--config")) {
    refuse(flags, {"--world", "--sensor", "--classes"}, "the file of --config says that; expected one of the two");
    return sim::read_pairs_spec(flags.common.config);
  }
  if (!flags.given("--world"))
    refuse(flags, {"--sensor", "--classes"}, "the benchmark says that itself; expected --world with it");
  if (!flags.given("--world")) return sim::read_pairs_spec("bench-sim");
  sim::PairRow row;
  if (const auto kind = sim::world_kind(flags.world)) {
    row.worlds = {*kind};
    row.dataset = flags.world;
  } else {
    const sim::World world = sim::world_by_name(flags.world, flags.common.seed);
    row.dataset = world.name;
    row.fixed = std::make_shared<const sim::World>(world);
  }
  row.sensor = flags.sensor;
  if (!flags.classes.empty()) {
    row.classes.clear();
    for (const std::string& name : flags.classes)
      row.classes.push_back(enum_of_flag<sim::PairClass>("--classes", name));
  }
  return {flags.common.seed, {row}};
}

int simulate_pairs(const SimulateFlags& flags) {
  refuse(flags,
         {"--path", "--speed", "--turn-rate", "--jitter", "--jitter-deg", "--stop-every", "--stop-for", "--duration",
          "--odometry", "--people", "--no-motion"},
         "is of a drive, not of pairs; expected no --pairs with it");
  const sim::PairsSpec spec = pairs_spec(flags);
  const sim::PairGenerator generator(spec, flags.given("--seed") ? flags.common.seed : spec.seed);
  PairWriter writer(flags.out);
  Progress progress("pairs", flags.pairs);
  const InterruptGuard guard;
  constexpr std::uint64_t kBlock = 64;
  const auto threads = static_cast<std::size_t>(std::max(1, flags.common.threads));
  std::uint64_t done = 0;
  while (done < flags.pairs && !InterruptGuard::interrupted()) {
    // Any number of threads makes the same file: pair k depends on nothing but k.
    const std::uint64_t count = std::min(kBlock, flags.pairs - done);
    std::vector<ScanPair> block(count);
    parallel_for(count, threads, [&](std::size_t i, std::size_t) { block[i] = generator.make(done + i).pair; });
    for (const ScanPair& pair : block) writer.write(pair);
    done += count;
    progress.step(done);
  }
  if (done == 0) return stopped_with_nothing();
  writer.commit();
  if (done < flags.pairs) warn("stopped after " + std::to_string(done) + " pairs; the file holds these");
  progress.end();
  print_ending({{"pairs", std::to_string(done)}, {"wrote", flags.out}});
  return kDone;
}

sim::Path plan_path(const SimulateFlags& flags, const sim::World& world) {
  sim::PathOptions options = flags.drive;
  const std::uint64_t seed = Random::derive(flags.common.seed, 1);
  const auto kinds = enum_names<sim::PathKind>();
  if (std::find(kinds.begin(), kinds.end(), flags.path) != kinds.end()) {
    options.kind = enum_from_string<sim::PathKind>(flags.path);
    return sim::Path(world, options, seed);
  }
  if (std::filesystem::exists(flags.path)) return sim::Path(sim::read_points(flags.path), options, seed);
  throw InputError(flags.path, 0, "no such file, and not one of " + joined(kinds) + did_you_mean(flags.path, kinds));
}

int simulate_drive(const SimulateFlags& flags) {
  refuse(flags, {"--config", "--classes"}, "is of pairs; expected --pairs N with it");
  const sim::World world = sim::world_by_name(flags.world.empty() ? "flat" : flags.world, flags.common.seed);
  sim::LidarOptions lidar = sim::read_lidar(flags.sensor);
  lidar.motion = lidar.motion && !flags.no_motion;
  sim::Drive drive(world, lidar, plan_path(flags, world), flags.what, Random::derive(flags.common.seed, 2));
  ScanLogWriter writer(flags.out);
  std::vector<StampedPose> truth;
  Progress progress("scans", drive.size());
  const InterruptGuard guard;
  while (!InterruptGuard::interrupted()) {
    const auto scan = drive.next();
    if (!scan) break;
    writer.write(scan->entry);
    truth.push_back({scan->entry.scan.stamp, scan->T_world_laser});
    progress.step(truth.size());
  }
  if (truth.empty() && InterruptGuard::interrupted()) return stopped_with_nothing();
  // Both or none: when the log is put in place, nothing can fail for its truth any more.
  AtomicFile truth_file(flags.out + ".truth.tum");
  truth_file.write(format_tum(truth));
  truth_file.seal();
  writer.commit();
  truth_file.commit();
  if (InterruptGuard::interrupted())
    warn("stopped after " + std::to_string(truth.size()) + " scans; the log holds these");
  progress.end();
  const double seconds = truth.empty() ? 0.0 : stamp_to_seconds(truth.back().stamp - truth.front().stamp);
  print_ending({{"scans", std::to_string(truth.size()) + " in " + duration_text(seconds)},
                {"world", world.name},
                {"wrote", flags.out + ", " + flags.out + ".truth.tum"}});
  return kDone;
}

}  // namespace

void add_simulate_command(CLI::App& app, CommandBody& body) {
  auto* command = app.add_subcommand("simulate", "makes logs with their truth, or pairs files, in simulated worlds");
  auto flags = std::make_shared<SimulateFlags>();
  flags->command = command;
  const std::string kinds = joined(enum_names<sim::WorldKind>()), paths = joined(enum_names<sim::PathKind>());
  const std::string sensors = joined(sim::lidar_names()), benchmarks = joined(sim::pairs_spec_names());
  command->add_option("--out", flags->out, "the log (truth goes to LOG.truth.tum) or the pairs file; .gz packs it")
      ->required();
  command
      ->add_option("--world", flags->world, "a kind (" + kinds + "), KIND:SEED for one building, or a YAML file; flat")
      ->check(offers(enum_names<sim::WorldKind>()));
  command->add_option("--sensor", flags->sensor, "a sensor (" + sensors + ") or a YAML file")
      ->capture_default_str()
      ->check(offers(sim::lidar_names()));
  command->add_option("--path", flags->path, "a kind (" + paths + ") or a YAML file of points")
      ->capture_default_str()
      ->check(offers(enum_names<sim::PathKind>()));
  command->add_option("--speed", flags->drive.speed_mps, "m/s, at most")
      ->check(number_from_zero())
      ->capture_default_str();
  command->add_option("--turn-rate", flags->drive.turn_rate_dps, "deg/s, at most")
      ->check(number_from_zero())
      ->capture_default_str();
  command->add_option("--duration", flags->drive.duration_s, "seconds; 0: one round of a tour, else 60 s")
      ->check(number_from_zero())
      ->capture_default_str();
  command->add_option("--jitter", flags->drive.jitter_m, "vibration, m (standard deviation)")
      ->check(number_from_zero())
      ->capture_default_str();
  command->add_option("--jitter-deg", flags->drive.jitter_deg, "vibration of the heading, deg")
      ->check(number_from_zero())
      ->capture_default_str();
  command->add_option("--stop-every", flags->drive.stop_every_m, "m of a tour after which the robot stops; 0: never")
      ->check(number_from_zero())
      ->capture_default_str();
  command->add_option("--stop-for", flags->drive.stop_s, "s that it stands then")
      ->check(number_from_zero())
      ->capture_default_str();
  command->add_option("--people", flags->what.people, "people walking about")->capture_default_str();
  command->add_flag("--odometry", flags->what.odometry, "wheel odometry in the log: drifting, noisy, slipping");
  command->add_flag("--no-motion", flags->no_motion, "all beams of a scan at one time: no distortion by motion");
  command->add_option("--pairs", flags->pairs, "makes this many pairs instead of a log")->check(whole_number_from(1));
  command->add_option("--config", flags->common.config,
                      "with --pairs: a benchmark (" + benchmarks + ") or a YAML file; bench-sim");
  command->add_option("--classes", flags->classes, "with --pairs and --world: small, middle, large, global, none")
      ->check(offers(enum_names<sim::PairClass>()))
      ->delimiter(',');
  add_seed_flag(*command, flags->common);
  add_threads_flag(*command, flags->common);
  command->footer("Example:\n  phasescan simulate --world flat --sensor rplidar-a1 --odometry --out drive.jsonl");
  command->callback([flags, &body] {
    body = [flags] {
      if (!flags->given("--pairs")) return simulate_drive(*flags);
      return simulate_pairs(*flags);
    };
  });
}

}  // namespace phasescan::app
