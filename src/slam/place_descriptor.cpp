#include "slam/place_descriptor.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <vector>

#include "phasescan/core/pose2.hpp"
#include "slam/place_projection.hpp"
#include "slam/place_spectrum.hpp"

namespace phasescan {
namespace {

constexpr int kSize = PlaceSpectrum::kSize;
constexpr double kReachM = 6.0, kTaperM = 3.0;
constexpr float kLeastTurn = 0.0131F;                     // [rad], sine of the least angle between hits that count
constexpr std::size_t kAngles = 64;                       // samples of half a ring; the other half repeats it
constexpr double kLeastRadius = 0.03, kMostRadius = 0.5;  // of the Nyquist frequency

}  // namespace

struct PlaceDescriber::Impl {
  PlaceSpectrum spectrum;
  std::vector<float> taper;               // of each pixel
  std::vector<float> sample_u, sample_v;  // where rings are read, in cells of the half spectrum
  // cos and sin of 2 pi h a / kAngles: of each angle first all cosines, then all sines.
  std::array<std::array<float, 2 * kPlaceHarmonics>, kAngles> turns{};

  Impl() {
    for (std::size_t r = 0; r < kPlaceRings; ++r) {
      const double share = static_cast<double>(r) / (kPlaceRings - 1);
      const double radius = 0.5 * kSize * (kLeastRadius + share * (kMostRadius - kLeastRadius));
      for (std::size_t a = 0; a < kAngles; ++a) {
        const double angle = kPi * static_cast<double>(a) / kAngles - 0.5 * kPi;
        sample_u.push_back(static_cast<float>(radius * std::cos(angle)));
        sample_v.push_back(static_cast<float>(radius * std::sin(angle)));
      }
    }
    for (std::size_t a = 0; a < kAngles; ++a) {
      for (std::size_t h = 0; h < kPlaceHarmonics; ++h) {
        const double turn = kTwoPi * static_cast<double>(h * a % kAngles) / kAngles;
        turns[a][h] = static_cast<float>(std::cos(turn));
        turns[a][kPlaceHarmonics + h] = static_cast<float>(std::sin(turn));
      }
    }
    const double pixel_m = 2.0 * kReachM / kSize;
    for (int row = 0; row < kSize; ++row) {
      for (int col = 0; col < kSize; ++col) {
        const double x = (col + 0.5 - 0.5 * kSize) * pixel_m, y = (row + 0.5 - 0.5 * kSize) * pixel_m;
        taper.push_back(static_cast<float>(std::exp(-0.5 * (x * x + y * y) / (kTaperM * kTaperM))));
      }
    }
  }

  /// Draws the pixels that hits which count fall into, tapered. False without a hit.
  bool draw(std::span<const float> x, std::span<const float> y) {
    constexpr auto pixels_per_m = static_cast<float>(kSize / (2.0 * kReachM));
    bool any = false;
    spectrum.clear();
    float last_x = 0.0F, last_y = 0.0F, last_range = 0.0F;
    for (std::size_t i = 0; i < x.size(); ++i) {
      const float range = std::sqrt(x[i] * x[i] + y[i] * y[i]);
      if (!(range < static_cast<float>(kReachM))) continue;
      const bool ahead = x[i] * last_x + y[i] * last_y > 0.0F;
      const float sine = std::abs(x[i] * last_y - y[i] * last_x);
      if (ahead && sine < kLeastTurn * range * last_range) continue;
      last_x = x[i], last_y = y[i], last_range = range;
      any = true;
      const float col = pixels_per_m * x[i] + 0.5F * kSize, row = pixels_per_m * y[i] + 0.5F * kSize;
      if (!(col >= 0.0F && row >= 0.0F && col < kSize && row < kSize)) continue;
      const auto r = static_cast<std::size_t>(row), c = static_cast<std::size_t>(col);
      spectrum.pixel(r, c) = taper[r * kSize + c];
    }
    return any;
  }

  /// sqrt(|F|), bilinear between cells; v wraps, u is in [0, kSize / 2].
  static float root_at(const std::vector<float>& root, float u, float v) {
    const int u0 = static_cast<int>(std::floor(u)), v0 = static_cast<int>(std::floor(v));
    const float fu = u - static_cast<float>(u0), fv = v - static_cast<float>(v0);
    const auto cell = [&](int cu, int cv) {
      const auto row = static_cast<std::size_t>((cv + kSize) % kSize),
                 col = static_cast<std::size_t>(std::clamp(cu, 0, kSize / 2));
      return root[row * (kSize / 2 + 1) + col];
    };
    return (1 - fv) * ((1 - fu) * cell(u0, v0) + fu * cell(u0 + 1, v0)) +
           fv * ((1 - fu) * cell(u0, v0 + 1) + fu * cell(u0 + 1, v0 + 1));
  }
};

PlaceDescriber::PlaceDescriber() : impl_(std::make_unique<Impl>()) {}
PlaceDescriber::~PlaceDescriber() = default;
PlaceDescriber::PlaceDescriber(PlaceDescriber&&) noexcept = default;

bool PlaceDescriber::features(std::span<const float> x, std::span<const float> y, PlaceFeatures& out) {
  out.fill({});
  Impl& m = *impl_;
  if (!m.draw(x, y)) return false;
  const std::vector<float>& root = m.spectrum.root_magnitudes();
  float sum = 0.0F;
  for (std::size_t r = 0; r < kPlaceRings; ++r) {
    std::array<float, 2 * kPlaceHarmonics> parts{};
    for (std::size_t a = 0; a < kAngles; ++a) {
      const float value = Impl::root_at(root, m.sample_u[r * kAngles + a], m.sample_v[r * kAngles + a]);
      for (std::size_t k = 0; k < parts.size(); ++k) parts[k] += value * m.turns[a][k];
    }
    for (std::size_t h = 0; h < kPlaceHarmonics; ++h) {
      const float re = parts[h], im = parts[kPlaceHarmonics + h];
      // The mean of a ring is real and counts half.
      const float weight = h == 0 ? 0.5F : 1.0F;
      out[r * kPlaceHarmonics + h] = {weight * re, weight * im};
      sum += weight * std::sqrt(re * re + im * im);
    }
  }
  if (!(sum > 0.0F)) return false;
  for (auto& value : out) value *= static_cast<float>(kPlaceFeatures) / sum;
  return true;
}

PlaceDescriptor PlaceDescriber::describe(std::span<const float> x, std::span<const float> y) {
  PlaceDescriptor out{};
  PlaceFeatures values;
  if (features(x, y, values)) place_projection().apply(values, out);
  return out;
}

}  // namespace phasescan
