#include "match/global_matcher.hpp"

#include <algorithm>
#include <stdexcept>

#include "match/check_hints.hpp"
#include "match/confidence.hpp"

namespace phasescan {
namespace {

const MatchOptions& checked(const MatchOptions& options) {
  options.validate();
  return options;
}

// What the search found, as an answer.
void judge(const SearchOutcome& outcome, double min_confidence, MatchResult& result) {
  const Hypothesis& best = outcome.hypotheses.front();
  const int hits = std::max(outcome.evidence.hits, 1);
  result.T_ref_scan = best.T_ref_scan;
  result.diagnostics.rotation_source = best.source;
  result.diagnostics.iterations = outcome.refined.iterations;
  result.diagnostics.violation = outcome.evidence.violation / hits;
  result.overlap = std::clamp(outcome.evidence.matched / hits, 0.0, 1.0);
  result.diagnostics.noise_covariance = noise_covariance_of(outcome);
  result.covariance = covariance_of(outcome, result.diagnostics.noise_covariance);
  const ConfidenceFeatures features = confidence_features(outcome);
  result.diagnostics.features.assign(features.value.begin(), features.value.end());
  const double confidence = confidence_of(features);
  result.confidence = confidence;
  result.ambiguous = is_ambiguous(outcome);
  // Only one of them can be right: what the best one leaves is shared among the others.
  double sum = 0.0;
  for (std::size_t k = 1; k < outcome.hypotheses.size(); ++k) sum += weight_beside_best(outcome, k);
  const double scale = std::min(confidence, (1.0 - confidence) / std::max(sum, 1e-12));
  for (std::size_t k = 1; k < outcome.hypotheses.size(); ++k)
    result.alternatives.push_back({outcome.hypotheses[k].T_ref_scan, scale * weight_beside_best(outcome, k)});
  const bool likely = confidence > min_confidence;
  result.usable = likely && !result.ambiguous;
  result.status = result.ambiguous ? MatchStatus::kAmbiguous
                  : likely         ? MatchStatus::kConverged
                                   : MatchStatus::kLowConfidence;
}

}  // namespace

GlobalMatcher::GlobalMatcher(const MatchOptions& options, std::unique_ptr<RotationProposer> proposer)
    : options_(checked(options)),
      proposer_(std::move(proposer)),
      search_(options.match.fast ? fast_options(options.global) : options.global) {
  if (proposer_ == nullptr) return;
  own_.cue = proposer_->make_cue();
  scan_cue_ = proposer_->make_cue();
}

PrepareOptions GlobalMatcher::prepare_options(bool reference) const {
  PrepareOptions prepare = search_.prepare_options(reference);
  prepare.revolution_turn_deg = options_.match.revolution_turn_deg;
  return prepare;
}

void GlobalMatcher::prepare_into(const Scan& reference, const Twist2& twist, Reference::Data& out) {
  prepare_scan(reference, twist, prepare_options(true), work_, out.prepared);
  if (proposer_ != nullptr) proposer_->describe(reference, *out.cue);
}

MatchResult GlobalMatcher::match(const Scan& reference, const Scan& scan, const MatchHints& hints) {
  check_hints(hints);
  MatchTimer timer;
  prepare_into(reference, hints.reference_twist, own_);
  return match_prepared(own_, scan, hints, timer);
}

Reference GlobalMatcher::prepare(const Scan& reference, const Twist2& twist) {
  check_twist("twist", twist);
  auto data = std::make_shared<Reference::Data>();
  if (proposer_ != nullptr) data->cue = proposer_->make_cue();
  prepare_into(reference, twist, *data);
  return Reference(std::move(data));
}

MatchResult GlobalMatcher::match(const Reference& reference, const Scan& scan, const MatchHints& hints) {
  check_hints(hints);
  if (proposer_ != nullptr && reference.data().cue == nullptr)
    throw std::invalid_argument("reference: prepared by a matcher that finds rotations another way");
  MatchTimer timer;
  return match_prepared(reference.data(), scan, hints, timer);
}

MatchResult GlobalMatcher::match_prepared(const Reference::Data& reference, const Scan& scan, const MatchHints& hints,
                                          MatchTimer& timer) {
  MatchResult result;
  result.T_ref_scan = hints.guess.value_or(Pose2{});
  result.diagnostics.rotation_source = hints.guess ? RotationSource::kGuess : RotationSource::kNone;
  result.confidence = 0.0;
  prepare_scan(scan, hints.scan_twist, prepare_options(false), work_, scan_);
  timer.end_of(&MatchTimes::image);
  const auto least = static_cast<std::size_t>(options_.match.min_points);
  if (reference.prepared.size() >= least && scan_.size() >= least) {
    search(reference, scan, hints, timer);
    if (outcome_.hypotheses.empty()) {
      result.status = MatchStatus::kNoPeak;
    } else {
      judge(outcome_, options_.match.min_confidence, result);
    }
  }
  timer.clock.add_all_to(timer.ms.total);
  result.diagnostics.ms = timer.ms;
  return result;
}

void GlobalMatcher::search(const Reference::Data& reference, const Scan& scan, const MatchHints& hints,
                           MatchTimer& timer) {
  if (proposer_ != nullptr) {
    proposer_->describe(scan, *scan_cue_);
    proposed_.clear();
    proposer_->propose(reference.prepared, *reference.cue, scan_, *scan_cue_, proposed_);
    timer.end_of(&MatchTimes::rotation);
  }
  search_.run(reference.prepared, scan_, hints.guess, proposer_ != nullptr ? &proposed_ : nullptr, outcome_, &timer);
}

}  // namespace phasescan
