/// A place in 160 small numbers that do not change when the robot turns, and hardly when it moves a little.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

namespace phasescan {

inline constexpr std::size_t kPlaceRings = 24, kPlaceHarmonics = 12;
inline constexpr std::size_t kPlaceFeatures = kPlaceRings * kPlaceHarmonics;
inline constexpr std::size_t kDescriptorSize = 160;

/// Rotation-invariant features, ring by ring; their mean is 1.
using PlaceFeatures = std::array<float, kPlaceFeatures>;

/// 8 bits a number: what the index keeps. Squared distances between descriptors compare places.
inline constexpr float kDescriptorLength = 200.0F;
using PlaceDescriptor = std::array<std::int8_t, kDescriptorSize>;

/// Computes descriptors. Owns FFT buffers: one object per thread.
class PlaceDescriber {
 public:
  PlaceDescriber();
  ~PlaceDescriber();
  PlaceDescriber(PlaceDescriber&&) noexcept;

  /// @param x, y  hits around the sensor [m], in beam order; those beyond 6 m are left out, and of hits closer together
  ///              than three quarters of a degree every other one, so that finer sensors see what coarser ones see
  ///
  /// The magnitude of the spectrum of the scan image does not move with the scan and turns with it; its square root on
  /// 24 rings, and of each ring the magnitudes of 12 angular harmonics, do neither. Hits count less the farther they
  /// are (Gaussian, 3 m): what is near is still in view from a step aside.
  /// @return  false without a hit; all features are 0 then
  bool features(std::span<const float> x, std::span<const float> y, PlaceFeatures& out);

  /// The features along the 160 directions in which different places differ most, measured by how much views of one
  /// place from within a metre do (linear discriminant fitted on simulated buildings by `phasescan bench retrieval
  /// --fit`), as a vector of length kDescriptorLength. All zero without a hit.
  /// @cost one 128 x 128 FFT and about 40 us
  PlaceDescriptor describe(std::span<const float> x, std::span<const float> y);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace phasescan
