/// Outcomes summed up into the rows of the bench tables.
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "eval/pair_outcome.hpp"
#include "eval/statistics.hpp"

namespace phasescan {

/// Stages whose time is reported, in the order of the pipeline; the first is the whole match.
inline constexpr std::array<const char*, 6> kTimedSteps{"total",    "image",       "missing",
                                                        "rotation", "translation", "refine"};
std::array<double, 6> step_ms(const MatchTimes& ms);

/// Mean and percentiles of the CPU time of one step [ms].
struct TimeRow {
  double mean, p50, p95, p99;
};

/// All outcomes of one dataset x class x method. Shares and moments of nothing are NaN.
struct BenchRow {
  std::string dataset;  ///< "all" in totals
  std::string cls;      ///< "all" in totals
  std::size_t method = 0;
  std::size_t n = 0;
  std::size_t with_truth = 0;
  std::size_t right = 0;  ///< successes
  Interval interval;      ///< of right / with_truth
  std::size_t right_usable = 0, right_refused = 0, wrong_refused = 0, wrong_usable = 0;
  std::size_t ambiguous = 0;
  Moments x_m, y_m, rotation_deg;  ///< of the absolute errors of the successes
  std::size_t with_confidence = 0;
  double auc, calibration_error;
  double nees_below;  ///< share of e^T C^-1 e below 7.81 (95 % of chi-square with 3 degrees) among usable answers with
                      ///< a truth
  double efficiency;  ///< sqrt(mean(e^T J e) / 3) over the successes that are not weak: 1 is the Cramer-Rao bound
  std::size_t weak = 0;            ///< pairs whose position cannot be known in some direction (sigma above 0.05 m)
  std::size_t weak_right = 0;      ///< of those, successes
  std::size_t weak_ambiguous = 0;  ///< of those, called ambiguous
  std::size_t weak_across = 0;     ///< of those, error across that direction below 0.1 m
  Interval known_interval;         ///< of the successes among the pairs that are not weak
  std::array<std::size_t, 6> rotation_sources{};  ///< by RotationSource
  std::size_t shortcut_right = 0;                 ///< successes whose rotation came from the missing data
  std::array<TimeRow, 6> times;

  double success() const;  ///< right / with_truth
  std::size_t known() const { return with_truth - weak; }
  std::size_t known_right() const { return right - weak_right; }
  double known_success() const;  ///< the same over the pairs that are not weak
};

/// Sums up outcomes, which may come in any order.
BenchRow sum_up(std::span<const PairOutcome* const> outcomes);

/// A row per dataset x class x method: datasets as they first come, classes small, middle, large, global, none and then
/// others as they first come, methods by index.
std::vector<BenchRow> pair_rows(const std::vector<PairOutcome>& outcomes);
/// A row per dataset x method (class "all"), per class x method (dataset "all") and, last, per method.
std::vector<BenchRow> pair_totals(const std::vector<PairOutcome>& outcomes);

/// Class names in the order of the tables.
std::vector<std::string> classes_in_order(const std::vector<PairOutcome>& outcomes);
/// Dataset names as they first come.
std::vector<std::string> datasets_in_order(const std::vector<PairOutcome>& outcomes);

}  // namespace phasescan
