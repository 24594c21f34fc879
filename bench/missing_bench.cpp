// Missing-data features and their match ([Jiang19] Sec. 2.3): both scans together are to stay below 20 us.
#include <benchmark/benchmark.h>

#include "fft_icp/missing/from_missing.hpp"
#include "stage_data.hpp"

namespace phasescan {
namespace {

/// Every eighth of the circle a run of 15 degrees is missing.
Scan with_runs(Scan scan) {
  for (std::size_t i = 0; i < scan.size(); ++i) {
    if ((i * 24 / scan.size()) % 3 == 0) {
      scan.states[i] = BeamState::kNoReturn;
      scan.ranges[i] = std::numeric_limits<float>::quiet_NaN();
    }
  }
  return scan;
}

void missing_step(benchmark::State& state) {
  const Scan a = with_runs(bench::reference_scan(static_cast<int>(state.range(0))));
  const Scan b = with_runs(bench::moved_scan(static_cast<int>(state.range(0))));
  const MissingOptions options;
  MissingFinder finder;
  MissingMatcher matcher;
  MissingFeatures fa, fb;
  for (auto _ : state) {
    finder.find(a, 6.0, deg_to_rad(options.min_width_deg), fa);
    finder.find(b, 6.0, deg_to_rad(options.min_width_deg), fb);
    benchmark::DoNotOptimize(matcher.match(fa, fb, options));
  }
}
BENCHMARK(missing_step)->ArgName("beams")->Arg(90)->Arg(360)->Arg(720)->Arg(4000);

}  // namespace
}  // namespace phasescan
