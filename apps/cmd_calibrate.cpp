// phasescan calibrate LOG --out SENSOR.yaml: what a sensor does, measured where it stands still.
#include <memory>

#include <filesystem>

#include "calibrate/calibrate.hpp"
#include "command_list.hpp"
#include "in_the_way.hpp"
#include "io/file.hpp"
#include "people.hpp"
#include "phasescan/io/error.hpp"

namespace phasescan::app {
namespace {

struct CalibrateFlags {
  std::string log;
  std::string out;
  LogOptions options;
};

int run_calibrate(const CalibrateFlags& flags) {
  refuse_in_the_way("--out", flags.out, {flags.log}, "");
  const auto reader = open_log(flags.log, flags.options);
  Calibrator calibrator;
  Progress progress("read", *reader);
  const InterruptGuard guard;
  std::size_t read = 0;
  while (!InterruptGuard::interrupted()) {
    const auto entry = reader->next();
    if (!entry) break;
    calibrator.add(*entry);
    progress.step(++read);
  }
  progress.end();
  if (InterruptGuard::interrupted()) return stopped_with_nothing();
  if (read == 0 && reader->damage_count() > 0) return fail_unreadable(*reader, flags.log);
  if (calibrator.of_other_lasers() > 0)
    warn(flags.log + ": " + std::to_string(calibrator.of_other_lasers()) +
         " scans are of other lasers than the first one and were left out; --topic chooses");
  const auto calibration = calibrator.finish();
  const int code = report_damages(*reader, kDone);
  if (!calibration) {
    return fail(
        InputError(flags.log, 0,
                   "holds no stop that says what the sensor does; expected a robot at rest for 9 scans and more "
                   "(15 where the log has no odometry) in view of walls")
            .what(),
        kAnswerIsNo);
  }
  write_file(flags.out, format_sensor_file(*calibration, std::filesystem::path(flags.log).filename().string()));
  print(format_calibration(*calibration));
  print_ending({{"scans", std::to_string(read)}, {"wrote", flags.out + " (for --sensor)"}});
  return code;
}

}  // namespace

void add_calibrate_command(CLI::App& app, CommandBody& body) {
  auto* command = app.add_subcommand("calibrate", "what a sensor does, measured where it stands still: a sensor file");
  auto flags = std::make_shared<CalibrateFlags>();
  command->add_option("LOG", flags->log, "a log of any readable format in which the robot stops now and then")
      ->required();
  command->add_option("--out", flags->out, "the sensor file (YAML), for --sensor FILE")->required();
  command->footer("Example:\n  phasescan calibrate drive.jsonl --out sensor.yaml");
  add_log_flags(*command, flags->options);
  add_to_flag(*command, flags->options);
  command->callback([flags, &body] { body = [flags] { return run_calibrate(*flags); }; });
}

}  // namespace phasescan::app
