#include "slam/place_projection.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>

namespace phasescan {
namespace {

#include "slam/place_projection.inc"

PlaceProjection unpack() {
  PlaceProjection out;
  for (std::size_t f = 0; f < kPlaceFeatures; ++f) {
    out.mean[f] = kMean[f];
    for (std::size_t d = 0; d < kDescriptorSize; ++d)
      out.weights[f][d] = kStep[d] / kSpread[f] * static_cast<float>(place_number(kWeights[d][f]));
  }
  for (std::size_t h = 0; h < kTurningHarmonics; ++h) {
    for (std::size_t k = 0; k < kTurningNumbers; ++k) {
      const std::size_t number = h * kTurningNumbers + k;
      for (std::size_t r = 0; r < kPlaceRings; ++r) {
        const float step = kTurningStep[number] / kTurningSpread[h * kPlaceRings + r];
        out.turning[h][r][k] = {step * static_cast<float>(place_number(kTurningWeights[number][2 * r])),
                                step * static_cast<float>(place_number(kTurningWeights[number][2 * r + 1]))};
      }
    }
  }
  return out;
}

/// Four bits hold what lies within twice its root mean square; what lies farther out counts as much as the edge does,
/// so that no single number decides: that is worth 0.4 points of recall over numbers kept whole.
constexpr float kMostTurning = 7.0F, kTurningReach = 2.0F;

std::uint8_t nibble(float value) {
  const auto n = static_cast<int>(std::clamp(std::round(value), -kMostTurning, kMostTurning));
  return static_cast<std::uint8_t>(n & 15);
}

}  // namespace

PlaceMagnitudes magnitudes_of(const PlaceFeatures& features) {
  PlaceMagnitudes out;
  std::transform(features.begin(), features.end(), out.begin(),
                 [](std::complex<float> z) { return std::sqrt(z.real() * z.real() + z.imag() * z.imag()); });
  return out;
}

void PlaceProjection::apply(const PlaceFeatures& features, PlaceDescriptor& out) const {
  std::array<float, kDescriptorSize> sums{};
  const PlaceMagnitudes magnitudes = magnitudes_of(features);
  for (std::size_t f = 0; f < kPlaceFeatures; ++f) {
    const float value = magnitudes[f] - mean[f];
    for (std::size_t d = 0; d < kDescriptorSize; ++d) sums[d] += value * weights[f][d];
  }
  float squares = 0.0F;
  for (const float sum : sums) squares += sum * sum;
  const float scale = squares > 0.0F ? kDescriptorLength / std::sqrt(squares) : 0.0F;
  for (std::size_t d = 0; d < kDescriptorSize; ++d)
    out.numbers[d] = static_cast<std::int8_t>(std::clamp(std::round(scale * sums[d]), -127.0F, 127.0F));

  std::array<float, kTurningSize> re{}, im{};
  float power = 0.0F;
  for (std::size_t h = 0; h < kTurningHarmonics; ++h) {
    float* const re_h = re.data() + h * kTurningNumbers;
    float* const im_h = im.data() + h * kTurningNumbers;
    for (std::size_t r = 0; r < kPlaceRings; ++r) {
      const std::complex<float> z = features[r * kPlaceHarmonics + h + 1];  // the mean of a ring does not turn
      for (std::size_t k = 0; k < kTurningNumbers; ++k) {
        const std::complex<float> w = turning[h][r][k];
        re_h[k] += w.real() * z.real() + w.imag() * z.imag();
        im_h[k] += w.real() * z.imag() - w.imag() * z.real();
      }
    }
  }
  for (std::size_t k = 0; k < kTurningSize; ++k) power += re[k] * re[k] + im[k] * im[k];
  const float most = kTurningReach * std::sqrt(power / (2.0F * kTurningSize));
  const float to_steps = power > 0.0F ? kMostTurning / most : 0.0F;
  for (std::size_t k = 0; k < kTurningSize; ++k)
    out.turning[k] = static_cast<std::uint8_t>(nibble(to_steps * re[k]) | nibble(to_steps * im[k]) << 4);
}

const PlaceProjection& place_projection() {
  static const PlaceProjection projection = unpack();
  return projection;
}

}  // namespace phasescan
