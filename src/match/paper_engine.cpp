#include "match/paper_engine.hpp"

#include <algorithm>

#include "match/image_stages.hpp"
#include "match/stage_clock.hpp"
#include "refine/covariance.hpp"
#include "refine/icp.hpp"
#include "refine/ndt.hpp"
#include "scan/points.hpp"

namespace phasescan {
namespace {

struct PaperReference final : Reference::Data {
  using Data::Data;
  ScanPoints points;
  PointIndex index;
  NdtLevels ndt;
  ImageReference image;
};

/// Which steps of PAPER a method has.
struct Steps {
  bool image = false, missing = false, icp = false, ndt = false;
};

Steps steps_of(MatchMethod method) {
  switch (method) {
    case MatchMethod::kIcp:
      return {.icp = true};
    case MatchMethod::kNdt:
      return {.ndt = true};
    case MatchMethod::kFft:
      return {.image = true};
    case MatchMethod::kFftIcp1:
      return {.image = true, .icp = true};
    default:
      return {.image = true, .missing = true, .icp = true};
  }
}

class PaperEngine final : public MatchEngine {
 public:
  explicit PaperEngine(const MatchOptions& options)
      : options_(options),
        steps_(steps_of(options.match.method)),
        icp_(options.icp),
        own_(std::make_shared<PaperReference>(options.match.method)) {
    if (steps_.image) {
      images_.emplace(options, options.match.method == MatchMethod::kFft ? options.image.fft_size : options.image.size,
                      steps_.missing);
    }
  }

  MatchResult match(const Scan& reference, const Scan& scan, const MatchHints& hints) override {
    MatchTimes ms;
    prepare_into(reference, hints.reference_twist, *own_, ms);
    return run(*own_, own_.get(), scan, hints, ms);
  }

  std::shared_ptr<const Reference::Data> prepare(const Scan& reference, const Twist2& twist) override {
    MatchTimes ms;
    auto data = std::make_shared<PaperReference>(options_.match.method);
    prepare_into(reference, twist, *data, ms);
    if (images_ && enough(data->points)) images_->finish(data->image, ms);
    return data;
  }

  MatchResult match(const Reference::Data& reference, const Scan& scan, const MatchHints& hints) override {
    return run(static_cast<const PaperReference&>(reference), nullptr, scan, hints, {});
  }

 private:
  bool enough(const ScanPoints& points) const {
    return points.size() >= static_cast<std::size_t>(options_.match.min_points) &&
           extent(points) >= options_.match.min_extent_m;
  }

  void prepare_into(const Scan& reference, const Twist2& twist, PaperReference& data, MatchTimes& ms) {
    StageClock clock;
    scan_to_points(reference, data.points, 0.0, twist);
    clock.add_to(ms.image);
    if (!enough(data.points)) return;
    if (images_) images_->prepare(reference, data.points, data.image, ms);
    StageClock refine_clock;
    if (steps_.icp) data.index.build(data.points);
    if (steps_.ndt) build_ndt(data.points, options_.ndt, data.ndt);
    refine_clock.add_to(ms.refine);
  }

  /// @param unfinished  the reference again where it is this engine's own and may be completed on demand, else null
  MatchResult run(const PaperReference& reference, PaperReference* unfinished, const Scan& scan,
                  const MatchHints& hints, const MatchTimes& ms) {
    MatchResult result;
    result.ms = ms;
    result.T_ref_scan = hints.guess.value_or(Pose2{});
    result.rotation_source = hints.guess ? RotationSource::kGuess : RotationSource::kNone;
    StageClock clock;
    scan_to_points(scan, points_, 0.0, hints.scan_twist);
    clock.add_to(result.ms.image);
    if (!enough(reference.points) || !enough(points_)) return result;

    if (steps_.ndt) {
      refine_ndt(reference, result);
      return result;
    }
    if (!steps_.image) {
      refine(reference, hints.guess.has_value(), result);
      return result;
    }
    if (hints.guess) {
      if (steps_.icp) {
        refine(reference, true, result);
      } else {
        accept(images_->translate(reference.image, points_, hints.guess->theta, false, result.ms),
               RotationSource::kGuess, reference.image.grid, result);
      }
      return result;
    }
    if (steps_.missing && by_missing_data(reference, scan, result)) return result;
    if (unfinished != nullptr) images_->finish(unfinished->image, result.ms);
    ImageEstimate best;
    for (const RotationCandidate& candidate : images_->rotations_from_spectrum(reference.image, points_, result.ms)) {
      const ImageEstimate estimate =
          images_->translate(reference.image, points_, candidate.theta, options_.rotation.twin, result.ms);
      if (estimate.score > best.score) best = estimate;
    }
    accept(best, RotationSource::kSpectrum, reference.image.grid, result);
    if (result.usable && steps_.icp) refine(reference, true, result);
    return result;
  }

