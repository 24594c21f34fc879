// phasescan bench live-memory: what a live run with its page and its recording holds while a robot drives about one
// building for a day, as fast as it goes.
#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <optional>
#include <thread>

#include "command_list.hpp"
#include "commands.hpp"
#include "live/clocks.hpp"
#include "live/recorder.hpp"
#include "phasescan/io/error.hpp"
#include "phasescan/live/live.hpp"
#include "phasescan/slam/state.hpp"
#include "serve/live_control.hpp"
#include "serve/status_board.hpp"
#include "serve/viewer.hpp"
#include "sim/drive.hpp"
#include "sim/pairs_spec.hpp"
#include "sim/world_file.hpp"

namespace phasescan::app {
namespace {

struct LiveMemoryFlags {
  CommonFlags common;
  double hours = 24.0;
  std::string world = "flat:1", sensor = "rplidar-a1", folder = ".";
};

constexpr double kMiB = 1048576.0;
constexpr double kMostMiB = 80.0;
constexpr double kFlatMiB = 2.0;  // what it may hold more at any time after the first hour: buffers that come and go

/// Scans of a drive simulated by a process of its own: the way of a day alone takes 200 MiB, which no run would hold.
class SimulatedElsewhere {
 public:
  /// There must be no other thread yet.
  explicit SimulatedElsewhere(const std::function<sim::Drive()>& drive) {
    int ends[2];
    if (::pipe(ends) != 0) throw SystemError("pipe", std::strerror(errno));
    child_ = ::fork();
    if (child_ < 0) throw SystemError("fork", std::strerror(errno));
    if (child_ == 0) {
      ::close(ends[0]);
      ::_exit(send(drive, ends[1]));
    }
    ::close(ends[1]);
    in_ = ::fdopen(ends[0], "rb");
  }
  ~SimulatedElsewhere() {
    std::fclose(in_);
    ::waitpid(child_, nullptr, 0);
  }
  SimulatedElsewhere(const SimulatedElsewhere&) = delete;
  SimulatedElsewhere& operator=(const SimulatedElsewhere&) = delete;

  std::optional<Scan> next() {
    Head head;
    if (std::fread(&head, sizeof head, 1, in_) != 1) return std::nullopt;
    std::vector<float> raw(head.beams), angles(head.angles), intensities(head.intensities);
    for (std::vector<float>* part : {&raw, &angles, &intensities})
      if (std::fread(part->data(), sizeof(float), part->size(), in_) != part->size()) return std::nullopt;
    Scan scan = make_scan(raw, head.geometry, angles);
    scan.stamp = head.stamp;
    scan.time_increment = head.time_increment;
    scan.intensities = std::move(intensities);
    return scan;
  }

 private:
  struct Head {
    Stamp stamp = 0;
    ScanGeometry geometry;
    double time_increment = 0.0;
    std::size_t beams = 0, angles = 0, intensities = 0;
  };

  static int send(const std::function<sim::Drive()>& drive, int to) {
    std::FILE* out = ::fdopen(to, "wb");
    sim::Drive driven = drive();
    while (auto next = driven.next()) {
      Scan& scan = next->entry.scan;
      for (std::size_t i = 0; i < scan.size(); ++i)
        if (scan.states[i] == BeamState::kNoReturn) scan.ranges[i] = 0.0F;  // as sensors say it
      const Head head{scan.stamp,         scan.geometry,      scan.time_increment,
                      scan.ranges.size(), scan.angles.size(), scan.intensities.size()};
      bool sent = std::fwrite(&head, sizeof head, 1, out) == 1;
      for (const std::vector<float>* part : {&scan.ranges, &scan.angles, &scan.intensities})
        sent = sent && std::fwrite(part->data(), sizeof(float), part->size(), out) == part->size();
      if (!sent) return 1;
    }
    return std::fclose(out) == 0 ? 0 : 1;
  }

