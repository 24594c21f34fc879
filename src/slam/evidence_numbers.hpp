/// Shares, means and quantiles that the evidence of a run is made of.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

#include "slam/run_evidence.hpp"

namespace phasescan::evidence {

inline std::size_t index(std::int64_t k) {
  return static_cast<std::size_t>(k);
}

inline double share(double part, double whole) {
  return whole > 0.0 ? part / whole : 0.0;
}

inline double mean(const std::vector<double>& values) {
  return share(std::accumulate(values.begin(), values.end(), 0.0), static_cast<double>(values.size()));
}

/// The value that a share `q` of all is below; 0 of none.
inline double quantile(std::vector<double> values, double q) {
  if (values.empty()) return 0.0;
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(q * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// What a map that is right may be off by.
inline double right_m(const RunEvidence& e) {
  constexpr double kRightM = 0.2, kRightShare = 0.01;  // metres, or share of the way
  return std::max(kRightM, kRightShare * e.way_m);
}

}  // namespace phasescan::evidence
