// The default matcher by stage and as a whole, on simulated RPLidar A1 pairs.
#include <benchmark/benchmark.h>

#include "match/global_search.hpp"
#include "phasescan/match/scan_matcher.hpp"
#include "sim/pairs_spec.hpp"

namespace phasescan {
namespace {

const std::vector<ScanPair>& some_pairs() {
  static const std::vector<ScanPair> kPairs = [] {
    const sim::PairGenerator generator(sim::read_pairs_spec("bench-sim"), 4711);
    std::vector<ScanPair> pairs;
    for (std::uint64_t k = 0; k < 100; ++k) pairs.push_back(generator.make(k).pair);
    return pairs;
  }();
  return kPairs;
}

void prepare(benchmark::State& state) {
  const GlobalSearch search{GlobalOptions{}};
  const PrepareOptions options = search.prepare_options(state.range(0) != 0);
  PrepareWorkspace work;
  PreparedScan prepared;
  std::size_t k = 0;
  for (auto _ : state) prepare_scan(some_pairs()[k++ % some_pairs().size()].reference, {}, options, work, prepared);
}
BENCHMARK(prepare)->ArgName("as_reference")->Arg(0)->Arg(1);

void match(benchmark::State& state) {
  MatchOptions options;
  options.match.fast = state.range(0) != 0;
  ScanMatcher matcher(options);
  std::size_t k = 0;
  for (auto _ : state) {
    const ScanPair& pair = some_pairs()[k++ % some_pairs().size()];
    benchmark::DoNotOptimize(matcher.match(pair.reference, pair.scan));
  }
}
BENCHMARK(match)->ArgName("fast")->Arg(0)->Arg(1);

void match_prepared(benchmark::State& state) {
  MatchOptions options;
  options.match.fast = state.range(0) != 0;
  ScanMatcher matcher(options);
  std::vector<Reference> references;
  for (const ScanPair& pair : some_pairs()) references.push_back(matcher.prepare(pair.reference));
  std::size_t k = 0;
  for (auto _ : state) {
    const std::size_t i = k++ % references.size();
    benchmark::DoNotOptimize(matcher.match(references[i], some_pairs()[i].scan));
  }
}
BENCHMARK(match_prepared)->ArgName("fast")->Arg(0)->Arg(1);

}  // namespace
}  // namespace phasescan
