// A whole match, from raw ranges of both scans and against a prepared reference, for every method.
#include <benchmark/benchmark.h>

#include "methods/any_matcher.hpp"
#include "stage_data.hpp"

namespace phasescan {
namespace {

void run(benchmark::State& state, bool prepared) {
  AnyMatchOptions options;
  options.match.method = static_cast<MatchMethod>(state.range(0));
  state.SetLabel(std::string(to_string(options.match.method)));
  const int beams = static_cast<int>(state.range(1));
  const Scan reference = bench::reference_scan(beams), scan = bench::moved_scan(beams);
  AnyMatcher matcher(options);
  const AnyReference kept = matcher.prepare(reference);
  for (auto _ : state) {
    benchmark::DoNotOptimize(prepared ? matcher.match(kept, scan) : matcher.match(reference, scan));
  }
}

void raw(benchmark::State& state) {
  run(state, false);
}
void against_prepared(benchmark::State& state) {
  run(state, true);
}

BENCHMARK(raw)->ArgNames({"method", "beams"})->ArgsProduct({{0, 1, 2, 3, 4, 5}, {90, 360, 720, 4000}});
BENCHMARK(against_prepared)->ArgNames({"method", "beams"})->ArgsProduct({{0, 1, 2, 3, 4, 5}, {360}});

}  // namespace
}  // namespace phasescan
