// Translation by correlation ([Jiang19] Sec. 3.3): describing an image, one peak, and the peak of its twin.
#include <benchmark/benchmark.h>

#include "fft_icp/translation/phase_correlation.hpp"
#include "stage_data.hpp"

namespace phasescan {
namespace {

TranslationOptions options_of(const benchmark::State& state) {
  TranslationOptions options;
  options.mode = state.range(1) == 0 ? TranslationMode::kImage : TranslationMode::kProjections;
  return options;
}

void describe(benchmark::State& state) {
  const int size = static_cast<int>(state.range(0));
  const Image image = bench::image_of(bench::reference_scan(360), size);
  TranslationEstimator estimator(size, options_of(state));
  TranslationSpectrum out;
  for (auto _ : state) {
    estimator.describe(image, out);
    benchmark::DoNotOptimize(out.values.data());
  }
}
BENCHMARK(describe)->ArgNames({"px", "projections"})->ArgsProduct({{64, 128, 256}, {0, 1}});

void find(benchmark::State& state) {
  const int size = static_cast<int>(state.range(0));
  TranslationEstimator estimator(size, options_of(state));
  TranslationSpectrum a, b;
  estimator.describe(bench::image_of(bench::reference_scan(360), size), a);
  estimator.describe(bench::image_of(bench::moved_scan(360), size, bench::kMotion.theta), b);
  for (auto _ : state) {
    benchmark::DoNotOptimize(estimator.find(a, b));
    benchmark::DoNotOptimize(estimator.find_twin(a, b));
  }
}
BENCHMARK(find)->ArgNames({"px", "projections"})->ArgsProduct({{64, 128, 256}, {0, 1}});

}  // namespace
}  // namespace phasescan
