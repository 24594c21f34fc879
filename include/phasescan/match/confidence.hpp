/// How likely a pose that fft-mh found is right, from what the search saw.
#pragma once

#include <array>
#include <cstddef>

#include "phasescan/match/multi_hypothesis.hpp"

namespace phasescan {

/// What the probability is computed from, in the order of the coefficients.
struct ConfidenceFeatures {
  static constexpr std::size_t kCount = 8;
  std::array<double, kCount> value{};
};

ConfidenceFeatures confidence_features(const PreparedScan& reference, const PreparedScan& scan, const SearchOutcome& outcome);

/// Probability that the best hypothesis is within 0.1 m and 3 deg of the truth: a logistic function of the features, fitted
/// by tools/fit_confidence on simulated pairs.
double confidence_of(const ConfidenceFeatures& features);

}  // namespace phasescan
