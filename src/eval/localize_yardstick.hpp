/// The exhaustive search beside the fast one: what a scan can tell at all, and how much of it is found.
#pragma once

#include <functional>
#include <vector>

#include "eval/localize_bench.hpp"

namespace phasescan {

/// What the exhaustive search says of one scan.
struct YardstickRow {
  bool mapped = true;
  bool finished = true;      ///< else it was given up, and says nothing
  bool truth_among = false;  ///< a pose within 0.1 m and 3 deg of the truth is within the gap of the best
  bool ambiguous = false;    ///< another pose, apart from the best, is within the gap
  bool best_right = false;
  double best_log_likelihood = 0.0;
  double s = 0.0;  ///< CPU
};
/// @param most_steps  as of search_everywhere  @cost seconds a scan
std::vector<YardstickRow> measure_all(const LocalizationMap& map, const std::vector<LocalizeCase>& cases,
                                      const LocalizeOptions& options, std::size_t most_steps,
                                      const std::function<void(std::size_t)>& progress);

/// Both searches on the scans that were taken on the map.
struct YardstickScore {
  std::size_t unfinished = 0;  ///< scans that the exhaustive search gave up: in none of the counts below
  std::size_t n = 0, truth_among = 0, ambiguous = 0, our_ambiguous = 0;
  /// Of the scans that the exhaustive search calls unambiguous.
  std::size_t clear = 0, clear_right = 0, clear_our_right = 0, clear_our_right_ok = 0, clear_our_wrong_ok = 0;
  std::size_t missed = 0;  ///< scans whose likeliest pose the fast search did not come within the gap of
  double s_p50 = 0.0, s_most = 0.0;
};
YardstickScore compare(const std::vector<YardstickRow>& yardstick, const std::vector<LocalizeRow>& ours, double gap);

}  // namespace phasescan
