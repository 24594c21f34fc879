/// Rotation between two scan images from their magnitude spectra ([Jiang19] Sec. 3.2).
#pragma once

#include <vector>

#include "phasescan/fft_icp/options.hpp"
#include "fft_icp/spectrum/polar.hpp"

namespace phasescan {

/// A rotation that would explain the spectra; so would the one half a turn away.
struct RotationCandidate {
  double theta = 0.0;  ///< [rad] in (-pi/2, pi/2]
  double score = 0.0;  ///< normalised correlation, at most 1
};

/// What the rotation stage keeps of one scan: the transforms of its rings, means removed.
using PolarDescriptor = ComplexBuffer;

/// One object per thread; allocates nothing after the first use.
class SpectralRotation {
 public:
  /// @param size  side of the images [px]
  SpectralRotation(int size, const SpectrumOptions& spectrum, const RotationOptions& rotation);

  /// Half spectrum of an image -> descriptor. @cost one pass over the spectrum and one short FFT per ring
  void describe(const ComplexBuffer& half_spectrum, PolarDescriptor& out);

  /// Rotations theta with A(rho, phi + theta) = B(rho, phi), best first: the scan turned by theta looks like the
  /// reference. Empty if either spectrum is flat (no image).
  void candidates(const PolarDescriptor& reference, const PolarDescriptor& scan, std::vector<RotationCandidate>& out);

 private:
  int size_;
  MagnitudeScale scale_;
  RotationOptions options_;
  PolarSampler sampler_;
  int rings_;  ///< rows of a descriptor: all rings, or their sum
  RealFft ring_fft_, correlation_fft_;
  Image magnitude_;
  FloatBuffer rings_buffer_, summed_, correlation_;
  ComplexBuffer product_;
};

}  // namespace phasescan
