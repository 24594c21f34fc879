#include "localize/pose_confidence.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace phasescan {
namespace {

double odds(double share) {
  constexpr double kRound = 0.02;
  return std::log((share + kRound) / (1.0 + kRound - share));
}

double spread(const PoseEvidence& e) {
  return std::log(std::max(0.01, e.sigma_m) / 0.02);
}

double logistic(double sum) {
  return 1.0 / (1.0 + std::exp(-sum));
}

}  // namespace

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
  return logistic(-3.282 + 1.172 * 0.1 * e.margin + 0.778 * odds(e.explained) - 2.625 * e.contradicting -
                  0.282 * spread(e));
}

double drive_confidence(const PoseEvidence& e, bool led_there) {
  // A logistic regression on 30 simulated drives of five sensors through flats and offices with furniture moved and
  // rooms wiped from the map. It judges where odometry leads from a pose that was ok. What was found alone is right
  // less often than that tells, in rooms alike above all: its constant asks for a view of the way that confirms it.
  constexpr double kLed = 1.197, kFound = -0.3;
  return logistic((led_there ? kLed : kFound) + 0.76 * 0.1 * e.margin + 0.412 * odds(e.explained) -
                  6.43 * e.contradicting - 0.348 * spread(e));
}

}  // namespace phasescan
