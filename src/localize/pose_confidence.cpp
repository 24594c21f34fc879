#include "localize/pose_confidence.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace phasescan {

PoseEvidence evidence_of(const FoundPose& pose, double margin) {
  PoseEvidence evidence;
  evidence.margin = std::clamp(margin, 0.0, kMostMargin);
  evidence.explained = pose.fit.explained;
  evidence.contradicting = pose.fit.contradicting;
  const Eigen::Matrix2d position = pose.covariance.topLeftCorner<2, 2>();
  evidence.sigma_m =
      std::sqrt(std::max(0.0, Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(position).eigenvalues().maxCoeff()));
  return evidence;
}

double pose_confidence(const PoseEvidence& e) {
  // A logistic regression by tools/localize_fit.py: simulated scans of six sensors in buildings, flats, offices and
  // halls, on maps that SLAM made of them. A quarter of the scans are from rooms that were wiped from the map; in half
  // of the worlds furniture was moved since and people stand about. The margin counts as it is, not its logarithm: what
  // is far ahead of all other places is right even where furniture hides much of the map.
  constexpr double kRound = 0.02;
  const double odds = std::log((e.explained + kRound) / (1.0 + kRound - e.explained));
  const double sum = -3.282 + 1.172 * 0.1 * e.margin + 0.778 * odds - 2.625 * e.contradicting -
                     0.282 * std::log(std::max(0.01, e.sigma_m) / 0.02);
  return 1.0 / (1.0 + std::exp(-sum));
}

}  // namespace phasescan
