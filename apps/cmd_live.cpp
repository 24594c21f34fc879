// phasescan live: a sensor plugged in, poses as they come.
#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <memory>
#include <tuple>
#include <vector>

#include "command_list.hpp"
#include "commands.hpp"
#include "io/file.hpp"
#include "live/port.hpp"
#include "live_commands.hpp"
#include "live_serve.hpp"
#include "live_sources.hpp"
#include "people.hpp"
#include "phasescan/live/live.hpp"

namespace phasescan::app {
namespace {

struct LiveFlags {
  CommonFlags common;
  LogOptions options;
  std::string port, replay, sensor, raw, serve, folder = ".";
  bool demo = false, json = false, list = false;
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

/// Where scans come from; `replay` is the same where it is a log.
struct Source {
  std::unique_ptr<live::LiveSource> source;
  ReplaySource* replay = nullptr;
};

Source source_of(const LiveFlags& flags) {
  const int sources = (flags.port.empty() ? 0 : 1) + (flags.replay.empty() ? 0 : 1) + (flags.demo ? 1 : 0);
  if (sources != 1) throw std::invalid_argument("live: expected one of --port PORT, --replay LOG, --demo");
  if (flags.demo) return {demo_source(flags.common.seed)};
  if (flags.replay.empty()) return {live::open_sensor(flags.port, flags.sensor, flags.raw)};
  auto replay = replay_source(flags.replay, flags.options);
  ReplaySource* steered = replay.get();
  return {std::move(replay), steered};
}

/// Poses for who called the command: JSON lines, a line that is written over, or a line where the status changes.
class ConsoleSink final : public live::LiveSink {
 public:
  ConsoleSink(bool json, bool terminal) : json_(json), terminal_(terminal) {}
  void take(const live::LiveUpdate& update) override {
    if (json_) {
      print(json_line(update));
      flush();
      return;
    }
    const Pose2 pose = update.update.T_map_base();
    if (terminal_) {
      std::fprintf(stderr, "\r%-12s x %7.2f m  y %7.2f m  heading %6.1f deg  %5.1f ms ",
                   to_string(update.update.status), pose.x, pose.y, rad_to_deg(pose.theta), update.latency_ms);
    } else if (to_string(update.update.status) != before_) {
      before_ = to_string(update.update.status);
      std::fprintf(stderr, "phasescan: %s\n", before_.c_str());
    }
  }

 private:
  bool json_, terminal_;
  std::string before_;
};

std::string source_text(const LiveFlags& flags) {
  if (flags.demo) return "demo";
  return flags.replay.empty() ? flags.port : flags.replay;
}

int run_live_command(const LiveFlags& flags) {
  if (flags.list) return print_list();
  if (!flags.raw.empty() && flags.port.empty())
    throw std::invalid_argument("--raw: keeps what a port sends; expected --port with it");
  const Config config = config_from(flags.common);
  const Source from = source_of(flags);
  ThreadExecutor executor;
  Slam slam(config.slam, Schedule::kLatest, &executor);
  const std::unique_ptr<live::LiveEngine> engine =
      live::slam_engine(slam, [&] { return Slam(config.slam, Schedule::kLatest, &executor); });
  live::LiveTasks tasks;
  const InterruptGuard guard;
  const bool terminal = ::isatty(STDERR_FILENO) != 0 && !flags.json;
  ConsoleSink console(flags.json, terminal);
  LiveSaver saver(slam, flags.folder);
  LiveCommands commands(*engine, tasks, from.replay, &saver);
  LiveShow show(source_text(flags), config.slam, commands);
  std::vector<live::LiveSink*> sinks{&console, &show.board};
  const auto tell = [&](const std::string& text) {
    std::fprintf(stderr, "%sphasescan: %s\n", terminal ? "\n" : "", text.c_str());
    show.board.tell(text);
  };
  const std::unique_ptr<serve::Server> server = serve_run(flags.serve, live_router(show), tell);
  if (server) sinks.push_back(show.viewer.get());
  if (server && from.replay != nullptr) from.replay->set_watched([&] { return server->counts().web_sockets > 0; });
  const live::LiveSummary summary = live::run_live(
      *source, *engine, sinks, &tasks, [] { return InterruptGuard::interrupted(); }, tell);
  saver.wait();  // its answer goes through the server
  if (terminal) std::fprintf(stderr, "\n");
  tell(fmt::format("{} scans, {} left out because they came faster than they were used, at most {:.1f} ms late",
                   summary.scans, summary.dropped, summary.worst_latency_ms));
  if (summary.scans == 0 && !InterruptGuard::interrupted()) return fail("not one scan came", kAnswerIsNo);
  return kDone;
}

}  // namespace

void add_live_command(CLI::App& app, CommandBody& body) {
  auto* command = app.add_subcommand("live", "a sensor plugged in, poses as they come");
  auto flags = std::make_shared<LiveFlags>();
  command->add_option("--port", flags->port, "auto, a device, tcp:HOST:PORT, udp:HOST:PORT, or a file that --raw wrote")
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
  command->add_flag("--list", flags->list, "ports found and sensors known");
  add_log_flags(*command, flags->options);
  add_config_flag(*command, flags->common);
  add_seed_flag(*command, flags->common);
  command->footer("Example:\n  phasescan live --port auto");
  command->callback([flags, &body] { body = [flags] { return run_live_command(*flags); }; });
}

}  // namespace phasescan::app
