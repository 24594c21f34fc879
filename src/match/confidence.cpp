#include "match/confidence.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

namespace phasescan {
namespace {

// What the search saw, in the order of the features.
enum SeenFeature : std::size_t {
  kConstant,
  kScore,
  kMargin,
  kProfile,
  kSigma,
  kPartners,
  kViolation,
  kMatched,
  kOccluded,
  kEmpty,
  kStray,
  kLowScore,
  kSilent,
  kAgreement,
  kSlides,
  kTie
};
constexpr std::array<std::string_view, ConfidenceFeatures::kSeen> kNames{
    "constant", "score", "log_margin", "log_profile", "log_sigma", "log_partners",  "violation", "matched",
    "occluded", "empty", "stray",      "low_score",   "silent",    "log_agreement", "slides",    "tie"};

// Doubts add up, and the more of one the less of the other it takes. Where the pose slides or ties with another, what
// is seen means something else.
constexpr std::array<std::pair<SeenFeature, SeenFeature>, ConfidenceFeatures::kProducts> kProductOf{{
    {kMargin, kProfile},
    {kMargin, kMargin},
    {kProfile, kProfile},
    {kSigma, kSigma},
    {kMargin, kSigma},
    {kAgreement, kAgreement},
    {kScore, kScore},
    {kScore, kMargin},
    {kSilent, kSilent},
    {kSilent, kScore},
    {kSlides, kScore},
    {kSlides, kMargin},
    {kSlides, kSigma},
    {kTie, kScore},
    {kTie, kMargin},
    {kTie, kSigma},
    {kTie, kSilent},
}};

constexpr std::array<double, ConfidenceFeatures::kCount> kCoefficients{
    -1.982, 3.812,  1.371,  -0.039, -3.526, -1.223, -7.128, 2.333,  5.261,  10.554, -1.865,
    7.597,  -9.155, -3.523, -0.683, -0.075, 0.204,  0.117,  -0.021, 1.295,  0.001,  -2.732,
    -2.657, -0.334, -7.762, 1.380,  -1.771, 0.150,  0.127,  -3.455, -0.648, -4.577, 5.351};

constexpr double kMostVariance = 1e6;
// The noise is read off the scans with their corners; how far partners really lie apart (mean_cost) says how much less
// it is. The kernel shrinks both. Set so that 95 % of simulated errors fall within the 95 % region.
constexpr double kInflation = 2.33;
constexpr double kLeastCost = 0.05;       // surfaces without any noise are no surer than this
constexpr double kSlideVariance = 100.0;  // [m^2] where it does: as far as such a sensor sees
constexpr double kMarginRate = 20.0;      // an alternative is less likely by e for each 0.05 of score
// The residuals show more than the noise of the ranges where beams jitter, the scan is bent by motion or things moved.
// They are less than the errors, since the pose is fitted to them; and where few hits find partners, those that fit
// least are not among them. Chosen on simulated pairs and drives of the sensors as recorded (seeds 101 to 103).
constexpr double kResidualInflation = 2.0, kFullOverlap = 0.6, kMostSelection = 4.0;
constexpr double kSlides_m = 0.05;  // less certain than this along some direction: a corridor, where the pose may slide

// Along a corridor both scans agree as well a little farther on.
bool may_slide(const SearchOutcome& outcome) {
  return outcome.profile < kFlatProfile || weakest_sigma(outcome.refined.information) > kSlides_m;
}

bool ties(const SearchOutcome& outcome) {
  return outcome.margin < 0.05;
}

// As wide as the wider of both along every direction.
Eigen::Matrix3d wider_of(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
  const Eigen::LLT<Eigen::Matrix3d> root(a);
  if (root.info() != Eigen::Success || !b.allFinite()) return a;
  const Eigen::Matrix3d L = root.matrixL();
  const Eigen::Matrix3d half = root.matrixL().solve(b);
  const Eigen::Matrix3d seen = root.matrixL().solve(half.transpose());
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(0.5 * (seen + seen.transpose()));
  const Eigen::Matrix3d axes = L * eigen.eigenvectors();
  return axes * eigen.eigenvalues().cwiseMax(1.0).asDiagonal() * axes.transpose();
}

// What the residuals show, and the turn of both revolutions: that of the reference moves the scan around it.
Eigen::Matrix3d as_seen(const SearchOutcome& outcome, const Eigen::Matrix3d& from_noise) {
  const double overlap = std::max(outcome.evidence.matched / std::max(outcome.evidence.hits, 1), 1e-3);
  const double selection = std::clamp(kFullOverlap / overlap * (kFullOverlap / overlap), 1.0, kMostSelection);
  Eigen::Matrix3d out = wider_of(from_noise, kResidualInflation * selection * outcome.residual_covariance);
  const Pose2& T = outcome.hypotheses.front().T_ref_scan;
  const Eigen::Vector3d around(-T.y, T.x, 1.0);
  out += outcome.reference_turn_variance * around * around.transpose();
  out(2, 2) += outcome.scan_turn_variance;
  return out;
}

// Where other poses tie: as wide as they lie apart.
Eigen::Matrix3d with_alternatives(const SearchOutcome& outcome, Eigen::Matrix3d covariance) {
  if (ties(outcome) && !may_slide(outcome)) {
    const Pose2& best = outcome.hypotheses.front().T_ref_scan;
    Eigen::Matrix3d apart = Eigen::Matrix3d::Zero();
    double sum = 1.0;
    for (std::size_t k = 1; k < outcome.hypotheses.size(); ++k) {
      const Pose2& other = outcome.hypotheses[k].T_ref_scan;
      const Eigen::Vector3d off(other.x - best.x, other.y - best.y, wrap_angle(other.theta - best.theta));
      const double weight = weight_beside_best(outcome, k);
      apart += weight * off * off.transpose();
      sum += weight;
    }
    covariance += apart / sum;
  }
  return covariance.selfadjointView<Eigen::Lower>();  // symmetric to the last bit
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

double weight_beside_best(const SearchOutcome& outcome, std::size_t k) {
  // Evidence decides between poses as the confidence does between right and wrong: by the margin.
  const double less = outcome.hypotheses.front().score - outcome.hypotheses[k].score;
  return std::exp(-kMarginRate * std::max(less, 0.0));
}

bool is_ambiguous(const SearchOutcome& outcome) {
  return ties(outcome) || may_slide(outcome);
}

Eigen::Matrix3d noise_covariance_of(const SearchOutcome& outcome) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(outcome.refined.information);
  Eigen::Vector3d variances = (kInflation * std::max(outcome.refined.mean_cost, kLeastCost) *
                               eigen.eigenvalues().cwiseMax(1.0 / kMostVariance).cwiseInverse())
                                  .cwiseMin(kMostVariance);
  // What then seems to hold the pose is noise of the normals.
  if (may_slide(outcome)) variances(0) = kSlideVariance;
  return with_alternatives(outcome, eigen.eigenvectors() * variances.asDiagonal() * eigen.eigenvectors().transpose());
}

Eigen::Matrix3d covariance_of(const SearchOutcome& outcome, const Eigen::Matrix3d& noise_covariance) {
  return as_seen(outcome, noise_covariance).selfadjointView<Eigen::Lower>();
}

std::vector<std::string> confidence_feature_names() {
  std::vector<std::string> names(kNames.begin(), kNames.end());
  for (const auto& [a, b] : kProductOf) names.push_back(names[a] + "*" + names[b]);
  return names;
}

ConfidenceFeatures confidence_features(const SearchOutcome& outcome) {
  ConfidenceFeatures f;
  if (outcome.hypotheses.empty()) return f;
  const auto log_of = [](double value) { return std::log(std::clamp(value, 1e-3, 1.0)) + 3.0; };
  const PoseEvidence& e = outcome.evidence;
  const double hits = std::max(e.hits, 1);
  auto& v = f.value;
  v[kConstant] = 1.0;
  v[kScore] = outcome.hypotheses.front().score;
  v[kMargin] = log_of(outcome.margin);
  v[kProfile] = log_of(outcome.profile);
  v[kSigma] = std::log10(std::clamp(weakest_sigma(outcome.refined.information), 1e-3, 1.0)) + 2.0;
  v[kPartners] = std::log(std::clamp(static_cast<double>(outcome.refined.partners), 10.0, 400.0) / 100.0);
  v[kViolation] = e.violation / hits;
  v[kMatched] = e.matched / hits;
  v[kOccluded] = e.occluded / hits;
  v[kEmpty] = e.empty / hits;
  v[kStray] = e.stray / hits;
  v[kLowScore] = std::min(v[kScore], 0.2);
  v[kSilent] = e.silent / hits;
  v[kAgreement] = std::log((e.matched + 0.5) / (e.matched + e.violation + e.stray + e.empty + e.occluded + 1.0));
  v[kSlides] = may_slide(outcome) ? 1.0 : 0.0;
  v[kTie] = ties(outcome) && !may_slide(outcome) ? 1.0 : 0.0;
  for (std::size_t k = 0; k < kProductOf.size(); ++k)
    v[ConfidenceFeatures::kSeen + k] = v[kProductOf[k].first] * v[kProductOf[k].second];
  return f;
}

double confidence_of(const ConfidenceFeatures& features) {
  double sum = 0.0;
  for (std::size_t k = 0; k < ConfidenceFeatures::kCount; ++k) sum += kCoefficients[k] * features.value[k];
  return 1.0 / (1.0 + std::exp(-std::clamp(sum, -30.0, 30.0)));
}

}  // namespace phasescan
