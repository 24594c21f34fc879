// Rotation from magnitude spectra ([Jiang19] Sec. 3.2).
#include <benchmark/benchmark.h>

#include "fft_icp/rotation/from_spectrum.hpp"
#include "stage_data.hpp"

namespace phasescan {
namespace {

void describe(benchmark::State& state) {
  const int size = static_cast<int>(state.range(0));
  ComplexBuffer spectrum;
  ImageTransform(size).forward(bench::image_of(bench::reference_scan(360), size), spectrum);
  SpectralRotation rotation(size, SpectrumOptions{}, RotationOptions{});
  PolarDescriptor out;
  for (auto _ : state) {
    rotation.describe(spectrum, out);
    benchmark::DoNotOptimize(out.data());
  }
}
BENCHMARK(describe)->ArgName("px")->Arg(64)->Arg(128)->Arg(256);

void correlate_rings(benchmark::State& state) {
  const int size = 128;
  SpectrumOptions options;
  options.radii = static_cast<int>(state.range(0));
  ImageTransform transform(size);
  SpectralRotation rotation(size, options, RotationOptions{});
  ComplexBuffer spectrum;
  PolarDescriptor a, b;
  transform.forward(bench::image_of(bench::reference_scan(360), size), spectrum);
  rotation.describe(spectrum, a);
  transform.forward(bench::image_of(bench::moved_scan(360), size), spectrum);
  rotation.describe(spectrum, b);
  std::vector<RotationCandidate> out;
  for (auto _ : state) {
    rotation.candidates(a, b, out);
    benchmark::DoNotOptimize(out.data());
  }
}
BENCHMARK(correlate_rings)->ArgName("rings")->Arg(16)->Arg(32)->Arg(64);

}  // namespace
}  // namespace phasescan
