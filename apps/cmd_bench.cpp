// phasescan bench: success, honesty, accuracy and time of methods on pairs files and simulated sets.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <optional>

#include "command_list.hpp"
#include "commands.hpp"
#include "eval/bench_report.hpp"
#include "io/file.hpp"
#include "people.hpp"
#include "sim/pairs_spec.hpp"

namespace phasescan::app {
namespace {

struct BenchFlags {
  CommonFlags common;
  std::vector<std::string> pairs;
  std::vector<std::string> sim;
  std::vector<std::string> variants;
  std::string out;
  std::string features;
  std::size_t count = 1000;
  int repeat = 1;
  bool prepared = false;
  bool seed_given = false;
};

/// All sources of the command, one after the other; after Ctrl-C there are no more pairs, and what was matched is
/// written.
PairSource chain(std::vector<PairSource> sources) {
  return [sources = std::move(sources), at = std::size_t{0}]() mutable -> std::optional<BenchPair> {
    for (; at < sources.size() && !InterruptGuard::interrupted(); ++at) {
      if (std::optional<BenchPair> pair = sources[at]()) return pair;
    }
    return std::nullopt;
  };
}

FileSet result_files(const std::string& folder, const BenchRun& run, const std::vector<BenchMethod>& methods,
                     const BenchInfo& info) {
  FileSet files(folder);
  const auto figures = bench_figures(run, methods, info);
  for (const std::string_view name : bench_figure_names()) {
    // Not every run has every figure; one of an earlier run must not stand beside this one's results.
    const auto figure = figures.find(std::string(name));
    if (figure == figures.end()) {
      files.leave_out(std::string(name));
    } else {
      files.add(figure->first, figure->second);
    }
  }
  files.add("results.md", bench_markdown(run, methods, info));
  files.add("results.json", bench_json(run, methods, info));
  return files;
}

/// A line per method over all pairs: right answers, and wrong ones that it called usable.
std::vector<EndingLine> bench_ending(const BenchRun& run, const std::vector<BenchMethod>& methods,
                                     const std::string& folder) {
  std::vector<EndingLine> lines{{"pairs", std::to_string(run.pairs)}};
  for (std::size_t m = 0; m < methods.size(); ++m) {
    std::size_t known = 0, right = 0, wrong_usable = 0;
    for (const PairOutcome& outcome : run.outcomes) {
      if (outcome.method != m) continue;
      known += outcome.has_truth;
      right += outcome.has_truth && outcome.right;
      wrong_usable += outcome.usable && !outcome.right;
    }
    const double share = known == 0 ? 0.0 : 100.0 * static_cast<double>(right) / static_cast<double>(known);
    lines.emplace_back(methods[m].name, fmt::format("{} of {} right ({:.1f} %), {} wrong and called usable", right,
                                                    known, share, wrong_usable));
  }
  lines.emplace_back("open", (std::filesystem::path(folder) / "results.md").string());
  return lines;
}

int run_bench_command(const BenchFlags& flags) {
  if (flags.out.empty()) throw std::invalid_argument("bench: no --out; expected the folder for the results");
  if (flags.pairs.empty() && flags.sim.empty())
    throw std::invalid_argument("bench: nothing to run; expected --pairs FILE... or --sim SPEC...");
  CommonFlags common = flags.common;
  const std::string names = common.method.empty() ? "icp,ndt,fft,fft-icp1,fft-icp2,global" : common.method;
  common.method.clear();
  std::vector<BenchMethod> methods;
  const Config config = config_from(common);
  try {
    methods = bench_methods(names, config.match);
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(std::string("--method: ") + error.what());
  }
  for (const std::string& text : flags.variants) methods.push_back(bench_variant(text, config.match));

  BenchInfo info{PHASESCAN_VERSION, {}, !common.no_times, flags.repeat, flags.prepared};
  std::vector<PairSource> sources;
  for (const std::string& path : flags.pairs) {
    sources.push_back(file_source(path));
    info.sources.push_back(path);
  }
  for (const std::string& name : flags.sim) {
    sim::PairsSpec spec = sim::read_pairs_spec(name);
    const std::uint64_t seed = flags.seed_given ? common.seed : spec.seed;
    sources.push_back(simulated_source(std::make_shared<const sim::PairGenerator>(std::move(spec), seed), flags.count,
                                       common.threads));
    info.sources.push_back(name + ": " + std::to_string(flags.count) + " simulated pairs, seed " +
                           std::to_string(seed));
  }
  make_folder(flags.out);  // before the work, so that a folder that cannot be made costs no minutes
  std::optional<AtomicFile> features;
  if (!flags.features.empty()) features.emplace(flags.features);
  Progress progress("pairs", flags.pairs.empty() ? flags.sim.size() * flags.count : 0);
  BenchSettings settings;
  settings.threads = common.threads;
  settings.repeat = flags.repeat;
  settings.prepared = flags.prepared;
  settings.progress = [&](std::size_t done) { progress.step(done); };
  const InterruptGuard guard;
  const BenchRun run = run_bench(chain(std::move(sources)), methods, settings);
  progress.end();
  if (InterruptGuard::interrupted() && run.pairs == 0) return stopped_with_nothing();
  if (InterruptGuard::interrupted())
    warn("stopped after " + std::to_string(run.pairs) + " pairs; the results are of these");
  FileSet files = result_files(flags.out, run, methods, info);
  if (features) {
    features->write(bench_features(run, methods));
    features->seal();
  }
  files.commit();
  if (features) features->commit();
  print_ending(bench_ending(run, methods, flags.out));
  return kDone;
}

}  // namespace

void add_bench_command(CLI::App& app, CommandBody& body) {
  auto* command = app.add_subcommand("bench", "success, honesty, accuracy and time per method, class and dataset");
  auto flags = std::make_shared<BenchFlags>();
  command->add_option("--pairs", flags->pairs, "pairs files with truth (.jsonl, .jsonl.gz)")->type_name("FILE...");
  command->add_option("--sim", flags->sim, "simulated sets: YAML files or built-in names such as bench-sim")
      ->type_name("SPEC...");
  command->add_option("--out", flags->out, "folder for results.json, results.md and the figures")->type_name("DIR");
  command->add_option("--method", flags->common.method, "comma-separated; without: all six")
      ->type_name("A,B")
      ->check(offers(enum_names<MatchMethod>()));
  command->footer("Example:\n  phasescan bench --pairs pairs.jsonl.gz --method icp,global --out results");
  command->add_option("--features", flags->features, "also write what each confidence was computed from, as CSV")
      ->type_name("FILE");
  command->add_flag("--fast", flags->common.fast, "trade a little robustness for time (global)");
  command->add_option("--count", flags->count, "pairs of each simulated set")
      ->type_name("N")
      ->check(CLI::Range(1, 100'000'000))
      ->capture_default_str();
  command->add_option("--repeat", flags->repeat, "match each pair N times and keep its fastest time")
      ->type_name("N")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command->add_flag("--prepared", flags->prepared, "prepare the references beforehand, outside of the times");
  command
      ->add_option("--variant", flags->variants,
                   "one more column: the method with other options (\"no twins: global.twins=false\"); may be repeated")
      ->type_name("NAME: SECTION.OPTION=VALUE,..")
      ->allow_extra_args(false);
  auto* seed =
      command->add_option("--seed", flags->common.seed, "seed of the simulated sets; without: the one in the file")
          ->type_name("N")
          ->check(whole_number_from(0));
  add_threads_flag(*command, flags->common);
  add_config_flag(*command, flags->common);
  add_sensor_flag(*command, flags->common);
  add_no_times_flag(*command, flags->common);
  command->callback([flags, command, seed, &body] {
    if (!command->get_subcommands().empty()) return;
    flags->seed_given = seed->count() > 0;
    body = [flags] { return run_bench_command(*flags); };
  });
}

}  // namespace phasescan::app
