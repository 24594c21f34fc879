// phasescan bench memory: how the bounded-memory mode grows while a robot drives about one building for days.
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>

#include "command_list.hpp"
#include "commands.hpp"
#include "phasescan/core/time.hpp"
#include "phasescan/io/error.hpp"
#include "sim/drive.hpp"
#include "sim/pairs_spec.hpp"
#include "sim/world_file.hpp"
#include "phasescan/slam/slam.hpp"

namespace phasescan::app {
namespace {

struct MemoryFlags {
  CommonFlags common;
  std::size_t scans = 400'000, settled = 20'000;
  int people = 3;
  std::string world = "flat:1", sensor = "rplidar-a1", trace;
};

constexpr double kFarOffM = 0.2;
constexpr std::size_t kTraceScans = 1000;

/// How far the poses are off as the map had them when each scan came: what a robot would have gone by.
class Errors {
 public:
  explicit Errors(const std::string& trace) {
    if (trace.empty()) return;
    trace_.open(trace);
    if (!trace_) throw SystemError(trace, std::string("cannot be written: ") + std::strerror(errno));
    trace_ << "scans,nodes,largest_off_m\n";
  }

  /// After each scan. @param T_start_now  the true pose, seen from the first scan's
  void add(const Slam& slam, const ScanUpdate& update, const Pose2& T_start_now) {
    last_m_ = translation_distance(update.T_map_base(), T_start_now);
    largest_m_ = std::max(largest_m_, last_m_);
    traced_m_ = std::max(traced_m_, last_m_);
    if (last_m_ > kFarOffM) ++far_off_;
    ++done_;
    if (trace_.is_open() && done_ % kTraceScans == 0) {
      trace_ << fmt::format("{},{},{:.3f}\n", done_, slam.map()->keyframes().size(), traced_m_);
      trace_.flush();
      traced_m_ = 0.0;
    }
  }
  double last_m() const { return last_m_; }
  double largest_m() const { return largest_m_; }
  double share_far_off() const {
    return static_cast<double>(far_off_) / static_cast<double>(std::max<std::size_t>(1, done_));
  }

 private:
  std::ofstream trace_;
  std::size_t done_ = 0, far_off_ = 0;
  double last_m_ = 0.0, largest_m_ = 0.0, traced_m_ = 0.0;
};

/// Resident memory of this process [bytes].
double resident_bytes() {
  std::ifstream statm("/proc/self/statm");
  double total = 0.0, resident = 0.0;
  statm >> total >> resident;
  return resident * static_cast<double>(::sysconf(_SC_PAGESIZE));
}

int run_memory(const MemoryFlags& flags) {
  if (flags.settled >= flags.scans)
    throw std::invalid_argument(
        fmt::format("bench memory: --settled {} is not below --scans {}", flags.settled, flags.scans));
  const sim::World world = sim::world_by_name(flags.world, flags.common.seed);
  const sim::LidarOptions lidar = sim::read_lidar(flags.sensor);
  sim::PathOptions path;
  path.speed_mps = 0.5;
  path.turn_rate_dps = 90.0;
  path.duration_s = static_cast<double>(flags.scans) / lidar.rate_hz;
  sim::DriveOptions people;
  people.people = flags.people;
  sim::Drive drive(world, lidar, sim::Path(world, path, Random::derive(flags.common.seed, 1)), people,
                   Random::derive(flags.common.seed, 2));
  SlamOptions options = config_from(flags.common).slam;
  options.slam.bounded_memory = true;
  Slam slam(options);
  Progress progress("scans", flags.scans);
  const InterruptGuard guard;
  const double cpu = process_cpu_seconds();
  double settled_bytes = 0.0;
  std::size_t settled_nodes = 0;
  Pose2 T_world_start;
  Errors errors(flags.trace);
  while (!InterruptGuard::interrupted() && slam.scans() < flags.scans) {
    const auto scan = drive.next();
    if (!scan) break;
    if (slam.scans() == 0) T_world_start = scan->T_world_laser;
    const ScanUpdate update = slam.add({scan->entry.scan});
    errors.add(slam, update, T_world_start.inverse() * scan->T_world_laser);
    if (slam.scans() == flags.settled) {
      settled_bytes = resident_bytes();
      settled_nodes = slam.map()->keyframes().size();
    }
    progress.step(slam.scans());
  }
  const double grown = resident_bytes() - settled_bytes;
  const std::size_t n = slam.scans();
  print(fmt::format(
      "{{\"scans\": {}, \"settled\": {}, \"nodes_settled\": {}, \"nodes\": {}, \"rss_settled_mib\": {:.1f}, "
      "\"grown_bytes\": {:.0f}, \"allowed_bytes\": {}, \"bytes_per_scan\": {:.1f}, \"end_off_m\": {:.3f}, "
      "\"largest_off_m\": {:.3f}, \"share_off_0.2m\": {:.6f}, \"cpu_ms_per_scan\": {:.3f}}}\n",
      n, flags.settled, settled_nodes, slam.map()->keyframes().size(), settled_bytes / 1048576.0, grown,
      64 * n + 5'000'000, grown / static_cast<double>(std::max<std::size_t>(1, n - flags.settled)), errors.last_m(),
      errors.largest_m(), errors.share_far_off(), 1e3 * (process_cpu_seconds() - cpu) / static_cast<double>(n)));
  return n == flags.scans && grown <= static_cast<double>(64 * n + 5'000'000) ? kDone : kAnswerIsNo;
}

}  // namespace

void add_memory_command(CLI::App& app, CommandBody& body) {
  auto* bench = app.get_subcommand("bench");
  auto* command = bench->add_subcommand(
      "memory",
      "memory of the bounded-memory mode in one simulated building with people: 64 bytes a scan + 5 MB allowed");
  auto flags = std::make_shared<MemoryFlags>();
  command->add_option("--scans", flags->scans, "length of the drive")
      ->type_name("N")
      ->check(CLI::Range(100, 100'000'000))
      ->capture_default_str();
  command->add_option("--settled", flags->settled, "growth counts from this scan on")
      ->type_name("N")
      ->check(CLI::Range(1, 100'000'000))
      ->capture_default_str();
  command->add_option("--people", flags->people, "people walking about")
      ->check(CLI::Range(0, 1000))
      ->capture_default_str();
  command->add_option("--world", flags->world, "as for simulate")->capture_default_str();
  command->add_option("--sensor", flags->sensor, "as for simulate")->capture_default_str();
  command
      ->add_option("--trace", flags->trace,
                   "a line of CSV every 1000 scans: scans, keyframes, the largest error in them")
      ->type_name("FILE");
  add_seed_flag(*command, flags->common);
  add_config_flag(*command, flags->common);
  command->footer("Example:\n  phasescan bench memory");
  command->callback([flags, &body] { body = [flags] { return run_memory(*flags); }; });
}

}  // namespace phasescan::app