  /// Steps 2, 4 and 5 with the rotation that the missing data tell. False where they tell none, or where the match it
  /// leads to does not convince: step 3 decides then.
  bool by_missing_data(const PaperReference& reference, const Scan& scan, MatchResult& result) {
    const std::optional<double> theta = images_->rotation_from_missing(reference.image, scan, result.ms);
    if (!theta) return false;
    const ImageEstimate estimate = images_->translate(reference.image, points_, *theta, false, result.ms);
    if (estimate.score < options_.missing.verify_score) return false;
    accept(estimate, RotationSource::kMissingData, reference.image.grid, result);
    if (result.usable) refine(reference, true, result);
    const double least = options_.missing.verify_overlap;
    return least == 0.0 || (result.usable && result.overlap >= least);
  }

  void accept(const ImageEstimate& estimate, RotationSource source, const ImageGrid& grid, MatchResult& result) const {
    result.T_ref_scan = estimate.T_ref_scan;
    result.rotation_source = source;
    result.overlap = std::min(1.0, estimate.score);  // a correlation, so a rounding above 1 can occur
    result.status = estimate.score >= options_.translation.min_score && estimate.score > 0.0 ? MatchStatus::kConverged
                                                                                             : MatchStatus::kNoPeak;
    result.usable = result.status == MatchStatus::kConverged;
    // Good to about a pixel and a degree.
    const double pixel = 1.0 / grid.pixels_per_m(), turn = deg_to_rad(1.0),
                 variance = std::min(pixel * pixel, kUnknownVariance);
    result.covariance = Eigen::Vector3d(variance, variance, turn * turn).asDiagonal();
  }

  /// Step 5.
  void refine(const PaperReference& reference, bool guessed, MatchResult& result) {
    StageClock clock;
    const IcpResult refined = icp_.align(reference.index, points_, result.T_ref_scan, guessed);
    result.T_ref_scan = refined.T_ref_scan;
    result.iterations = refined.iterations;
    result.overlap = refined.overlap;
    settle(refined.converged, options_.icp.min_overlap, result);
    result.covariance = surface_covariance(reference.points, points_, result.T_ref_scan, icp_.pairs());
    clock.add_to(result.ms.refine);
  }

  void refine_ndt(const PaperReference& reference, MatchResult& result) {
    StageClock clock;
    const NdtResult refined = align_ndt(reference.ndt, points_, result.T_ref_scan, options_.ndt);
    result.T_ref_scan = refined.T_ref_scan;
    result.iterations = refined.iterations;
    result.overlap = refined.overlap;
    settle(refined.converged, options_.ndt.min_overlap, result);
    // Near the optimum the score is -sum exp(-e^2 / 2): its Hessian is an information matrix, with every point counted
    // in up to four grids.
    result.covariance = covariance_from_information(0.25 * refined.score.hessian);
    clock.add_to(result.ms.refine);
  }

  /// Status of a refinement, and whether it may be acted on.
  static void settle(bool converged, double min_overlap, MatchResult& result) {
    result.status = !converged                     ? MatchStatus::kNotConverged
                    : result.overlap < min_overlap ? MatchStatus::kLowOverlap
                                                   : MatchStatus::kConverged;
    result.usable = result.status == MatchStatus::kConverged;
  }

  MatchOptions options_;
  Steps steps_;
  std::optional<ImageStages> images_;
  Icp icp_;
  std::shared_ptr<PaperReference> own_;
  ScanPoints points_;
};

}  // namespace

std::unique_ptr<MatchEngine> make_paper_engine(const MatchOptions& options) {
  return std::make_unique<PaperEngine>(options);
}

}  // namespace phasescan
