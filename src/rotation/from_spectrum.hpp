/// Rotation between two scan images from their magnitude spectra ([Jiang19] Sec. 3.2).
#pragma once

#include <vector>

#include "phasescan/core/options.hpp"
#include "spectrum/polar.hpp"

namespace phasescan {

/// How the rings of two polar spectra are compared.
enum class RotationMode {
  kPerRadius,  ///< each ring is correlated, the correlations are added
  kRadiusSum,  ///< the rings are added first, one correlation
};
template <>
std::span<const std::string_view> enum_names<RotationMode>();

/// Section `rotation`. As printed: radius-sum, whiten, one candidate, no twin.
struct RotationOptions {
  RotationMode mode = RotationMode::kPerRadius;
  bool whiten = false;
  bool normalise = true;
  int candidates = 1;
  double separation_deg = 8.0;
  bool twin = true;
  bool subbin = true;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("mode", self.mode, OptionInfo{"", "per-radius or radius-sum"});
    v("whiten", self.whiten, OptionInfo{"", "phase correlation along the angle instead of cross-correlation"});
    v("normalise", self.normalise, OptionInfo{"", "every ring weighs the same, whatever its energy (per-radius)"});
    v("candidates", self.candidates, OptionInfo{"", "peaks tried, each with its twin", 1, 64});
    v("separation_deg", self.separation_deg, OptionInfo{"deg", "least distance between two candidates", 0, 90});
    v("twin", self.twin,
      OptionInfo{"",
                 "also try every peak turned by 180 degrees; without, the answer is within 90 degrees of straight on"});
    v("subbin", self.subbin, OptionInfo{"", "peak between the bins by a parabola"});
  }
};

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
