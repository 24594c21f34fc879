/// Steps 1 to 4 of [Jiang19] joined: from points to a first estimate of the pose by image, missing data and FFT.
#pragma once

#include <optional>

#include "fft_icp/image/rasterize.hpp"
#include "phasescan/fft_icp/options.hpp"
#include "phasescan/match/result.hpp"
#include "fft_icp/missing/from_missing.hpp"
#include "fft_icp/rotation/from_spectrum.hpp"
#include "fft_icp/translation/phase_correlation.hpp"

namespace phasescan {

/// What the image stages keep of a reference scan.
struct ImageReference {
  ImageGrid grid;
  MissingFeatures missing;
  ComplexBuffer spectrum;  ///< of the image, as the rotation reads it
  TranslationSpectrum translation;
  PolarDescriptor polar;
};

/// A pose by correlation.
struct ImageEstimate {
  Pose2 T_ref_scan;
  double score = 0.0;  ///< of the translation peak
  RotationSource source = RotationSource::kNone;
};

/// One object per thread; allocates nothing after the first use.
class ImageStages {
 public:
  /// @param size  side of the scan images [px]
  ImageStages(const FftIcpOptions& options, int size, bool use_missing);

  /// Grid, missing-data features and spectra of a reference.
  void prepare(const Scan& scan, const ScanPoints& points, ImageReference& out, MatchTimes& ms);
  /// What only the spectral rotation needs, so that a match that goes without it does not pay for it.
  void finish(ImageReference& reference, MatchTimes& ms);

  /// Step 2: the rotation by missing data, if it is sure.
  std::optional<double> rotation_from_missing(const ImageReference& reference, const Scan& scan, MatchTimes& ms);
  /// Step 3: rotation candidates by spectrum. @pre `finish` was called for the reference.
  const std::vector<RotationCandidate>& rotations_from_spectrum(const ImageReference& reference, const ScanPoints& scan,
                                                                MatchTimes& ms);
  /// Step 4: translation for a given rotation; with its twin the better of both.
  ImageEstimate translate(const ImageReference& reference, const ScanPoints& scan, double theta, bool twin,
                          MatchTimes& ms);

 private:
  FftIcpOptions options_;
  int size_;
  bool use_missing_;
  Rasterizer rasterizer_;
  ImageTransform transform_;
  SpectralRotation rotation_;
  TranslationEstimator translation_;
  MissingFinder finder_;
  MissingMatcher matcher_;
  MissingFeatures scan_missing_;
  Image image_;
  ComplexBuffer spectrum_;
  PolarDescriptor scan_polar_;
  TranslationSpectrum scan_translation_;
  std::vector<RotationCandidate> candidates_;
  std::vector<float> scratch_;
};

}  // namespace phasescan
