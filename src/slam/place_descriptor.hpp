/// A place in small numbers: some that do not change when the robot turns, others that turn with it; neither change
/// much when it moves a little.
#pragma once

#include <array>
#include <complex>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

namespace phasescan {

inline constexpr std::size_t kPlaceRings = 24, kPlaceHarmonics = 12;
inline constexpr std::size_t kPlaceFeatures = kPlaceRings * kPlaceHarmonics;
inline constexpr std::size_t kDescriptorSize = 160;
/// Angular harmonics 1, 2, .. of half a turn that are kept with their phases, and the complex numbers to each.
inline constexpr std::size_t kTurningHarmonics = 10, kTurningNumbers = 16;
inline constexpr std::size_t kTurningSize = kTurningHarmonics * kTurningNumbers;

/// Angular harmonics of each ring, ring by ring: turning the robot by t multiplies harmonic h by exp(-2 i h t). The
/// mean of their magnitudes is 1.
using PlaceFeatures = std::array<std::complex<float>, kPlaceFeatures>;

/// What the index keeps of a place.
struct PlaceDescriptor {
  /// Of the magnitudes of the features: does not change with the robot's heading. Squared distances compare places.
  std::array<std::int8_t, kDescriptorSize> numbers{};
  /// Of the features with their phases, harmonic by harmonic, each a complex number whose real part is in the low four
  /// bits and whose imaginary part is in the high ones, both signed: compared over all turns of one against the other.
  std::array<std::uint8_t, kTurningSize> turning{};

  bool operator==(const PlaceDescriptor&) const = default;
};
inline constexpr float kDescriptorLength = 200.0F;  ///< of `numbers` as a vector

/// Computes descriptors. Owns FFT buffers: one object per thread.
class PlaceDescriber {
 public:
  PlaceDescriber();
  ~PlaceDescriber();
  PlaceDescriber(PlaceDescriber&&) noexcept;

  /// @param x, y  hits around the sensor [m], in beam order; those beyond 6 m are left out, and of hits closer together
  ///              than three quarters of a degree every other one, so that finer sensors see what coarser ones see
  ///
  /// The magnitude of the spectrum of the scan image does not move with the scan and turns with it; so does its square
  /// root on 24 rings, of each of which 12 angular harmonics are taken. Hits count less the farther they are (Gaussian,
  /// 3 m): what is near is still in view from a step aside.
  /// @return  false without a hit; all features are 0 then
  bool features(std::span<const float> x, std::span<const float> y, PlaceFeatures& out);

  /// The features along the directions in which different places differ most, measured by how much views of one place
  /// from within a metre do (linear discriminants fitted on simulated buildings by `phasescan bench retrieval --fit`):
  /// 160 of the magnitudes, as a vector of length kDescriptorLength, and 16 of the rings of each harmonic. All zero
  /// without a hit.
  /// @cost one 128 x 128 FFT and about 50 us
  PlaceDescriptor describe(std::span<const float> x, std::span<const float> y);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace phasescan
