// phasescan merge STATE... --out DIR --save STATE: saved runs become one map.
#include <cstdio>
#include <memory>
#include <optional>

#include "command_list.hpp"
#include "commands.hpp"
#include "in_the_way.hpp"
#include "io/file.hpp"
#include "io/leftovers.hpp"
#include "merged_run.hpp"
#include "people.hpp"
#include "phasescan/io/error.hpp"
#include "saved_run.hpp"
#include "slam_ending.hpp"
#include "slam_output.hpp"

namespace phasescan::app {
namespace {

struct MergeFlags {
  CommonFlags common;
  std::vector<std::string> states;
  std::string out, save;
  bool update = false;
};

SlamOptions options_of(const MergeFlags& flags, const std::vector<LoadedRun>& loaded) {
  refuse_other_keeping(flags.states, loaded);
  const std::string& file = flags.common.config;
  SlamOptions options = file.empty()
                            ? common_options(flags.states, loaded)
                            : options_to_go_on(loaded[begun_first(loaded)].saved, file, config_from(flags.common).slam);
  options.map.update = options.map.update || flags.update;
  return options;
}

SlamState merged_state(const MergeFlags& flags, std::vector<LoadedRun> loaded, const SlamOptions& options,
                       SlamRun& run) {
  std::vector<SlamState> states;
  for (const LoadedRun& one : loaded) states.push_back(one.saved.state);
  MergedStates merged = merge_states(states, options);
  run = merge_runs(flags.states, loaded, merged.order);
  return std::move(merged.state);
}

int run_merge(const MergeFlags& flags) {
  std::vector<LoadedRun> loaded;
  for (const std::string& path : flags.states) {
    loaded.push_back(load_run(path));
    if (loaded.back().saved.state.scans() == 0)
      throw InputError(path, 0, "holds no scan; expected a saved run with some");
  }
  refuse_same_drive(flags.states, loaded);
  const SlamOptions options = options_of(flags, loaded);
  refuse_in_the_way("--save", flags.save, {}, flags.out);
  make_folder(flags.out);
  const InterruptGuard guard;  // what is done is written whole
  SlamRun run;
  const SlamState state = merged_state(flags, std::move(loaded), options, run);
  run.times = false;
  run.deskew_asked = options.odometry.deskew;
  run.glass_blocks = options.glass.block;
  if (!flags.save.empty()) {
    drop_leftovers(flags.save);
    save_run(flags.save, state, options, run);
  }
  Slam slam(state, options);
  const SlamResult result = slam.finish();
  run.odometry_used = result.wheels.steps > 0;
  run.odometry_assumed = run.source.assumed;
  FileSet files = slam_output(flags.out, result, run);
  write_parts(flags.out, result, run);
  files.commit();
  warn_of_result(result, run, flags.out);
  print_ending(slam_ending(result, run, flags.out));
  if (!result.keyframes.empty()) return report_verdict(result, run, kDone);
  std::fprintf(stderr, "phasescan: %s: not one scan with enough returns to match\n", flags.states.front().c_str());
  return kAnswerIsNo;
}

}  // namespace

void add_merge_command(CLI::App& app, CommandBody& body) {
  auto* command = app.add_subcommand("merge", "one map from several saved runs, with no guess");
  auto flags = std::make_shared<MergeFlags>();
  command->add_option("STATE", flags->states, "runs saved by slam --save; the map has the frame of the first")
      ->required();
  command->add_option("--out", flags->out, "folder for trajectory, map, graph, report")->required()->type_name("DIR");
  command->add_option("--save", flags->save, "keep the merged run, to go on from")
      ->type_name("STATE")
      ->check(not_empty());
  command->add_flag("--update", flags->update, "where a later drive looked, what earlier ones saw fades (map.update)");
  command->footer("Example:\n  phasescan merge monday.state tuesday.state --out both --save both.state");
  add_config_flag(*command, flags->common);
  command->callback([flags, &body] { body = [flags] { return run_merge(*flags); }; });
}

}  // namespace phasescan::app
