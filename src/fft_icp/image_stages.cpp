#include "fft_icp/image_stages.hpp"

#include "match/stage_clock.hpp"

namespace phasescan {

ImageStages::ImageStages(const FftIcpOptions& options, int size, bool use_missing)
    : options_(options),
      size_(size),
      use_missing_(use_missing),
      rasterizer_(options.image.blur_px, options.image.connect_m),
      transform_(size, options.spectrum.window),
      rotation_(size, options.spectrum, options.rotation),
      translation_(size, options.translation) {}

void ImageStages::prepare(const Scan& scan, const ScanPoints& points, ImageReference& out, MatchTimes& ms) {
  StageClock clock;
  out.grid = choose_grid(points, options_.image, size_, scratch_);
  rasterizer_.draw(points, 0.0, out.grid, image_);
  clock.add_to(ms.image);
  if (use_missing_) {
    finder_.find(scan, options_.missing.beyond_dmax ? out.grid.dmax_m : 0.0, deg_to_rad(options_.missing.min_width_deg),
                 out.missing);
    clock.add_to(ms.missing);
  }
  transform_.forward(image_, out.spectrum);
  clock.add_to(ms.rotation);
  // One FFT of the reference serves rotation and translation, unless one of them wants it otherwise.
  if (translation_.two_dimensional() && options_.spectrum.window == ImageWindow::kNone) {
    translation_.describe(out.spectrum, out.translation);
  } else {
    translation_.describe(image_, out.translation);
  }
  clock.add_to(ms.translation);
}

void ImageStages::finish(ImageReference& reference, MatchTimes& ms) {
  StageClock clock;
  rotation_.describe(reference.spectrum, reference.polar);
  clock.add_to(ms.rotation);
}

std::optional<double> ImageStages::rotation_from_missing(const ImageReference& reference, const Scan& scan,
                                                         MatchTimes& ms) {
  StageClock clock;
  finder_.find(scan, options_.missing.beyond_dmax ? reference.grid.dmax_m : 0.0,
               deg_to_rad(options_.missing.min_width_deg), scan_missing_);
  const MissingRotation found = matcher_.match(reference.missing, scan_missing_, options_.missing);
  clock.add_to(ms.missing);
  return found.accepted ? std::optional<double>(found.theta) : std::nullopt;
}

const std::vector<RotationCandidate>& ImageStages::rotations_from_spectrum(const ImageReference& reference,
                                                                           const ScanPoints& scan, MatchTimes& ms) {
  StageClock clock;
  rasterizer_.draw(scan, 0.0, reference.grid, image_);
  clock.add_to(ms.image);
  transform_.forward(image_, spectrum_);
  rotation_.describe(spectrum_, scan_polar_);
  rotation_.candidates(reference.polar, scan_polar_, candidates_);
  clock.add_to(ms.rotation);
  return candidates_;
}

ImageEstimate ImageStages::translate(const ImageReference& reference, const ScanPoints& scan, double theta, bool twin,
                                     MatchTimes& ms) {
  StageClock clock;
  rasterizer_.draw(scan, theta, reference.grid, image_);
  clock.add_to(ms.image);
  translation_.describe(image_, scan_translation_);
  TranslationPeak peak = translation_.find(reference.translation, scan_translation_);
  if (twin) {
    const TranslationPeak other = translation_.find_twin(reference.translation, scan_translation_);
    if (other.score > peak.score) {
      peak = other;
      theta += kPi;
    }
  }
  const double metres = 1.0 / reference.grid.pixels_per_m();
  clock.add_to(ms.translation);
  return {{peak.col * metres, peak.row * metres, wrap_angle(theta)}, peak.score, RotationSource::kNone};
}

}  // namespace phasescan
