// Points and scan image ([Jiang19] Sec. 2.2).
#include <benchmark/benchmark.h>

#include "stage_data.hpp"

namespace phasescan {
namespace {

void points(benchmark::State& state) {
  const Scan scan = bench::reference_scan(static_cast<int>(state.range(0)));
  ScanPoints out;
  for (auto _ : state) {
    scan_to_points(scan, out);
    benchmark::DoNotOptimize(out.x.data());
  }
}
BENCHMARK(points)->ArgName("beams")->Arg(90)->Arg(360)->Arg(720)->Arg(4000);

void rasterize(benchmark::State& state) {
  const ScanPoints in = bench::points_of(bench::reference_scan(static_cast<int>(state.range(0))));
  const ImageOptions options;
  Rasterizer rasterizer(options.blur_px, options.connect_m);
  Image image;
  for (auto _ : state) {
    rasterizer.draw(in, 0.3, {static_cast<int>(state.range(1)), options.dmax_m}, image);
    benchmark::DoNotOptimize(image.pixels().data());
  }
}
BENCHMARK(rasterize)->ArgNames({"beams", "px"})->ArgsProduct({{360, 4000}, {64, 128, 256}});

}  // namespace
}  // namespace phasescan
