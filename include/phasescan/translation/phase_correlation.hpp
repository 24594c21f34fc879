/// Translation between two scan images by correlation ([Jiang19] Sec. 3.1 and 3.3).
#pragma once

#include "phasescan/core/options.hpp"
#include "phasescan/image/image.hpp"
#include "phasescan/spectrum/fft.hpp"

namespace phasescan {

/// How the shift of two images is found.
enum class TranslationMode {
  kCorrelation2d,      ///< 2-D cross-correlation
  kPhase2d,            ///< 2-D phase correlation (Eq. 12)
  kProjections,        ///< projections onto x and y, 1-D cross-correlation each
  kProjectionsPhase,   ///< projections onto x and y (Eq. 22-25), 1-D phase correlation each: as printed
};
template <>
std::span<const std::string_view> enum_names<TranslationMode>();

/// Section `translation`.
struct TranslationOptions {
  TranslationMode mode = TranslationMode::kCorrelation2d;
  bool subpixel = true;
  double min_score = 0.05;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("mode", self.mode, OptionInfo{"", "correlation-2d, phase-2d, projections or projections-phase"});
    v("subpixel", self.subpixel, OptionInfo{"", "peak between the pixels by a parabola"});
    v("min_score", self.min_score, OptionInfo{"", "a lower peak is no answer", 0, 1});
  }
};

/// The highest peak of a correlation.
struct TranslationPeak {
  double col = 0.0;    ///< shift along x that takes the scan image onto the reference image [px], in [-size/2, size/2)
  double row = 0.0;    ///< the same along y
  double score = 0.0;  ///< peak quality: correlation over the geometric mean of both energies, 1 for equal images;
                       ///< for phase correlation the peak itself, 1 for a pure shift
};

/// What the translation stage needs of an image.
struct TranslationSpectrum {
  ComplexBuffer values;  ///< 2-D half spectrum, or those of the projections onto x (first row) and y
  double energy[2] = {0.0, 0.0};  ///< sum of squares of the image (first only), or of each projection
};

/// One object per thread; allocates nothing after the first use.
class TranslationEstimator {
 public:
  TranslationEstimator(int size, const TranslationOptions& options);

  bool two_dimensional() const { return two_dimensional_; }
  /// Spectrum of an image, or of its projections.
  void describe(const Image& image, TranslationSpectrum& out);

  /// Shift of `scan` onto `reference`: a(p + shift) = b(p), so F_a F_b* (whitened or not) transforms back to a peak at +shift.
  TranslationPeak find(const TranslationSpectrum& reference, const TranslationSpectrum& scan) { return peak(reference, scan, false); }

  /// The same for the scan image turned by 180 degrees, without drawing or transforming it: b'(p) = b(size - 1 - p) has the
  /// spectrum of b conjugated and shifted by one pixel, so F_a F_b peaks at shift - 1.
  TranslationPeak find_twin(const TranslationSpectrum& reference, const TranslationSpectrum& scan) { return peak(reference, scan, true); }

 private:
  TranslationPeak peak(const TranslationSpectrum& reference, const TranslationSpectrum& scan, bool twin);

  int size_;
  TranslationOptions options_;
  bool two_dimensional_, whiten_;
  RealFft fft_;
  FloatBuffer projections_, correlation_;
  ComplexBuffer product_;
};

/// Offset of the peak of a parabola through three values from the middle one, in [-0.5, 0.5]; 0 where there is no peak.
double parabola_peak(double left, double centre, double right);

}  // namespace phasescan
