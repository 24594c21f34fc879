#include "fft_icp/rotation_proposers.hpp"

#include <vector>

#include "fft_icp/image/rasterize.hpp"
#include "fft_icp/missing/from_missing.hpp"
#include "fft_icp/rotation/from_spectrum.hpp"
#include "fft_icp/spectrum/spectrum.hpp"

namespace phasescan {
namespace {

// Images, spectra, correlation of their rings. The image shows what the reference's scale says, so nothing can be
// prepared of a scan alone.
class SpectrumProposer final : public RotationProposer {
 public:
  explicit SpectrumProposer(int peaks)
      : rasterizer_(image_.blur_px, image_.connect_m),
        transform_(image_.size, options_.window),
        rotation_(image_.size, options_, with_peaks(peaks)) {}

  std::unique_ptr<Cue> make_cue() const override { return std::make_unique<Cue>(); }
  void describe(const Scan&, Cue&) override {}
  void propose(const PreparedScan& reference, const Cue&, const PreparedScan& scan, const Cue&,
               std::vector<RotationHypothesis>& out) override {
    const ImageGrid grid{image_.size, reference.scale_m};
    transform(reference, grid, of_reference_);
    transform(scan, grid, of_scan_);
    rotation_.candidates(of_reference_, of_scan_, peaks_);
    for (const RotationCandidate& peak : peaks_) {
      out.push_back({peak.theta, RotationSource::kSpectrum});
      out.push_back({wrap_angle(peak.theta + kPi), RotationSource::kSpectrum});
    }
  }

 private:
  static RotationOptions with_peaks(int count) {
    RotationOptions options;
    options.candidates = count;
    return options;
  }

  void transform(const PreparedScan& scan, const ImageGrid& grid, PolarDescriptor& out) {
    points_.clear();
    for (std::size_t i = 0; i < scan.size(); ++i) {
      points_.x.push_back(scan.surface[i].x);
      points_.y.push_back(scan.surface[i].y);
      points_.range.push_back(scan.surface.range[i]);
      points_.beam.push_back(scan.surface.beam[i]);
    }
    rasterizer_.draw(points_, 0.0, grid, drawn_);
    transform_.forward(drawn_, half_spectrum_);
    rotation_.describe(half_spectrum_, out);
  }

  ImageOptions image_;
  SpectrumOptions options_;
  Rasterizer rasterizer_;
  ImageTransform transform_;
  SpectralRotation rotation_;
  ScanPoints points_;
  Image drawn_;
  ComplexBuffer half_spectrum_;
  PolarDescriptor of_reference_, of_scan_;
  std::vector<RotationCandidate> peaks_;
};

class MissingProposer final : public RotationProposer {
 public:
  explicit MissingProposer(double half_step_rad) : half_step_rad_(half_step_rad) {}

  std::unique_ptr<Cue> make_cue() const override { return std::make_unique<Features>(); }
  void describe(const Scan& scan, Cue& out) override {
    finder_.find(scan, 0.0, deg_to_rad(options_.min_width_deg), static_cast<Features&>(out).missing);
  }
  void propose(const PreparedScan&, const Cue& of_reference, const PreparedScan&, const Cue& of_scan,
               std::vector<RotationHypothesis>& out) override {
    const MissingRotation rotation = matcher_.match(static_cast<const Features&>(of_reference).missing,
                                                    static_cast<const Features&>(of_scan).missing, options_);
    if (!rotation.accepted) return;
    for (const double offset : {-half_step_rad_, 0.0, half_step_rad_})
      out.push_back({wrap_angle(rotation.theta + offset), RotationSource::kMissingData});
  }

 private:
  struct Features final : Cue {
    MissingFeatures missing;
  };

  double half_step_rad_;
  MissingOptions options_;
  MissingFinder finder_;
  MissingMatcher matcher_;
};

}  // namespace

std::unique_ptr<RotationProposer> propose_from_spectrum(int peaks) {
  return std::make_unique<SpectrumProposer>(peaks);
}

std::unique_ptr<RotationProposer> propose_from_missing(double half_step_rad) {
  return std::make_unique<MissingProposer>(half_step_rad);
}

}  // namespace phasescan
