/// Translation between two scan images by correlation ([Jiang19] Sec. 3.1 and 3.3).
#pragma once

#include "phasescan/fft_icp/options.hpp"
#include "fft_icp/image/image.hpp"
#include "fft_icp/spectrum/fft.hpp"

namespace phasescan {

/// The highest peak of a correlation.
struct TranslationPeak {
  double col = 0.0;  ///< shift along x that takes the scan image onto the reference image [px], in [-size/2, size/2)
  double row = 0.0;  ///< the same along y
  double score =
      0.0;  ///< peak quality: the (whitened) correlation over the geometric mean of both energies, 1 for a pure shift
};

/// What the translation stage needs of an image.
struct TranslationSpectrum {
  ComplexBuffer values;           ///< whitened: 2-D half spectrum, or those of the projections onto x (first row) and y
  double energy[2] = {0.0, 0.0};  ///< sum of squares of the whitened image (first only), or of each projection
};

/// One object per thread; allocates nothing after the first use.
class TranslationEstimator {
 public:
  TranslationEstimator(int size, const TranslationOptions& options);

  /// Spectrum of an image, or of its projections.
  void describe(const Image& image, TranslationSpectrum& out);
  /// The same where the image's 2-D half spectrum is known already. @pre two_dimensional()
  void describe(const ComplexBuffer& half_spectrum, TranslationSpectrum& out);
  bool two_dimensional() const { return options_.mode == TranslationMode::kImage; }

  /// Shift of `scan` onto `reference`: a(p + shift) = b(p), so F_a F_b* transforms back to a peak at +shift (Eq. 10-12:
  /// with full whitening its magnitude is 1 everywhere and the peak a single pixel).
  TranslationPeak find(const TranslationSpectrum& reference, const TranslationSpectrum& scan) {
    return peak(reference, scan, false);
  }

  /// The same for the scan image turned by 180 degrees, without drawing or transforming it: b'(p) = b(size - 1 - p) has
  /// the spectrum of b conjugated and shifted by one pixel, so F_a F_b peaks at shift - 1.
  TranslationPeak find_twin(const TranslationSpectrum& reference, const TranslationSpectrum& scan) {
    return peak(reference, scan, true);
  }

 private:
  void whiten(TranslationSpectrum& spectrum) const;
  TranslationPeak peak(const TranslationSpectrum& reference, const TranslationSpectrum& scan, bool twin);

  int size_;
  TranslationOptions options_;
  RealFft fft_;
  FloatBuffer projections_, correlation_;
  ComplexBuffer product_;
};

/// Offset of the peak of a parabola through three values from the middle one, in [-0.5, 0.5]; 0 where there is no peak.
double parabola_peak(double left, double centre, double right);

}  // namespace phasescan
