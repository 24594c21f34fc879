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
  // A logistic regression over 800 simulated scans in a building, flats and offices, on maps that SLAM made of them; a
  // quarter of the scans are from rooms that the map has not.
  const double sum = -9.6 + 3.03 * std::log1p(e.margin) + 5.5 * (e.explained - 0.6) - 10.8 * e.contradicting -
                     0.22 * std::log(std::max(0.01, e.sigma_m) / 0.02);
  return 1.0 / (1.0 + std::exp(-sum));
}

}  // namespace phasescan
