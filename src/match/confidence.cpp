#include "phasescan/match/confidence.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace phasescan {
namespace {

constexpr std::array<double, ConfidenceFeatures::kCount> kCoefficients{
    -4.831, -3.643, 1.006, 0.221, -3.277, -0.602, -3.171, 6.929, 7.839, 8.800, 6.822, 11.478, 1.173};

constexpr double kMostVariance = 1e6;
// The information counts every matched beam at its kernel's weight and so understates what the rest says; set so that
// 95 % of simulated errors fall within the 95 % region.
constexpr double kInflation = 0.66;
constexpr double kSlideVariance = 100.0;  // [m^2] where it does: as far as such a sensor sees
constexpr double kSlides_m = 0.05;  // less certain than this along some direction: a corridor, where the pose may slide

// Along a corridor both scans agree as well a little farther on.
bool may_slide(const SearchOutcome& outcome) {
  return outcome.profile < 0.01 || weakest_sigma(outcome.refined.information) > kSlides_m;
}

}  // namespace

double weakest_sigma(const Eigen::Matrix3d& information) {
  const Eigen::Vector2d coupling = information.topRightCorner<2, 1>();
  const Eigen::Matrix2d marginal =
      information.topLeftCorner<2, 2>() - coupling * coupling.transpose() / std::max(information(2, 2), 1e-9);
  const double trace = marginal.trace();
  const double det = marginal(0, 0) * marginal(1, 1) - marginal(0, 1) * marginal(1, 0);
  const double weak = 0.5 * (trace - std::sqrt(std::max(trace * trace - 4.0 * det, 0.0)));
  return 1.0 / std::sqrt(std::max(weak, 1.0 / kMostVariance));
}

bool is_ambiguous(const SearchOutcome& outcome) {
  return outcome.margin < 0.05 || may_slide(outcome);
}

Eigen::Matrix3d covariance_of(const SearchOutcome& outcome) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(outcome.refined.information);
  Eigen::Vector3d variances =
      (kInflation * eigen.eigenvalues().cwiseMax(1.0 / kMostVariance).cwiseInverse()).cwiseMin(kMostVariance);
  // What then seems to hold the pose is noise of the normals.
  if (may_slide(outcome)) variances(0) = kSlideVariance;
  return eigen.eigenvectors() * variances.asDiagonal() * eigen.eigenvectors().transpose();
}

std::array<std::string_view, ConfidenceFeatures::kCount> confidence_feature_names() {
  return {"constant", "score",    "log_margin", "log_profile", "log_sigma", "log_partners", "violation",
          "matched",  "occluded", "empty",      "stray",       "low_score", "log_agreement"};
}

ConfidenceFeatures confidence_features(const SearchOutcome& outcome) {
  ConfidenceFeatures f;
  if (outcome.hypotheses.empty()) return f;
  const auto log_of = [](double value) { return std::log(std::clamp(value, 1e-3, 1.0)) + 3.0; };
  const Evidence& e = outcome.evidence;
  const double hits = std::max(e.hits, 1);
  f.value[0] = 1.0;
  f.value[1] = outcome.hypotheses.front().score;
  f.value[2] = log_of(outcome.margin);
  f.value[3] = log_of(outcome.profile);
  f.value[4] = std::log10(std::clamp(weakest_sigma(outcome.refined.information), 1e-3, 1.0)) + 2.0;
  f.value[5] = std::log(std::clamp(static_cast<double>(outcome.refined.partners), 10.0, 400.0) / 100.0);
  f.value[6] = e.violation / hits;
  f.value[7] = e.matched / hits;
  f.value[8] = e.occluded / hits;
  f.value[9] = e.empty / hits;
  f.value[10] = e.stray / hits;
  f.value[11] = std::min(f.value[1], 0.2);
  f.value[12] = std::log((e.matched + 0.5) / (e.matched + e.violation + e.stray + e.empty + e.occluded + 1.0));
  return f;
}

double confidence_of(const ConfidenceFeatures& features) {
  double sum = 0.0;
  for (std::size_t k = 0; k < ConfidenceFeatures::kCount; ++k) sum += kCoefficients[k] * features.value[k];
  return 1.0 / (1.0 + std::exp(-std::clamp(sum, -30.0, 30.0)));
}

}  // namespace phasescan