  pid_t child_ = -1;
  std::FILE* in_ = nullptr;
};

/// Nobody asks for anything.
class NoControl final : public serve::LiveControl {
 public:
  serve::ControlState state() const override { return {}; }
  void set_pose(const Pose2&, serve::CommandDone done) override { done(false, ""); }
  void relocalise(serve::CommandDone done) override { done(false, ""); }
  void start_recording(const std::string&, serve::CommandDone done) override { done(false, ""); }
  void stop_recording(serve::CommandDone done) override { done(false, ""); }
  void save(const std::string&, serve::CommandDone done) override { done(false, ""); }
  void replay_speed(double, serve::CommandDone done) override { done(false, ""); }
  void replay_seek(double, serve::CommandDone done) override { done(false, ""); }
};

class Recording final : public live::LiveSink {
 public:
  explicit Recording(const std::string& path) : recorder_(path, [](const std::string& text) { warn(text); }) {}
  void take(const live::LiveUpdate& update) override { recorder_.add(update); }
  std::uint64_t scans() const { return recorder_.counts().scans + recorder_.counts().dropped; }

 private:
  live::Recorder recorder_;
};

/// A drive that waits for the run and the recording alone: what piles up because a day passes in minutes is none of a
/// real one.
class DriveSource final : public live::LiveSource {
 public:
  DriveSource(SimulatedElsewhere& drive, std::function<std::uint64_t()> recorded)
      : drive_(drive), recorded_(std::move(recorded)) {}
  bool can_wait() const override { return true; }
  void run(const std::function<bool()>& stop, const std::function<void(live::LiveScan)>& hand,
           const std::function<void(const std::string&)>&) override {
    while (!stop()) {
      auto scan = drive_.next();
      if (!scan) return;
      constexpr std::uint64_t kBehind = 16;
      while (handed_ > recorded_() + kBehind && !stop()) std::this_thread::sleep_for(std::chrono::microseconds(200));
      ++handed_;
      hand({{std::move(*scan)}, live::steady_ns()});
    }
  }

 private:
  SimulatedElsewhere& drive_;
  std::function<std::uint64_t()> recorded_;
  std::uint64_t handed_ = 0;
};

std::size_t entries_of(const char* folder) {
  const auto all = std::filesystem::directory_iterator(folder);
  return static_cast<std::size_t>(std::distance(begin(all), end(all)));
}

double resident_mib() {
  std::ifstream statm("/proc/self/statm");
  double total = 0.0, resident = 0.0;
  statm >> total >> resident;
  return resident * static_cast<double>(::sysconf(_SC_PAGESIZE)) / kMiB;
}

struct Between {
  std::size_t least = SIZE_MAX, most = 0;
  void add(std::size_t value) {
    least = std::min(least, value);
    most = std::max(most, value);
  }
};

/// What the process holds, by the time of the scans.
class Watch final : public live::LiveSink {
 public:
  explicit Watch(double wanted_hours) : progress_("minutes", static_cast<std::size_t>(60.0 * wanted_hours)) {}
  void take(const live::LiveUpdate& update) override {
    if (!first_) first_ = update.update.stamp;
    hours = stamp_to_seconds(update.update.stamp - *first_) / 3600.0;
    ++scans;
    const auto minute = static_cast<std::size_t>(60.0 * hours);
    if (minute == minute_) return;
    minute_ = minute;
    progress_.step(minute);
    end_mib = resident_mib();
    most_mib = std::max(most_mib, end_mib);
    if (minute <= 60) hour_mib = end_mib;
    descriptors.add(entries_of("/proc/self/fd") - 1);  // that of looking itself
    threads.add(entries_of("/proc/self/task"));
  }
  /// Not more than at the end of the first hour, as far as it went.
  bool flat() const {
    return most_mib <= hour_mib + kFlatMiB && descriptors.least == descriptors.most && threads.least == threads.most;
  }
  double hours = 0.0, hour_mib = 0.0, end_mib = 0.0, most_mib = 0.0;
  std::size_t scans = 0;
  Between descriptors, threads;

