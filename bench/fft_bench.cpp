// The FFT behind spectrum/fft.hpp; forward/128 is the unit of the time tables.
#include <benchmark/benchmark.h>

#include "fft_icp/spectrum/fft.hpp"
#include "stage_data.hpp"

namespace phasescan {
namespace {

void forward(benchmark::State& state) {
  const int size = static_cast<int>(state.range(0));
  const Image image = bench::image_of(bench::reference_scan(360), size);
  RealFft fft = RealFft::image(size, size);
  ComplexBuffer out;
  for (auto _ : state) {
    fft.forward(image.pixels(), out);
    benchmark::DoNotOptimize(out.data());
  }
}
BENCHMARK(forward)->ArgName("px")->Arg(64)->Arg(128)->Arg(256)->Arg(512);

void there_and_back(benchmark::State& state) {
  const int size = static_cast<int>(state.range(0));
  const Image image = bench::image_of(bench::reference_scan(360), size);
  RealFft fft = RealFft::image(size, size);
  ComplexBuffer spectrum;
  FloatBuffer back;
  for (auto _ : state) {
    fft.forward(image.pixels(), spectrum);
    fft.inverse(spectrum, back);
    benchmark::DoNotOptimize(back.data());
  }
}
BENCHMARK(there_and_back)->ArgName("px")->Arg(64)->Arg(128)->Arg(256);

void rings(benchmark::State& state) {
  RealFft fft = RealFft::rows(static_cast<int>(state.range(0)), 180);
  FloatBuffer in(fft.real_size(), 0.5F);
  ComplexBuffer out;
  for (auto _ : state) {
    fft.forward(in, out);
    benchmark::DoNotOptimize(out.data());
  }
}
BENCHMARK(rings)->ArgName("rings")->Arg(1)->Arg(32)->Arg(64);

}  // namespace
}  // namespace phasescan
