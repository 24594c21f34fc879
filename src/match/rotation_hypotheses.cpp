#include "match/rotation_hypotheses.hpp"

#include <algorithm>
#include <cmath>

#include "image/rasterize.hpp"
#include "rotation/from_missing.hpp"
#include "rotation/from_normals.hpp"
#include "rotation/from_spectrum.hpp"
#include "spectrum/spectrum.hpp"

namespace phasescan {

// The paper's way: images, spectra, correlation of their rings; both of each peak's twins.
struct RotationHypotheses::Spectral {
  explicit Spectral(int peak_count)
      : rasterizer(image.blur_px, image.connect_m),
        transform(image.size, options.window),
        rotation(image.size, options, with_peaks(peak_count)) {}

  static RotationOptions with_peaks(int count) {
    RotationOptions rotation_options;
    rotation_options.candidates = count;
    return rotation_options;
  }

  void describe(const PreparedScan& scan, const ImageGrid& grid, PolarDescriptor& out) {
    points.clear();
    for (std::size_t i = 0; i < scan.size(); ++i) {
      points.x.push_back(scan.surface[i].x);
      points.y.push_back(scan.surface[i].y);
      points.range.push_back(scan.surface.range[i]);
      points.beam.push_back(scan.surface.beam[i]);
    }
    rasterizer.draw(points, 0.0, grid, drawn);
    transform.forward(drawn, half_spectrum);
    rotation.describe(half_spectrum, out);
  }

  ImageOptions image;
  SpectrumOptions options;
  Rasterizer rasterizer;
  ImageTransform transform;
  SpectralRotation rotation;
  ScanPoints points;
  Image drawn;
  ComplexBuffer half_spectrum;
  PolarDescriptor of_reference, of_scan;
  std::vector<RotationCandidate> peaks;
};

RotationHypotheses::RotationHypotheses(const MhOptions& options) : options_(options) {
  if (options.rotations == RotationSearch::kSpectrum) spectral_ = std::make_unique<Spectral>(options.rotation_peaks);
}
RotationHypotheses::~RotationHypotheses() = default;

void RotationHypotheses::all(double centre, int steps_each_side, std::vector<RotationHypothesis>& out) const {
  const int steps = std::max(1, static_cast<int>(std::lround(360.0 / options_.sweep_step_deg)));
  const bool whole_turn = 2 * steps_each_side + 1 >= steps;
  const int from = whole_turn ? 0 : -steps_each_side, to = whole_turn ? steps - 1 : steps_each_side;
  for (int k = from; k <= to; ++k) out.push_back({wrap_angle(centre + kTwoPi * k / steps), RotationSource::kSweep});
}

void RotationHypotheses::list_all(std::vector<RotationHypothesis>& out) const {
  out.clear();
  all(0.0, 1 << 20, out);
}

void RotationHypotheses::list(const PreparedScan& reference, const PreparedScan& scan,
                              const std::optional<Pose2>& guess, std::vector<RotationHypothesis>& out) {
  out.clear();
  if (guess) {
    all(guess->theta, static_cast<int>(std::ceil(options_.guess_turn_deg / options_.sweep_step_deg)), out);
    for (RotationHypothesis& hypothesis : out) hypothesis.source = RotationSource::kGuess;
    return;
  }
  if (options_.rotations == RotationSearch::kNormals || options_.rotations == RotationSearch::kAutomatic) {
    NormalCorrelation correlation;
    correlate_normals(reference.normals, scan.normals, correlation);
    normal_peaks(correlation, options_.rotation_peaks, angles_);
    for (const double theta : angles_) out.push_back({theta, RotationSource::kNormals});
  } else if (options_.rotations == RotationSearch::kMissing) {
    const MissingRotation rotation = MissingMatcher().match(reference.missing, scan.missing, MissingOptions{});
    if (rotation.accepted) {
      const double half_step = 0.5 * deg_to_rad(options_.sweep_step_deg);
      for (const double offset : {-half_step, 0.0, half_step}) {
        out.push_back({wrap_angle(rotation.theta + offset), RotationSource::kMissingData});
      }
    }
  } else if (options_.rotations == RotationSearch::kSpectrum) {
    Spectral& s = *spectral_;
    const ImageGrid grid{s.image.size, reference.scale_m};
    s.describe(reference, grid, s.of_reference);
    s.describe(scan, grid, s.of_scan);
    s.rotation.candidates(s.of_reference, s.of_scan, s.peaks);
    for (const RotationCandidate& peak : s.peaks) {
      out.push_back({peak.theta, RotationSource::kSpectrum});
      out.push_back({wrap_angle(peak.theta + kPi), RotationSource::kSpectrum});
    }
  }
  // The complete sweep: where asked for, and where a source has nothing to say.
  if (out.empty()) all(0.0, 1 << 20, out);
}

}  // namespace phasescan
