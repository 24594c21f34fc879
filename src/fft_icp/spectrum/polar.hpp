/// Polar sampling of a magnitude spectrum ([Jiang19] Sec. 3.2: A(rho, theta)).
#pragma once

#include <cstdint>
#include <vector>

#include "fft_icp/spectrum/spectrum.hpp"

namespace phasescan {

/// Reads a magnitude spectrum on rings around zero frequency, bilinear, from tables made once.
///
/// Row k of the result is the ring of radius_min .. radius_max (evenly spaced), column t the direction
/// -90 deg + 180 deg * t / angle_bins of the frequency vector (u, v). Half a turn is all there is: the magnitude of a
/// real image repeats every 180 degrees, so a ring is periodic in t.
class PolarSampler {
 public:
  /// @param size  side of the image, whose magnitude has size x (size/2 + 1) values
  PolarSampler(int size, const SpectrumOptions& options);

  int angle_bins() const { return angle_bins_; }
  int radii() const { return radii_; }
  /// Direction of a bin [rad].
  double angle(int bin) const;
  /// Radius of a ring [cycles per image side].
  double radius(int ring) const;

  /// @param out  resized to radii x angle_bins, row-major. @cost O(radii * angle_bins), allocates once.
  void sample(const Image& magnitude, FloatBuffer& out) const;

 private:
  struct Tap {
    std::int32_t at;  ///< offset of the lower left of four values
    float fu, fv;     ///< how far to the next column and row, 0..1
  };

  int angle_bins_, radii_;
  double radius_min_, radius_step_;
  int stride_;
  std::vector<Tap> taps_;
};

}  // namespace phasescan
