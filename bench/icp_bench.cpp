// ICP ([Jiang19] Sec. 4): the k-d tree, and an alignment from 5 cm and 2 degrees off.
#include <benchmark/benchmark.h>

#include "fft_icp/icp/icp.hpp"
#include "stage_data.hpp"

namespace phasescan {
namespace {

void build_index(benchmark::State& state) {
  const ScanPoints points = bench::points_of(bench::reference_scan(static_cast<int>(state.range(0))));
  PointIndex index;
  for (auto _ : state) index.build(points);
}
BENCHMARK(build_index)->ArgName("beams")->Arg(90)->Arg(360)->Arg(720)->Arg(4000);

void align(benchmark::State& state) {
  const int beams = static_cast<int>(state.range(0));
  PointIndex index;
  index.build(bench::points_of(bench::reference_scan(beams)));
  const ScanPoints scan = bench::points_of(bench::moved_scan(beams));
  const Pose2 guess = bench::kMotion * Pose2{0.04, -0.03, deg_to_rad(2.0)};
  Icp icp;
  IcpResult result;
  for (auto _ : state) {
    result = icp.align(index, scan, guess, true);
    benchmark::DoNotOptimize(result);
  }
  state.counters["iterations"] = result.iterations;
}
BENCHMARK(align)->ArgName("beams")->Arg(90)->Arg(360)->Arg(720)->Arg(4000);

}  // namespace
}  // namespace phasescan
