// phasescan emulate: a sensor that is not there, on a pseudo-terminal or a network port.
#include "command_list.hpp"
#include "commands.hpp"
#include "core/random.hpp"
#include "emulate/emulator.hpp"
#include "io/file.hpp"
#include "sim/world_file.hpp"

namespace phasescan::app {
namespace {

struct EmulateFlags {
  CommonFlags common;
  std::string sensor = "rplidar-a1", world = "flat", path = "tour";
  emulate::EmulatorOptions what;
  double delay_ms = 0.0;
  int tcp_port = 0, udp_port = 0;
};

int run_emulate_command(EmulateFlags flags) {
  const live::SensorModel* model = live::find_sensor(flags.sensor);
  if (model == nullptr)
    throw std::invalid_argument("--sensor: " + quote_text(flags.sensor) +
                                " is not known; expected one that `phasescan live --list` names");
  emulate::EmulatorOptions options = std::move(flags.what);
  options.model = *model;
  options.world = sim::world_by_name(flags.world, flags.common.seed);
  options.path.kind = enum_of_flag<sim::PathKind>("--path", flags.path);
  options.seed = flags.common.seed;
  options.faults.delay_s = 1e-3 * flags.delay_ms;
  // An RPLIDAR without a serial line speaks UDP.
  options.udp |= flags.udp_port > 0 || (model->protocol == live::Protocol::kRplidar && model->baud == 0);
  options.tcp |= flags.tcp_port > 0 || model->protocol == live::Protocol::kSick;
  if (options.tcp && options.udp) throw std::invalid_argument("--tcp, --udp: expected one of them");
  options.network_port = options.udp ? flags.udp_port : flags.tcp_port;
  const InterruptGuard guard;
  emulate::run_emulator(
      options,
      [](const std::string& name) {
        print(name + "\n");
        flush();
      },
      [] { return InterruptGuard::interrupted(); });
  return kDone;
}

}  // namespace

void add_emulate_command(CLI::App& app, CommandBody& body) {
  auto* command = app.add_subcommand("emulate", "a sensor that is not there, on a pseudo-terminal or a network port");
  auto flags = std::make_shared<EmulateFlags>();
  emulate::Faults& faults = flags->what.faults;
  const auto share = [command](const char* name, double& value, const char* what) {
    command->add_option(name, value, what)->check(CLI::Range(0.0, 1.0))->capture_default_str();
  };
  const auto seconds = [command](const char* name, double& value, const char* what) {
    command->add_option(name, value, what)->type_name("S")->check(number_from_zero());
  };
  command->add_option("--sensor", flags->sensor, "a sensor of `phasescan live --list`")
      ->capture_default_str()
      ->check(not_empty());
  command->add_option("--world", flags->world, "a kind of world, KIND:SEED, or a YAML file")->capture_default_str();
  command->add_option("--path", flags->path, "tour, circle, back-and-forth, turn or stand")->capture_default_str();
  command->add_option("--speed", flags->what.path.speed_mps, "m/s, at most")
      ->check(number_from_zero())
      ->capture_default_str();
  command->add_option("--duration", flags->what.path.duration_s, "seconds; 0: one round of a tour, else 60 s")
      ->check(number_from_zero());
  command->add_flag("--tcp", flags->what.tcp, "a TCP port of this machine instead of a pseudo-terminal");
  command->add_option("--tcp-port", flags->tcp_port, "which; 0: any that is free")->check(CLI::Range(0, 65535));
  command->add_flag("--udp", flags->what.udp, "a UDP port, likewise");
  command->add_option("--udp-port", flags->udp_port, "which; 0: any that is free")->check(CLI::Range(0, 65535));
  command->add_option("--link", flags->what.alias, "a name for the pseudo-terminal that stays")->type_name("PATH");
  command->add_option("--truth", flags->what.truth, "where the sensor was, written at the end")->type_name("FILE.tum");
  share("--drop", faults.drop, "share of the bytes that are lost");
  share("--repeat", faults.repeat, "share of the bytes that come twice");
  share("--corrupt", faults.corrupt, "share of the bytes with a wrong bit");
  command->add_option("--delay", flags->delay_ms, "ms that bytes are held back for")->check(number_from_zero());
  seconds("--stall-at", faults.stall_at_s, "nothing comes from then on");
  seconds("--stall-for", faults.stall_s, "and for so long");
  seconds("--unplug-at", faults.unplug_at_s, "the port is gone from then on");
  seconds("--replug-after", faults.replug_s, "and for so long");
  seconds("--fault-every", faults.every_s, "stall and unplugging come again after so long");
  command->add_option("--health", faults.health, "what the sensor says of itself: 0 good, 1 warning, 2 fault")
      ->check(CLI::Range(0, 2));
  add_seed_flag(*command, flags->common);
  command->footer("Example:\n  phasescan emulate --sensor ld06 --world flat");
  command->callback([flags, &body] { body = [flags] { return run_emulate_command(*flags); }; });
}

}  // namespace phasescan::app
