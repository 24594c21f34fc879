#include "match/mh_engine.hpp"

#include <algorithm>
#include <cmath>

#include "match/stage_clock.hpp"
#include "match/confidence.hpp"
#include "match/multi_hypothesis.hpp"

namespace phasescan {
namespace {

struct MhReference final : Reference::Data {
  MhReference() : Data(MatchMethod::kFftMh) {}
  PreparedScan prepared;
};

class MhEngine final : public MatchEngine {
 public:
  explicit MhEngine(const MatchOptions& options)
      : options_(options),
        search_(options.match.fast ? options.mh.fast() : options.mh),
        own_(std::make_shared<MhReference>()) {}

  MatchResult match(const Scan& reference, const Scan& scan, const MatchHints& hints) override {
    MatchTimes ms;
    StageClock clock;
    prepare_scan(reference, hints.reference_twist, search_.prepare_options(true), work_, own_->prepared);
    clock.add_to(ms.image);
    return match_prepared(own_->prepared, scan, hints, ms);
  }

  std::shared_ptr<const Reference::Data> prepare(const Scan& reference, const Twist2& twist) override {
    auto data = std::make_shared<MhReference>();
    prepare_scan(reference, twist, search_.prepare_options(true), work_, data->prepared);
    return data;
  }

  MatchResult match(const Reference::Data& reference, const Scan& scan, const MatchHints& hints) override {
    return match_prepared(static_cast<const MhReference&>(reference).prepared, scan, hints, {});
  }

 private:
  MatchResult match_prepared(const PreparedScan& reference, const Scan& scan, const MatchHints& hints,
                             const MatchTimes& ms) {
    MatchResult result;
    result.ms = ms;
    result.T_ref_scan = hints.guess.value_or(Pose2{});
    result.rotation_source = hints.guess ? RotationSource::kGuess : RotationSource::kNone;
    result.confidence = 0.0;
    StageClock clock;
    prepare_scan(scan, hints.scan_twist, search_.prepare_options(false), work_, scan_);
    clock.add_to(result.ms.image);
    const auto least = static_cast<std::size_t>(options_.match.min_points);
    if (reference.size() < least || scan_.size() < least) return result;

    SearchTimes times;
    search_.run(reference, scan_, hints.guess, outcome_, &times);
    result.ms.rotation = times.rotation;
    result.ms.translation = times.translation;
    result.ms.refine = times.refine;
    if (outcome_.hypotheses.empty()) {
      result.status = MatchStatus::kNoPeak;
      return result;
    }
    const Hypothesis& best = outcome_.hypotheses.front();
    result.T_ref_scan = best.T_ref_scan;
    result.rotation_source = best.source;
    result.iterations = outcome_.refined.iterations;
    result.overlap = std::clamp(outcome_.evidence.matched / std::max(outcome_.evidence.hits, 1), 0.0, 1.0);
    result.violation = outcome_.evidence.violation / std::max(outcome_.evidence.hits, 1);
    result.covariance = covariance_of(outcome_);
    const ConfidenceFeatures features = confidence_features(outcome_);
    result.features.assign(features.value.begin(), features.value.end());
    result.confidence = confidence_of(features);
    result.ambiguous = is_ambiguous(outcome_);
    // Only one of them can be right: what the best one leaves is shared among the others.
    double sum = 0.0;
    for (std::size_t k = 1; k < outcome_.hypotheses.size(); ++k) sum += weight_beside_best(outcome_, k);
    const double scale = std::min(*result.confidence, (1.0 - *result.confidence) / std::max(sum, 1e-12));
    for (std::size_t k = 1; k < outcome_.hypotheses.size(); ++k)
      result.alternatives.push_back({outcome_.hypotheses[k].T_ref_scan, scale * weight_beside_best(outcome_, k)});
    const bool likely = *result.confidence > options_.match.min_confidence;
    result.usable = likely && !result.ambiguous;
    result.status = result.ambiguous ? MatchStatus::kAmbiguous
                    : likely         ? MatchStatus::kConverged
                                     : MatchStatus::kLowConfidence;
    return result;
  }

  MatchOptions options_;
  MultiHypothesisSearch search_;
  PrepareWorkspace work_;
  std::shared_ptr<MhReference> own_;
  PreparedScan scan_;
  SearchOutcome outcome_;
};

}  // namespace

std::unique_ptr<MatchEngine> make_mh_engine(const MatchOptions& options) {
  return std::make_unique<MhEngine>(options);
}

}  // namespace phasescan
