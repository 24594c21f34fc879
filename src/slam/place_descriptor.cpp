#include "phasescan/slam/place_descriptor.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <vector>

#include "phasescan/core/angle.hpp"
#include "phasescan/image/rasterize.hpp"
#include "phasescan/scan/points.hpp"
#include "phasescan/spectrum/fft.hpp"

namespace phasescan {
namespace {

constexpr int kSize = 128;
constexpr double kReachM = 6.0;
constexpr int kAngles = 64;                               // samples of half a ring; the other half repeats it
constexpr double kLeastRadius = 0.03, kMostRadius = 0.5;  // of the Nyquist frequency
constexpr double kUnit = 25.0;                            // of the 8-bit numbers: what the mean of a descriptor becomes

}  // namespace

struct PlaceDescriber::Impl {
  Rasterizer rasterizer;
  RealFft fft = RealFft::image(kSize, kSize);
  Image image;
  ComplexBuffer spectrum;
  ScanPoints points;
  std::vector<float> sample_u, sample_v;   // where rings are read, in cells of the half spectrum
  std::vector<std::complex<float>> turns;  // exp(-2 pi i h a / kAngles)

  Impl() {
    for (std::size_t r = 0; r < kDescriptorRadii; ++r) {
      const double share = static_cast<double>(r) / (kDescriptorRadii - 1);
      const double radius = 0.5 * kSize * (kLeastRadius + share * (kMostRadius - kLeastRadius));
      for (int a = 0; a < kAngles; ++a) {
        const double angle = kPi * a / kAngles - 0.5 * kPi;
        sample_u.push_back(static_cast<float>(radius * std::cos(angle)));
        sample_v.push_back(static_cast<float>(radius * std::sin(angle)));
      }
    }
    for (std::size_t h = 0; h < kDescriptorHarmonics; ++h) {
      for (int a = 0; a < kAngles; ++a) {
        const double turn = -kTwoPi * static_cast<double>(h) * a / kAngles;
        turns.emplace_back(static_cast<float>(std::cos(turn)), static_cast<float>(std::sin(turn)));
      }
    }
  }

  /// sqrt(|F|), bilinear between cells; v wraps, u is in [0, kSize / 2].
  float magnitude_at(float u, float v) const {
    const int u0 = static_cast<int>(std::floor(u)), v0 = static_cast<int>(std::floor(v));
    const float fu = u - static_cast<float>(u0), fv = v - static_cast<float>(v0);
    const auto cell = [&](int cu, int cv) {
      const auto row = static_cast<std::size_t>((cv + kSize) % kSize),
                 col = static_cast<std::size_t>(std::clamp(cu, 0, kSize / 2));
      return std::sqrt(std::abs(spectrum[row * (kSize / 2 + 1) + col]));
    };
    return (1 - fv) * ((1 - fu) * cell(u0, v0) + fu * cell(u0 + 1, v0)) +
           fv * ((1 - fu) * cell(u0, v0 + 1) + fu * cell(u0 + 1, v0 + 1));
  }
};

PlaceDescriber::PlaceDescriber() : impl_(std::make_unique<Impl>()) {}
PlaceDescriber::~PlaceDescriber() = default;
PlaceDescriber::PlaceDescriber(PlaceDescriber&&) noexcept = default;

PlaceDescriptor PlaceDescriber::describe(std::span<const float> x, std::span<const float> y) {
  PlaceDescriptor out{};
  Impl& m = *impl_;
  m.points.clear();
  for (std::size_t i = 0; i < x.size(); ++i) {
    const float range = std::sqrt(x[i] * x[i] + y[i] * y[i]);
    if (!(range < kReachM)) continue;
    m.points.x.push_back(x[i]);
    m.points.y.push_back(y[i]);
    m.points.range.push_back(range);
    m.points.beam.push_back(static_cast<int>(i));
  }
  if (m.points.size() == 0) return out;
  m.rasterizer.draw(m.points, 0.0, ImageGrid{kSize, kReachM}, m.image);
  m.fft.forward(m.image.pixels(), m.spectrum);
  std::array<float, kDescriptorSize> values{};
  std::array<float, kAngles> ring{};
  float mean = 0.0F;
  for (std::size_t r = 0; r < kDescriptorRadii; ++r) {
    for (std::size_t a = 0; a < kAngles; ++a)
      ring[a] = m.magnitude_at(m.sample_u[r * kAngles + a], m.sample_v[r * kAngles + a]);
    for (std::size_t h = 0; h < kDescriptorHarmonics; ++h) {
      float re = 0.0F, im = 0.0F;
      for (std::size_t a = 0; a < kAngles; ++a) {
        re += ring[a] * m.turns[h * kAngles + a].real();
        im += ring[a] * m.turns[h * kAngles + a].imag();
      }
      // The mean of a ring says little beside its harmonics.
      const float value = std::sqrt(re * re + im * im) * (h == 0 ? 0.5F : 1.0F);
      values[r * kDescriptorHarmonics + h] = value;
      mean += value / static_cast<float>(kDescriptorSize);
    }
  }
  if (!(mean > 0.0F)) return out;
  for (std::size_t i = 0; i < kDescriptorSize; ++i) {
    out[i] = static_cast<std::uint8_t>(std::min(255.0F, std::round(values[i] / mean * static_cast<float>(kUnit))));
  }
  return out;
}

}  // namespace phasescan
