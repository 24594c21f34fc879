/// How likely a pose that the global search found is right, from what the search saw.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "match/global_search.hpp"

namespace phasescan {

/// What the probability is computed from, in the order of the coefficients: what the search saw, and products of it.
struct ConfidenceFeatures {
  static constexpr std::size_t kSeen = 16, kProducts = 17, kCount = kSeen + kProducts;
  std::array<double, kCount> value{};
};

/// Their names, as in the tables that `bench --features` writes.
std::vector<std::string> confidence_feature_names();

ConfidenceFeatures confidence_features(const SearchOutcome& outcome);

/// Probability that the best hypothesis is within 0.1 m and 3 deg of the truth: a logistic function of the features,
/// fitted by tools/fit_confidence.py on simulated pairs alone.
double confidence_of(const ConfidenceFeatures& features);

/// Standard deviation of the translation in its weakest direction [m], the rotation unknown as well.
double weakest_sigma(const Eigen::Matrix3d& information);

/// Another pose explains the scans as well: the next distinct one scores alike, or the pose slides along a corridor.
bool is_ambiguous(const SearchOutcome& outcome);

/// How likely hypothesis `k` is beside the best one, by what both scans say of them: 1 where they tie.
double weight_beside_best(const SearchOutcome& outcome, std::size_t k);

/// Covariance of the error of (x, y, theta) in the reference frame: wide along what the surfaces leave open; where the
/// pose does not slide and others tie with it, as wide as they lie apart (a mixture of them). Capped at 1e6. Along a
/// corridor its half-turn twin is left out: it would hide how well the pose is known across.
/// As the noise of the ranges alone leaves it.
/// @source [Censi07]
Eigen::Matrix3d noise_covariance_of(const SearchOutcome& outcome);

/// The same, as wide as the residuals show, with the turn of whole revolutions.
Eigen::Matrix3d covariance_of(const SearchOutcome& outcome, const Eigen::Matrix3d& noise_covariance);

inline Eigen::Matrix3d covariance_of(const SearchOutcome& outcome) {
  return covariance_of(outcome, noise_covariance_of(outcome));
}

}  // namespace phasescan
