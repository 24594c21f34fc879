// NDT ([Biber03]): the maps of all levels, and an alignment from 5 cm and 2 degrees off.
#include <benchmark/benchmark.h>

#include "fft_icp/ndt/ndt.hpp"
#include "stage_data.hpp"

namespace phasescan {
namespace {

void build_levels(benchmark::State& state) {
  const ScanPoints points = bench::points_of(bench::reference_scan(static_cast<int>(state.range(0))));
  NdtLevels levels;
  for (auto _ : state) {
    build_ndt(points, NdtOptions{}, levels);
    benchmark::DoNotOptimize(levels.data());
  }
}
BENCHMARK(build_levels)->ArgName("beams")->Arg(90)->Arg(360)->Arg(720)->Arg(4000);

void align(benchmark::State& state) {
  const int beams = static_cast<int>(state.range(0));
  const NdtOptions options;
  NdtLevels levels;
  build_ndt(bench::points_of(bench::reference_scan(beams)), options, levels);
  const ScanPoints scan = bench::points_of(bench::moved_scan(beams));
  const Pose2 guess = bench::kMotion * Pose2{0.04, -0.03, deg_to_rad(2.0)};
  NdtResult result;
  for (auto _ : state) {
    result = align_ndt(levels, scan, guess, options);
    benchmark::DoNotOptimize(result);
  }
  state.counters["iterations"] = result.iterations;
}
BENCHMARK(align)->ArgName("beams")->Arg(90)->Arg(360)->Arg(720)->Arg(4000);

}  // namespace
}  // namespace phasescan
