// phasescan live: a sensor plugged in, poses as they come.
#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>

#include "command_list.hpp"
#include "commands.hpp"
#include "io/file.hpp"
#include "live/port.hpp"
#include "live_keeping.hpp"
#include "live_ros2.hpp"
#include "live_sources.hpp"
#include "people.hpp"
#include "phasescan/io/error.hpp"
#include "phasescan/live/live.hpp"
#include "saved_run.hpp"

namespace phasescan::app {
namespace {

struct LiveFlags {
  CommonFlags common;
  LogOptions options;
  KeepingFlags keeping;
  std::string port, replay, sensor, raw;
  bool demo = false, json = false, list = false, ros2 = false;
};

std::string json_line(const live::LiveUpdate& live) {
  const ScanUpdate& update = live.update;
  const Pose2 pose = update.T_map_base();
  std::string line =
      fmt::format(R"({{"stamp": {:.6f}, "status": "{}", "pose": {{"x": {:.4f}, "y": {:.4f}, "theta": {:.5f}}}, )",
                  stamp_to_seconds(update.stamp), to_string(update.status), pose.x, pose.y, pose.theta);
  const Eigen::Matrix3d covariance = update.map_covariance.value_or(update.odom_covariance);
  line += "\"covariance\": [";
  for (int i = 0; i < 9; ++i) line += fmt::format("{}{:.6g}", i > 0 ? ", " : "", covariance(i / 3, i % 3));
  return line + fmt::format("], \"confidence\": {:.3f}, \"latency_ms\": {:.2f}}}\n", live.confidence, live.latency_ms);
}

int print_list() {
  const std::vector<live::ListedPort> ports = live::list_ports();
  print(ports.empty() ? "ports: none found\n" : "ports:\n");
  for (const live::ListedPort& port : ports) print(fmt::format("  {:<20} {}\n", port.path, port.about));
  print("sensors:\n");
  for (const live::SensorModel& model : live::sensor_models()) {
    const std::string line = model.baud > 0 ? fmt::format("{} baud", model.baud) : "";
    const std::string network = model.tcp_port > 0 ? fmt::format("network port {}", model.tcp_port) : "";
    print(fmt::format("  {:<14} {:<50} {}{}{}\n", model.name, model.title, line,
                      line.empty() || network.empty() ? "" : ", ", network));
  }
  return kDone;
}

std::unique_ptr<live::LiveSource> source_of(const LiveFlags& flags, LiveRos2& ros2) {
  const int sources = (flags.port.empty() ? 0 : 1) + (flags.replay.empty() ? 0 : 1) + (flags.demo ? 1 : 0);
  if (sources != 1) throw std::invalid_argument("live: expected one of --port PORT, --replay LOG, --demo");
  if (flags.demo) return demo_source(flags.common.seed);
  if (!flags.replay.empty()) return replay_source(flags.replay, flags.options);
  if (LiveRos2::is_topic(flags.port)) return ros2.open(flags.port);
  return live::open_sensor(flags.port, flags.sensor, flags.raw);
}

/// What people see of a run: a line per scan with --json, else one that changes on a terminal, else one per event.
class LiveOutput {
 public:
  explicit LiveOutput(bool json) : json_(json), terminal_(::isatty(STDERR_FILENO) != 0 && !json) {}

  void show(const live::LiveUpdate& update) {
    if (json_) {
      print(json_line(update));
      flush();
      return;
    }
    const Pose2 pose = update.update.T_map_base();
    const std::string status = to_string(update.update.status);
    if (terminal_) {
      std::fprintf(stderr, "\r%-12s x %7.2f m  y %7.2f m  heading %6.1f deg  %5.1f ms ", status.c_str(), pose.x, pose.y,
                   rad_to_deg(pose.theta), update.latency_ms);
    } else if (status != before_) {
      std::fprintf(stderr, "phasescan: %s\n", status.c_str());
    }
    before_ = status;
  }
  void tell(const std::string& text) const {
    std::fprintf(stderr, "%sphasescan: %s\n", terminal_ ? "\n" : "", text.c_str());
  }
  void end() const {
    if (terminal_) std::fprintf(stderr, "\n");
  }

