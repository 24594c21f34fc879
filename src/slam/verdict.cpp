#include "slam/verdict.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace phasescan {
namespace {

constexpr double kGood = 0.97, kFailed = 0.2;               // probabilities
constexpr double kLeastOnMap = 0.5;                         // share of the scans with a return
constexpr double kLeastInParts = 0.25, kMostInParts = 0.9;  // of a run in parts: doubtful, whatever each part is worth
constexpr double kMostWhereWheelsWentOn = 0.9;              // doubtful, however well the scans agree with each other
constexpr double kForemost = 100.0;                         // against: the first of the reasons
constexpr double kSurest = 0.999;  // no run is surer than as many runs as it was fitted on can show

/// Adds weight * log(1 + (number / scale)^2) to the log-odds that the map is right.
struct Feature {
  const char* number;  // of the evidence
  const char* kind;    // of the reason that it is
  double scale, weight;
};

// Fitted by tools/verdict_fit.py on simulated runs. None of the numbers grows with the length of a run by itself.
constexpr double kConstant = 5.10;
constexpr std::array kFeatures{
    Feature{"far_tail_crossed", "contradiction", 0.15, -1.10},
    Feature{"far_tail_in_free", "contradiction", 0.3, -1.09},
    Feature{"excess_crossed", "contradiction", 0.03, -0.69},
    Feature{"excess_in_free", "contradiction", 0.05, -0.50},
    Feature{"near_tail_against", "contradiction", 0.3, -0.53},
    Feature{"far_tail_doubled", "doubled_walls", 0.15, -1.29},
    Feature{"excess_doubled", "doubled_walls", 0.03, -0.71},
    Feature{"expected_ratio", "gaps", 0.5, -1.41},
    Feature{"lost_unaided", "gaps", 0.05, -1.08},
    Feature{"unseen_ratio", "gaps", 8.0, -1.65},
    Feature{"jump_ratio", "gaps", 1.0, -1.50},
    Feature{"off_map", "pieces", 0.03, -0.80},
    Feature{"off_map_ratio", "pieces", 0.2, -0.43},
    Feature{"no_overlap", "bad_scans", 0.1, -0.61},
    Feature{"kept", "bad_scans", 0.15, -0.64},
    Feature{"degraded_unconfirmed", "bad_scans", 0.5, -0.70},
    Feature{"left_out", "bad_scans", 0.1, -0.31},
    Feature{"step_chi2_tail", "aliasing", 3.0, -0.86},
    Feature{"bend_ratio", "aliasing", 0.3, -0.76},
    Feature{"loop_chi2_tail", "aliasing", 10.0, -0.56},
    Feature{"unseen_doubted", "aliasing", 1.0, -0.77},
    Feature{"open_doubted", "aliasing", 0.5, -1.30},
    Feature{"degraded_bent", "aliasing", 2.0, -1.63},
    Feature{"wheels_slipped", "wheels", 0.3, -0.23},
};

}  // namespace

Judgement judge_run(const RunEvidence& evidence, bool in_parts) {
  Judgement judgement;
  std::map<std::string, double>& numbers = judgement.verdict.evidence;
  RunEvidence::visit(evidence, [&numbers](const std::string& name, double value) { numbers[name] = value; });
  const auto weight_of = [&weights = judgement.weights](const char* kind) -> double& {
    auto known = std::find_if(weights.begin(), weights.end(), [kind](const auto& w) { return w.kind == kind; });
    if (known == weights.end()) known = weights.insert(known, {kind, 0.0});
    return known->against;
  };
  double log_odds = kConstant;
  for (const Feature& feature : kFeatures) {
    const double ratio = numbers.at(feature.number) / feature.scale;
    const double part = feature.weight * std::log1p(ratio * ratio);
    log_odds += part;
    weight_of(feature.kind) -= part;
  }
  if (evidence.wheels_went_on()) weight_of("wheels") += kForemost;
  std::stable_sort(judgement.weights.begin(), judgement.weights.end(),
                   [](const ReasonWeight& a, const ReasonWeight& b) { return a.against > b.against; });
  double& probability = judgement.verdict.probability;
  probability = std::clamp(1.0 / (1.0 + std::exp(-log_odds)), 1.0 - kSurest, kSurest);
  if (evidence.wheels_went_on()) probability = std::min(probability, kMostWhereWheelsWentOn);
  if (in_parts) {
    probability = std::clamp(probability, kLeastInParts, kMostInParts);
  } else if (evidence.on_map < kLeastOnMap) {
    probability = std::min(probability, kFailed);
  }
  judgement.verdict.verdict = probability >= kGood     ? Verdict::kGood
                              : probability <= kFailed ? Verdict::kFailed
                                                       : Verdict::kDoubtful;
  return judgement;
}

}  // namespace phasescan
