#include "fft_icp/spectrum/fft.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <thread>

#include "core/random.hpp"

namespace phasescan::fft_test {
namespace {

FloatBuffer noise(std::size_t n, std::uint64_t seed) {
  Random random(seed);
  FloatBuffer values(n);
  for (float& value : values) value = static_cast<float>(random.uniform(-1, 1));
  return values;
}

/// The definition, term by term.
std::complex<double> slow_dft(const FloatBuffer& image, int rows, int cols, int v, int u) {
  std::complex<double> sum = 0.0;
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < cols; ++c) {
      const double phase =
          -2.0 * std::numbers::pi * (static_cast<double>(u * c) / cols + static_cast<double>(v * r) / rows);
      sum += static_cast<double>(image[static_cast<std::size_t>(r * cols + c)]) * std::polar(1.0, phase);
    }
  }
  return sum;
}

TEST(Fft, ImageTransformIsTheSlowDft) {
  for (const auto& [rows, cols] : {std::pair{8, 8}, {6, 10}, {12, 16}}) {
    const FloatBuffer image = noise(static_cast<std::size_t>(rows * cols), 1);
    ComplexBuffer spectrum;
    RealFft::image(rows, cols).forward(image, spectrum);
    for (int v = 0; v < rows; ++v) {
      for (int u = 0; u <= cols / 2; ++u) {
        const std::complex<double> expected = slow_dft(image, rows, cols, v, u);
        const std::complex<float> got = spectrum[static_cast<std::size_t>(v * (cols / 2 + 1) + u)];
        EXPECT_NEAR(got.real(), expected.real(), 1e-4);
        EXPECT_NEAR(got.imag(), expected.imag(), 1e-4);
      }
    }
  }
}

TEST(Fft, RowTransformIsTheSlowDftOfEachRow) {
  const int count = 3, length = 20;
  const FloatBuffer values = noise(60, 2);
  ComplexBuffer spectra;
  RealFft::rows(count, length).forward(values, spectra);
  for (int row = 0; row < count; ++row) {
    const FloatBuffer one(values.begin() + row * length, values.begin() + (row + 1) * length);
    for (int u = 0; u <= length / 2; ++u) {
      const std::complex<double> expected = slow_dft(one, 1, length, 0, u);
      const std::complex<float> got = spectra[static_cast<std::size_t>(row * (length / 2 + 1) + u)];
      EXPECT_NEAR(got.real(), expected.real(), 1e-4);
      EXPECT_NEAR(got.imag(), expected.imag(), 1e-4);
    }
  }
}

TEST(Fft, InverseOfForwardIsTheImageWithoutFurtherScaling) {
  for (const int size : {16, 128, 180}) {
    RealFft fft = RealFft::image(size, size);
    const FloatBuffer image = noise(fft.real_size(), 3);
    ComplexBuffer spectrum;
    FloatBuffer back;
    fft.forward(image, spectrum);
    fft.inverse(spectrum, back);
    for (std::size_t i = 0; i < image.size(); i += 7) EXPECT_NEAR(back[i], image[i], 1e-5);
  }
}

TEST(Fft, ParsevalHolds) {
  RealFft fft = RealFft::image(32, 32);
  const FloatBuffer image = noise(fft.real_size(), 4);
  ComplexBuffer spectrum;
  fft.forward(image, spectrum);
  double space = 0.0, frequency = 0.0;
  for (const float value : image) space += static_cast<double>(value) * static_cast<double>(value);
  for (std::size_t i = 0; i < spectrum.size(); ++i) {
    const std::size_t u = i % 17;
    frequency += (u == 0 || u == 16 ? 1.0 : 2.0) * static_cast<double>(std::norm(spectrum[i]));
  }
  EXPECT_NEAR(frequency / (32.0 * 32.0), space, 1e-3);
}

TEST(Fft, PlansAreSafeToShareBetweenThreads) {
  const FloatBuffer image = noise(64 * 64, 5);
  ComplexBuffer alone;
  RealFft::image(64, 64).forward(image, alone);
  std::vector<ComplexBuffer> results(4);
  std::vector<std::thread> threads;
  for (ComplexBuffer& result : results) {
    threads.emplace_back([&] {
      RealFft fft = RealFft::image(64, 64);
      for (int i = 0; i < 50; ++i) fft.forward(image, result);
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (const ComplexBuffer& result : results) EXPECT_EQ(result, alone);
}

TEST(Fft, ShapesItCannotDoAreTheCallersMistake) {
  EXPECT_THROW(RealFft::image(8, 7), std::invalid_argument);
  EXPECT_THROW(RealFft::image(0, 8), std::invalid_argument);
  EXPECT_THROW(RealFft::rows(2, 0), std::invalid_argument);
  RealFft fft = RealFft::image(8, 8);
  ComplexBuffer out;
  EXPECT_THROW(fft.forward(FloatBuffer(63), out), std::invalid_argument);
}

}  // namespace
}  // namespace phasescan::fft_test
