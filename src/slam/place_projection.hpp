/// The linear discriminants that make descriptors of place features.
#pragma once

#include <array>
#include <complex>

#include "slam/place_descriptor.hpp"

namespace phasescan {

using PlaceMagnitudes = std::array<float, kPlaceFeatures>;
PlaceMagnitudes magnitudes_of(const PlaceFeatures& features);

struct PlaceProjection {
  PlaceMagnitudes mean{};                                                    ///< taken off the magnitudes first
  std::array<std::array<float, kDescriptorSize>, kPlaceFeatures> weights{};  ///< of feature and descriptor number
  /// Of harmonic and ring and turning number: taken by their complex conjugates, so that turns stay what they are.
  std::array<std::array<std::array<std::complex<float>, kTurningNumbers>, kPlaceRings>, kTurningHarmonics> turning{};

  void apply(const PlaceFeatures& features, PlaceDescriptor& out) const;
};

/// Weights are kept as characters, kMostLetter steps to either side of 0: 0-9, A-Z, a-y in this order.
inline constexpr int kMostLetter = 30;
constexpr int place_number(char letter) {
  const int n = letter <= '9' ? letter - '0' : letter <= 'Z' ? letter - 'A' + 10 : letter - 'a' + 36;
  return n - kMostLetter;
}
constexpr char place_letter(int number) {
  const int n = number + kMostLetter;
  return static_cast<char>(n < 10 ? '0' + n : n < 36 ? 'A' + n - 10 : 'a' + n - 36);
}

/// The one that is built in.
const PlaceProjection& place_projection();

}  // namespace phasescan
