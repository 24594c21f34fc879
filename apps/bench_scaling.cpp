// phasescan bench scaling: how the time of a match grows with beams and with the size of the place.
#include "command_list.hpp"
#include "commands.hpp"
#include "eval/scaling.hpp"
#include "io/file.hpp"

namespace phasescan::app {
namespace {

struct ScalingFlags {
  CommonFlags common;
  ScalingSettings settings;
  std::string out;
};

int run_scaling(const ScalingFlags& flags) {
  if (flags.out.empty()) throw std::invalid_argument("bench scaling: no --out; expected the folder for the results");
  CommonFlags common = flags.common;
  const std::string names = common.method.empty() ? "global" : common.method;
  common.method.clear();
  const std::vector<BenchMethod> methods = bench_methods(names, config_from(common).match);
  make_folder(flags.out);
  ScalingSettings settings = flags.settings;
  settings.seed = common.seed;
  std::vector<ScalingCurve> curves = measure_scaling(ScalingAxis::kBeams, methods, settings);
  for (ScalingCurve& curve : measure_scaling(ScalingAxis::kRange, methods, settings))
    curves.push_back(std::move(curve));
  const std::string text = scaling_markdown(curves);
  FileSet files(flags.out);
  files.add("scaling.svg", scaling_svg(curves));
  files.add("scaling.md", text);
  files.commit();
  print(text);
  return kDone;
}

}  // namespace

void add_scaling_command(CLI::App& app, CommandBody& body) {
  auto* command = app.get_subcommand("bench")->add_subcommand(
      "scaling", "time against beams and range: scaling.md with fitted exponents, scaling.svg");
  auto flags = std::make_shared<ScalingFlags>();
  command->add_option("--out", flags->out, "folder for scaling.md and scaling.svg")->type_name("DIR");
  command->add_option("--method", flags->common.method, "comma-separated; without: global")->type_name("A,B");
  command->add_option("--count", flags->settings.pairs, "pairs for each value")
      ->type_name("N")
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str();
  command->add_option("--repeat", flags->settings.repeat, "match each pair N times and keep its fastest time")
      ->type_name("N")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  add_seed_flag(*command, flags->common);
  add_config_flag(*command, flags->common);
  command->footer("Example:\n  phasescan bench scaling");
  command->callback([flags, &body] { body = [flags] { return run_scaling(*flags); }; });
}

}  // namespace phasescan::app