 private:
  bool json_, terminal_;
  std::string before_;
};

/// A run that begins, or goes on with --resume.
struct BegunRun {
  std::optional<SavedRun> saved;
  SlamOptions options;
};

BegunRun begin(const LiveFlags& flags, const Config& config) {
  if (flags.keeping.resume.empty()) return {std::nullopt, config.slam};
  BegunRun begun{load_run(flags.keeping.resume).saved, {}};
  begun.options = options_to_go_on(*begun.saved, flags.common.config, config.slam);
  return begun;
}

/// A map that grows begins where the robot began: no pose on it can be asked for.
std::function<void(const Pose2&, const Eigen::Matrix3d&)> no_use_for_a_pose(
    const std::function<void(const std::string&)>& tell) {
  return [tell](const Pose2&, const Eigen::Matrix3d&) {
    tell("initialpose: a pose came; a map that is being made has no use for it");
  };
}

int run_live_command(const LiveFlags& flags) {
  if (flags.list) return print_list();
  if (!flags.raw.empty() && flags.port.empty())
    throw std::invalid_argument("--raw: keeps what a port sends; expected --port with it");
  LiveOutput output(flags.json);
  const auto tell = [&](const std::string& text) { output.tell(text); };
  BegunRun begun = begin(flags, config_from(flags.common));
  LiveRos2 ros2(flags.ros2 || LiveRos2::is_topic(flags.port));
  std::unique_ptr<live::LiveSource> source = source_of(flags, ros2);
  if (flags.ros2) ros2.publish(begun.options.map, no_use_for_a_pose(tell));
  LiveKeeping keeping(flags.keeping, begun.options.slam.autosave_s, tell);
  ThreadExecutor executor;
  Slam slam = begun.saved ? Slam(begun.saved->state, begun.options, Schedule::kLatest, &executor)
                          : Slam(begun.options, Schedule::kLatest, &executor);
  if (begun.saved && begun.saved->state.scans() > 0)
    source =
        resumed(std::move(source), slam, summarize(begun.saved->state).last_stamp, begun.options.slam.session_gap_s);
  begun.saved.reset();
  const InterruptGuard guard;
  live::LiveSummary summary;
  try {
    summary = live::run_live(
        *source, slam, [] { return InterruptGuard::interrupted(); },
        [&](const live::LiveUpdate& update) {
          output.show(update);
          keeping.take(update);
          ros2.take(update);
        },
        tell, [&](Slam& run) { keeping.between(run); });
  } catch (...) {
    keeping.finish(slam);
    throw;
  }
  output.end();
  tell(fmt::format("{} scans, {} left out because they came faster than they were used, at most {:.1f} ms late",
                   summary.scans, summary.dropped, summary.worst_latency_ms));
  if (!keeping.finish(slam)) throw SystemError("live", "not all that was to be kept could be written");
  if (summary.scans == 0 && !InterruptGuard::interrupted()) return fail("not one scan came", kAnswerIsNo);
  return kDone;
}

}  // namespace

void add_live_command(CLI::App& app, CommandBody& body) {
  auto* command = app.add_subcommand("live", "a sensor plugged in, poses as they come");
  auto flags = std::make_shared<LiveFlags>();
  command
      ->add_option("--port", flags->port,
                   "auto, a device, tcp:HOST:PORT, udp:HOST:PORT, a file that --raw wrote, or ros2:/TOPIC")
      ->type_name("PORT")
      ->check(not_empty());
  command->add_option("--replay", flags->replay, "a log of any readable format, at its pace")
      ->type_name("LOG")
      ->check(not_empty());
  command->add_flag("--demo", flags->demo, "a simulated sensor");
  command->add_option("--sensor", flags->sensor, "which sensor it is; else it is found by asking and listening")
      ->type_name("S")
      ->check(not_empty());
  command->add_flag("--json", flags->json, "a JSON line per scan on standard output");
  command->add_option("--raw", flags->raw, "keeps the bytes as they come, with their times")
      ->type_name("FILE")
      ->check(not_empty());
  command->add_flag("--ros2", flags->ros2, "publishes transforms, pose, map, path and scans to ROS 2 (ROS_DOMAIN_ID)");
  command->add_flag("--list", flags->list, "ports found and sensors known");
  add_keeping_flags(*command, flags->keeping);
  add_log_flags(*command, flags->options);
  add_config_flag(*command, flags->common);
  add_seed_flag(*command, flags->common);
  command->footer("Example:\n  phasescan live --port auto");
  command->callback([flags, &body] { body = [flags] { return run_live_command(*flags); }; });
}

}  // namespace phasescan::app
