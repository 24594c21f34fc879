#include "phasescan/fft_icp/fft_icp.hpp"

#include <algorithm>
#include <optional>
#include <stdexcept>
#include <string>

#include "fft_icp/icp/covariance.hpp"
#include "fft_icp/icp/icp.hpp"
#include "fft_icp/image_stages.hpp"
#include "fft_icp/ndt/ndt.hpp"
#include "match/check_hints.hpp"
#include "match/stage_clock.hpp"
#include "scan/points.hpp"

namespace phasescan {

struct FftIcpReference::Data {
  explicit Data(FftIcpMethod m) : method(m) {}
  FftIcpMethod method;  ///< whose it is: a matcher reads references of its own method only
  ScanPoints points;
  PointIndex index;
  NdtLevels ndt;
  ImageReference image;
};

namespace {

/// Which steps of [Jiang19] Fig. 1 a method has.
struct Steps {
  bool image = false, missing = false, icp = false, ndt = false;
};

Steps steps_of(FftIcpMethod method) {
  switch (method) {
    case FftIcpMethod::kIcp:
      return {.icp = true};
    case FftIcpMethod::kNdt:
      return {.ndt = true};
    case FftIcpMethod::kFft:
      return {.image = true};
    case FftIcpMethod::kFftIcp1:
      return {.image = true, .icp = true};
    default:
      return {.image = true, .missing = true, .icp = true};
  }
}

const FftIcpOptions& checked(const FftIcpOptions& options) {
  options.validate();
  return options;
}

}  // namespace

struct FftIcpMatcher::Impl {
  explicit Impl(const FftIcpOptions& options)
      : options_(checked(options)),
        steps_(steps_of(options.fft_icp.method)),
        icp_(options.icp),
        own_(options.fft_icp.method) {
    if (steps_.image) {
      images_.emplace(options,
                      options.fft_icp.method == FftIcpMethod::kFft ? options.image.fft_size : options.image.size,
                      steps_.missing);
    }
  }

  MatchResult match(const Scan& reference, const Scan& scan, const MatchHints& hints) {
    MatchTimes ms;
    prepare_into(reference, hints.reference_twist, own_, ms);
    return run(own_, &own_, scan, hints, ms);
  }

  std::shared_ptr<const FftIcpReference::Data> prepare(const Scan& reference, const Twist2& twist) {
    MatchTimes ms;
    auto data = std::make_shared<FftIcpReference::Data>(options_.fft_icp.method);
    prepare_into(reference, twist, *data, ms);
    if (images_ && enough(data->points)) images_->finish(data->image, ms);
    return data;
  }

  MatchResult match(const FftIcpReference::Data& reference, const Scan& scan, const MatchHints& hints) {
    return run(reference, nullptr, scan, hints, {});
  }

  const FftIcpOptions& options() const { return options_; }

 private:
  bool enough(const ScanPoints& points) const {
    return points.size() >= static_cast<std::size_t>(options_.fft_icp.min_points) &&
           extent(points) >= options_.fft_icp.min_extent_m;
  }

  void prepare_into(const Scan& reference, const Twist2& twist, FftIcpReference::Data& data, MatchTimes& ms) {
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

  /// @param unfinished  the reference again where it is this matcher's own and may be completed on demand, else null
  MatchResult run(const FftIcpReference::Data& reference, FftIcpReference::Data* unfinished, const Scan& scan,
                  const MatchHints& hints, const MatchTimes& ms) {
    MatchResult result;
    result.diagnostics.ms = ms;
    result.T_ref_scan = hints.guess.value_or(Pose2{});
    result.diagnostics.rotation_source = hints.guess ? RotationSource::kGuess : RotationSource::kNone;
    StageClock clock;
    scan_to_points(scan, points_, 0.0, hints.scan_twist);
    clock.add_to(result.diagnostics.ms.image);
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
        accept(images_->translate(reference.image, points_, hints.guess->theta, false, result.diagnostics.ms),
               RotationSource::kGuess, reference.image.grid, result);
      }
      return result;
    }
    if (steps_.missing && by_missing_data(reference, scan, result)) return result;
    if (unfinished != nullptr) images_->finish(unfinished->image, result.diagnostics.ms);
    ImageEstimate best;
    for (const RotationCandidate& candidate :
         images_->rotations_from_spectrum(reference.image, points_, result.diagnostics.ms)) {
      const ImageEstimate estimate =
          images_->translate(reference.image, points_, candidate.theta, options_.rotation.twin, result.diagnostics.ms);
      if (estimate.score > best.score) best = estimate;
    }
    accept(best, RotationSource::kSpectrum, reference.image.grid, result);
    if (result.usable && steps_.icp) refine(reference, true, result);
    return result;
  }

