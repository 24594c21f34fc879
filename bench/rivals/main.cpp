// rivals --pairs FILE... [--sim SPEC --count N] --out DIR: our matchers and other people's over the same pairs, in one
// run.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <iterator>

#include "contender.hpp"
#include "eval/bench.hpp"
#include "phasescan/io/error.hpp"
#include "io/file.hpp"
#include "io/pairs.hpp"
#include "sim/pairs.hpp"
#include "sim/pairs_spec.hpp"
#include "report.hpp"
#include "run.hpp"

namespace phasescan::rivals {
namespace {

struct Arguments {
  std::vector<std::string> files;
  std::string sim;
  std::uint64_t count = 400;
  std::uint64_t seed = 0;
  std::vector<std::string> only;
  std::string out;
  std::string note;
  int repeat = 1;
};

/// Pairs of a file. One that names a single dataset is called after the file: two files may be of the same place.
std::vector<ScanPair> load(const std::string& path) {
  std::vector<ScanPair> pairs = read_pairs(path);
  const bool one =
      std::all_of(pairs.begin(), pairs.end(), [&](const ScanPair& p) { return p.dataset == pairs.front().dataset; });
  std::string name = std::filesystem::path(path).filename().string();
  name.resize(std::min(name.find(".jsonl"), name.size()));
  for (ScanPair& pair : pairs) {
    if (one) pair.dataset = name;
  }
  return pairs;
}

std::vector<ScanPair> simulate(const Arguments& arguments) {
  sim::PairsSpec spec = sim::read_pairs_spec(arguments.sim);
  const std::uint64_t seed = arguments.seed != 0 ? arguments.seed : spec.seed;
  const sim::PairGenerator generator(std::move(spec), seed);
  std::vector<ScanPair> pairs;
  for (std::uint64_t k = 0; k < arguments.count; ++k) pairs.push_back(generator.make(k).pair);
  return pairs;
}

/// The contenders that were built in, and of those the ones asked for.
std::vector<Contender> choose(const std::vector<std::string>& only) {
  std::vector<Contender> all = own_contenders();
  [[maybe_unused]] const auto add = [&](std::vector<Contender> more) {
    std::move(more.begin(), more.end(), std::back_inserter(all));
  };
#ifdef PHASESCAN_RIVALS_PCL
  add(pcl_contenders());
#endif
#ifdef PHASESCAN_RIVALS_MRPT
  add(mrpt_contenders());
#endif
#ifdef PHASESCAN_RIVALS_OPENCV
  add(opencv_contenders());
#endif
  if (only.empty()) return all;
  std::erase_if(all, [&](const Contender& c) {
    return std::none_of(only.begin(), only.end(),
                        [&](const std::string& part) { return c.name.find(part) != std::string::npos; });
  });
  if (all.empty())
    throw std::invalid_argument(fmt::format("--only: no matcher has '{}' in its name", fmt::join(only, "' or '")));
  return all;
}

void compare(const Arguments& arguments) {
  const std::vector<Contender> contenders = choose(arguments.only);
  ReportInfo info;
  info.version = PHASESCAN_VERSION;
  info.note = arguments.note;
  info.repeat = arguments.repeat;
  std::vector<ScanPair> pairs;
  const auto add = [&](std::vector<ScanPair> more, const std::string& source) {
    std::move(more.begin(), more.end(), std::back_inserter(pairs));
    info.sources.push_back(source);
  };
  for (const std::string& file : arguments.files) add(load(file), std::filesystem::path(file).filename().string());
  if (!arguments.sim.empty()) {
    add(simulate(arguments), fmt::format("{} simulated pairs of {}, seed {}", arguments.count,
                                         std::filesystem::path(arguments.sim).filename().string(),
                                         arguments.seed != 0 ? fmt::format("{}", arguments.seed) : "of the file"));
  }
  info.without_truth = std::erase_if(pairs, [](const ScanPair& pair) { return !pair.truth; });
  info.pairs = pairs.size();
  if (pairs.empty()) throw std::invalid_argument("no pair with a truth");
  make_folder(arguments.out);

  RunSettings settings;
  settings.repeat = arguments.repeat;
  settings.done = [](const std::string& name, std::size_t threw) {
    fmt::print(stderr, "{}: done{}\n", name, threw > 0 ? fmt::format(", {} pairs ended in an exception", threw) : "");
  };
  const std::vector<PairOutcome> outcomes = run(pairs, contenders, settings);
  info.fft_ms = time_reference_fft();
  const std::string text = markdown(outcomes, contenders, info);
  write_file(arguments.out + "/rivals.md", text);
  write_file(arguments.out + "/results.json", json(outcomes, contenders, info));
  fmt::print("{}", text);
}

}  // namespace
}  // namespace phasescan::rivals

int main(int argc, char** argv) {
  phasescan::rivals::Arguments arguments;
  CLI::App app{"phasescan's matchers and other people's over the same pairs, in one run"};
  app.add_option("--pairs", arguments.files, "pairs files (.jsonl, .jsonl.gz)");
  app.add_option("--sim", arguments.sim,
                 "simulated pairs as well: a configs/bench-*.yaml, or the name of a built-in one");
  app.add_option("--count", arguments.count, "how many of them, all classes and rows together")->capture_default_str();
  app.add_option("--seed", arguments.seed, "their seed; 0: that of the file")->capture_default_str();
  app.add_option("--only", arguments.only, "matchers with one of these in their name (comma-separated)")
      ->delimiter(',');
  app.add_option("--repeat", arguments.repeat, "runs per match, the fastest counts")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  app.add_option("--note", arguments.note, "said in the report: date and machine");
  app.add_option("--out", arguments.out, "folder for rivals.md and results.json")->required();
  CLI11_PARSE(app, argc, argv);
  try {
    phasescan::rivals::compare(arguments);
    return 0;
  } catch (const phasescan::SystemError& error) {
    fmt::print(stderr, "rivals: {}\n", error.what());
    return 3;
  } catch (const std::exception& error) {
    fmt::print(stderr, "rivals: {}\n", error.what());
    return 2;
  }
}
