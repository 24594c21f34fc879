/// A place in 128 numbers that do not change when the robot turns, and hardly when it moves a little.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>

namespace phasescan {

inline constexpr std::size_t kDescriptorRadii = 16, kDescriptorHarmonics = 8;
inline constexpr std::size_t kDescriptorSize = kDescriptorRadii * kDescriptorHarmonics;

/// 8 bits a number: what the index keeps.
using PlaceDescriptor = std::array<std::uint8_t, kDescriptorSize>;

/// Computes descriptors. Owns FFT buffers: one object per thread.
class PlaceDescriber {
 public:
  PlaceDescriber();
  ~PlaceDescriber();
  PlaceDescriber(PlaceDescriber&&) noexcept;

  /// @param x, y  hits around the sensor [m]; those beyond 6 m are left out
  ///
  /// The magnitude of the spectrum of the scan image does not move with the scan and turns with it; its square root on
  /// 16 rings, and of each ring the magnitudes of 8 angular harmonics, do neither. All zero without a hit.
  /// @cost one 128 x 128 FFT and about 30 us
  PlaceDescriptor describe(std::span<const float> x, std::span<const float> y);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace phasescan