  /// Steps 2, 4 and 5 with the rotation that the missing data tell. False where they tell none, or where the match it
  /// leads to does not convince: step 3 decides then.
  bool by_missing_data(const FftIcpReference::Data& reference, const Scan& scan, MatchResult& result) {
    const std::optional<double> theta = images_->rotation_from_missing(reference.image, scan, result.diagnostics.ms);
    if (!theta) return false;
    const ImageEstimate estimate = images_->translate(reference.image, points_, *theta, false, result.diagnostics.ms);
    if (estimate.score < options_.missing.verify_score) return false;
    accept(estimate, RotationSource::kMissingData, reference.image.grid, result);
    if (result.usable) refine(reference, true, result);
    const double least = options_.missing.verify_overlap;
    return least == 0.0 || (result.usable && result.overlap >= least);
  }

  void accept(const ImageEstimate& estimate, RotationSource source, const ImageGrid& grid, MatchResult& result) const {
    result.T_ref_scan = estimate.T_ref_scan;
    result.diagnostics.rotation_source = source;
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
  void refine(const FftIcpReference::Data& reference, bool guessed, MatchResult& result) {
    StageClock clock;
    const IcpResult refined = icp_.align(reference.index, points_, result.T_ref_scan, guessed);
    result.T_ref_scan = refined.T_ref_scan;
    result.diagnostics.iterations = refined.iterations;
    result.overlap = refined.overlap;
    settle(refined.converged, options_.icp.min_overlap, result);
    result.covariance = surface_covariance(reference.points, points_, result.T_ref_scan, icp_.pairs());
    clock.add_to(result.diagnostics.ms.refine);
  }

  void refine_ndt(const FftIcpReference::Data& reference, MatchResult& result) {
    StageClock clock;
    const NdtResult refined = align_ndt(reference.ndt, points_, result.T_ref_scan, options_.ndt);
    result.T_ref_scan = refined.T_ref_scan;
    result.diagnostics.iterations = refined.iterations;
    result.overlap = refined.overlap;
    settle(refined.converged, options_.ndt.min_overlap, result);
    // Near the optimum the score is -sum exp(-e^2 / 2): its Hessian is an information matrix, with every point counted
    // in up to four grids.
    result.covariance = covariance_from_information(0.25 * refined.score.hessian);
    clock.add_to(result.diagnostics.ms.refine);
  }

  /// Status of a refinement, and whether it may be acted on.
  static void settle(bool converged, double min_overlap, MatchResult& result) {
    result.status = !converged                     ? MatchStatus::kNotConverged
                    : result.overlap < min_overlap ? MatchStatus::kLowOverlap
                                                   : MatchStatus::kConverged;
    result.usable = result.status == MatchStatus::kConverged;
  }

  FftIcpOptions options_;
  Steps steps_;
  std::optional<ImageStages> images_;
  Icp icp_;
  FftIcpReference::Data own_;
  ScanPoints points_;
};

namespace {

/// Runs one match and measures it as a whole.
template <class Match>
MatchResult timed(Match&& match) {
  StageClock clock;
  MatchResult result = match();
  result.diagnostics.ms.total = 0.0;
  clock.add_to(result.diagnostics.ms.total);
  return result;
}

}  // namespace

FftIcpMatcher::FftIcpMatcher(const FftIcpOptions& options) : impl_(std::make_unique<Impl>(options)) {}
FftIcpMatcher::~FftIcpMatcher() = default;
FftIcpMatcher::FftIcpMatcher(FftIcpMatcher&&) noexcept = default;
FftIcpMatcher& FftIcpMatcher::operator=(FftIcpMatcher&&) noexcept = default;

MatchResult FftIcpMatcher::match(const Scan& reference, const Scan& scan, const MatchHints& hints) {
  check_hints(hints);
  return timed([&] { return impl_->match(reference, scan, hints); });
}

FftIcpReference FftIcpMatcher::prepare(const Scan& reference, const Twist2& twist) {
  check_twist("twist", twist);
  return FftIcpReference(impl_->prepare(reference, twist));
}

MatchResult FftIcpMatcher::match(const FftIcpReference& reference, const Scan& scan, const MatchHints& hints) {
  check_hints(hints);
  const FftIcpMethod prepared_for = reference.data().method, own = options().fft_icp.method;
  if (prepared_for != own) {
    throw std::invalid_argument("reference: prepared for " + std::string(to_string(prepared_for)) +
                                ", this matcher runs " + std::string(to_string(own)));
  }
  return timed([&] { return impl_->match(reference.data(), scan, hints); });
}

const FftIcpOptions& FftIcpMatcher::options() const {
  return impl_->options();
}

MatchResult match_fft_icp(const Scan& reference, const Scan& scan, const FftIcpOptions& options,
                          const MatchHints& hints) {
  return FftIcpMatcher(options).match(reference, scan, hints);
}

}  // namespace phasescan
