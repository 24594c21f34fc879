#include "phasescan/match/confidence.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace phasescan {
namespace {

constexpr std::array<double, ConfidenceFeatures::kCount> kCoefficients{-1.0, 6.0, 1.0, 1.2, -1.0, 0.0, 0.0, 0.0};

}  // namespace

ConfidenceFeatures confidence_features(const PreparedScan& reference, const PreparedScan& scan, const SearchOutcome& outcome) {
  ConfidenceFeatures f;
  if (outcome.hypotheses.empty()) return f;
  const auto log_of = [](double value) { return std::log(std::clamp(value, 1e-3, 1.0)) + 3.0; };
  const Eigen::Matrix2d information = outcome.refined.information.topLeftCorner<2, 2>();
  const double trace = information.trace(), det = information.determinant();
  const double weak = 0.5 * (trace - std::sqrt(std::max(trace * trace - 4.0 * det, 0.0)));
  const double strong = std::max(trace - weak, 1e-9);
  const Evidence& e = outcome.evidence;
  const double hits = std::max(e.hits, 1);
  f.value[0] = 1.0;
  f.value[1] = outcome.hypotheses.front().score;
  f.value[2] = log_of(outcome.margin);
  f.value[3] = log_of(outcome.profile);
  f.value[4] = std::log10(std::clamp(1.0 / std::sqrt(std::max(weak, 1e-6)), 1e-3, 1.0)) + 2.0;
  f.value[5] = std::log10(std::clamp(weak / strong, 1e-4, 1.0));
  f.value[6] = (e.violation + e.empty) / hits;
  f.value[7] = e.matched / hits;
  static_cast<void>(reference);
  static_cast<void>(scan);
  return f;
}

double confidence_of(const ConfidenceFeatures& features) {
  double sum = 0.0;
  for (std::size_t k = 0; k < ConfidenceFeatures::kCount; ++k) sum += kCoefficients[k] * features.value[k];
  return 1.0 / (1.0 + std::exp(-std::clamp(sum, -30.0, 30.0)));
}

}  // namespace phasescan
