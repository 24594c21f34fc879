// phasescan live: a sensor plugged in, poses as they come.
#include <fmt/format.h>

#include <memory>
#include <optional>
#include <vector>

#include "command_list.hpp"
#include "commands.hpp"
#include "live/port.hpp"
#include "live_commands.hpp"
#include "live_health.hpp"
#include "live_keeping.hpp"
#include "live_output.hpp"
#include "live_ros2.hpp"
#include "live_serve.hpp"
#include "live_sources.hpp"
#include "live_tracking.hpp"
#include "phasescan/io/error.hpp"
#include "phasescan/live/live.hpp"

namespace phasescan::app {
namespace {

struct LiveFlags {
  CommonFlags common;
  LogOptions options;
  TrackingFlags tracking;
  KeepingFlags keeping;
  std::string port, replay, sensor, raw, serve, folder = ".";
  bool demo = false, json = false, list = false, ros2 = false;
  std::string health;  ///< of a run that is asked
};

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

/// Where scans come from; `replay` is the same where it is a log.
struct Source {
  std::unique_ptr<live::LiveSource> source;
  ReplaySource* replay = nullptr;
};

Source source_of(const LiveFlags& flags, LiveRos2& ros2) {
  const int sources = (flags.port.empty() ? 0 : 1) + (flags.replay.empty() ? 0 : 1) + (flags.demo ? 1 : 0);
  if (sources != 1) throw std::invalid_argument("live: expected one of --port PORT, --replay LOG, --demo");
  if (flags.demo) return {demo_source(flags.common.seed)};
  if (LiveRos2::is_topic(flags.port)) return {ros2.open(flags.port)};
  if (flags.replay.empty()) return {sensor_source(flags.port, flags.sensor, flags.raw, flags.options)};
  auto replay = replay_source(flags.replay, flags.options);
  ReplaySource* steered = replay.get();
  return {std::move(replay), steered};
}

std::string source_text(const LiveFlags& flags) {
  if (flags.demo) return "demo";
  return flags.replay.empty() ? flags.port : flags.replay;
}

void check_flags(const LiveFlags& flags) {
  if (!flags.raw.empty() && flags.port.empty())
    throw std::invalid_argument("--raw: keeps what a port sends; expected --port with it");
  const TrackingFlags& tracking = flags.tracking;
  if (!tracking.map.empty() && !tracking.state.empty())
    throw std::invalid_argument("--map, --state: expected one of them: the map that is known");
  if (!tracking.known_map() && tracking.keep_prepared)
    throw std::invalid_argument("--keep-prepared: keeps a known map; expected --map or --state with it");
  if (tracking.known_map() && !tracking.resume.empty())
    throw std::invalid_argument("--resume: goes on with a map that grows; expected it without --map and --state");
  if (tracking.known_map() && !flags.keeping.save.empty())
    throw std::invalid_argument("--save: a known map stays as it is; expected it without --map and --state");
}

int run_live_command(const LiveFlags& flags) {
  if (flags.list) return print_list();
  if (!flags.health.empty()) return run_health(flags.health);
  check_flags(flags);
  LiveOutput output(flags.json);
  LiveTracking tracking(flags.tracking, flags.common);
  live::LiveTasks tasks;
  serve::StatusBoard board(source_text(flags));
  const auto tell = [&](const std::string& text) {
    output.tell(text);
    board.tell(text);
  };
  std::optional<LiveSaver> saver;
  if (tracking.slam() != nullptr) saver.emplace(*tracking.slam(), flags.folder);
  LiveRecording recording(flags.folder, tell);
  LiveCommands commands(tracking.engine(), tasks, saver ? &*saver : nullptr, &recording);
  const LiveShow show(tracking.options(), board, commands);
  LiveRos2 ros2(flags.ros2 || LiveRos2::is_topic(flags.port));
  Source from = source_of(flags, ros2);
  commands.set_replay(from.replay);
  LiveKeeping keeping(flags.keeping, tracking.slam(), tracking.options().slam.autosave_s, tell);
  if (flags.ros2)
    ros2.publish(
        tracking.options().map, flags.tracking.known_map(), [&](const Pose2& T_map_base, const Eigen::Matrix3d&) {
          commands.set_pose(T_map_base, [tell](bool, const std::string& text) { tell("initialpose: " + text); });
        });
  from.source = tracking.joined(std::move(from.source));
  if (from.replay == nullptr) tracking.forget_beginning();  // only a log begins again
  const InterruptGuard guard;
  const std::unique_ptr<serve::Server> server =
      serve_run(flags.serve, live_router(show), [&](const std::string& text) { output.tell(text); });
  if (server && from.replay != nullptr) from.replay->set_watched([&] { return server->counts().web_sockets > 0; });
  std::vector<live::LiveSink*> sinks{&output, &keeping, &board, &ros2};
  if (server) sinks.insert(sinks.end(), {&recording, show.viewer.get(), show.foxglove.get()});
  live::LiveSummary summary;
  try {
    summary = live::run_live(
        *from.source, tracking.engine(), sinks, &tasks, [] { return InterruptGuard::interrupted(); }, tell,
        [&] { keeping.between(); });
  } catch (...) {
    if (saver) saver->wait();
    keeping.finish();
    throw;
  }
  if (saver) saver->wait();  // its answer goes through the server
  output.end();
  tell(fmt::format("{} scans, {} left out because they came faster than they were used, at most {:.1f} ms late",
                   summary.scans, summary.dropped, summary.worst_latency_ms));
  if (!keeping.finish()) throw SystemError("live", "not all that was to be kept could be written");
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
  command
      ->add_option("--sensor", flags->sensor,
                   "which sensor it is, else it is found by asking and listening; or a file of `calibrate`")
      ->type_name("S|FILE")
      ->check(not_empty());
  command->add_flag("--json", flags->json, "a JSON line per scan on standard output");
  command->add_option("--raw", flags->raw, "keeps the bytes as they come, with their times")
      ->type_name("FILE")
      ->check(not_empty());
  command
      ->add_option("--serve", flags->serve,
                   "where the run is shown: a page, its status, other protocols; 'off': nowhere")
      ->type_name("ADDR:PORT")
      ->default_str("127.0.0.1:8080")
      ->check(not_empty());
  command->add_option("--folder", flags->folder, "where the page saves maps and states")
      ->type_name("DIR")
      ->capture_default_str()
      ->check(not_empty());
  command
      ->add_option("--health", flags->health,
                   "asks a run at its address whether it is well: exit 0 yes, 1 no, 3 no answer")
      ->type_name("http://ADDR:PORT")
      ->check(not_empty());
  command->add_flag("--ros2", flags->ros2, "publishes transforms, pose, map, path and scans to ROS 2 (ROS_DOMAIN_ID)");
  command->add_flag("--list", flags->list, "ports found and sensors known");
  add_map_flags(*command, flags->tracking);
  add_keeping_flags(*command, flags->keeping);
  add_log_flags(*command, flags->options);
  add_to_flag(*command, flags->options);
  add_config_flag(*command, flags->common);
  add_seed_flag(*command, flags->common);
  command->footer("Example:\n  phasescan live --port auto");
  command->callback([flags, &body] { body = [flags] { return run_live_command(*flags); }; });
}

}  // namespace phasescan::app