 private:
  Progress progress_;
  std::optional<Stamp> first_;
  std::size_t minute_ = 0;
};

sim::Drive drive_of(const LiveMemoryFlags& flags) {
  sim::PathOptions path;
  path.speed_mps = 0.5;
  path.turn_rate_dps = 90.0;
  path.duration_s = 3600.0 * flags.hours;
  const sim::World world = sim::world_by_name(flags.world, flags.common.seed);
  return sim::Drive(world, sim::read_lidar(flags.sensor), sim::Path(world, path, Random::derive(flags.common.seed, 1)),
                    {}, Random::derive(flags.common.seed, 2));
}

int run_live_memory(const LiveMemoryFlags& flags) {
  SimulatedElsewhere drive([&flags] { return drive_of(flags); });
  SlamOptions options = config_from(flags.common).slam;
  options.slam.bounded_memory = true;  // as `live` has it
  ThreadExecutor executor;
  Slam slam(options, Schedule::kLatest, &executor);
  const auto begin = [&] { return Slam(options, Schedule::kLatest, &executor); };
  const std::unique_ptr<live::LiveEngine> engine = live::slam_engine(slam, begin);
  NoControl control;
  serve::Viewer viewer(options, control, [] { return std::string("{}"); });
  serve::StatusBoard board("simulated");
  make_folder(flags.folder);
  const std::string file = (std::filesystem::path(flags.folder) / "live-memory.mcap").string();
  std::filesystem::remove(file);
  Watch watch(flags.hours);
  const InterruptGuard guard;
  {
    Recording recording(file);
    DriveSource source(drive, [&recording] { return recording.scans(); });
    live::run_live(
        source, *engine, {&viewer, &board, &recording, &watch}, nullptr, [] { return InterruptGuard::interrupted(); },
        [](const std::string&) {});
  }
  const double recorded = static_cast<double>(std::filesystem::file_size(file)) / kMiB;
  std::filesystem::remove(file);
  const double a_day = watch.hours > 1.0 ? 24.0 * (watch.end_mib - watch.hour_mib) / (watch.hours - 1.0) : 0.0;
  const StateSummary kept = summarize(slam.checkpoint());
  print(fmt::format(
      "{{\"hours\": {:.3f}, \"scans\": {}, \"nodes\": {}, \"rss_hour_mib\": {:.1f}, \"rss_end_mib\": {:.1f}, "
      "\"rss_most_mib\": {:.1f}, \"grown_mib_per_day\": {:.1f}, \"recorded_mib\": {:.0f}, \"descriptors\": [{}, {}], "
      "\"threads\": [{}, {}], \"path_scans\": {}, \"path_keyframes\": {}}}\n",
      watch.hours, watch.scans, slam.map()->keyframes().size(), watch.hour_mib, watch.end_mib, watch.most_mib, a_day,
      recorded, watch.descriptors.least, watch.descriptors.most, watch.threads.least, watch.threads.most, kept.scans,
      kept.keyframes));
  return watch.most_mib <= kMostMiB && watch.flat() ? kDone : kAnswerIsNo;
}

}  // namespace

void add_live_memory_command(CLI::App& app, CommandBody& body) {
  auto* bench = app.get_subcommand("bench");
  auto* command = bench->add_subcommand(
      "live-memory",
      "memory of a live run with its page and its recording, a day simulated at speed: 80 MiB allowed, and no growth after "
      "an hour");
  auto flags = std::make_shared<LiveMemoryFlags>();
  command->add_option("--hours", flags->hours, "length of the drive")
      ->type_name("H")
      ->check(CLI::Range(0.01, 10000.0))
      ->capture_default_str();
  command->add_option("--world", flags->world, "as for simulate")->capture_default_str();
  command->add_option("--sensor", flags->sensor, "as for simulate")->capture_default_str();
  command->add_option("--folder", flags->folder, "where the recording lies while it is made, 1 GB for a day")
      ->type_name("DIR")
      ->capture_default_str();
  add_seed_flag(*command, flags->common);
  add_config_flag(*command, flags->common);
  command->footer("Example:\n  phasescan bench live-memory --hours 3");
  command->callback([flags, &body] { body = [flags] { return run_live_memory(*flags); }; });
}

}  // namespace phasescan::app
