/// Localisation measured: what becomes of scans whose poses on a map are known.
#pragma once

#include <functional>
#include <vector>

#include "eval/localize_places.hpp"
#include "eval/statistics.hpp"
#include "phasescan/localize/localizer.hpp"

namespace phasescan {

/// Within 0.1 m and 3 deg.
bool is_right(const Pose2& pose, const Pose2& truth);

/// One case answered.
struct LocalizeRow {
  LocalizationUpdate update;
  double error_m = 0.0, error_rad = 0.0;
  double ms = 0.0;
  bool mapped = true;
  bool named = false;  ///< the truth is among the hypotheses
  bool right() const;  ///< within 0.1 m and 3 deg
};
std::vector<LocalizeRow> answer_all(const LocalizationMap& map, const std::vector<LocalizeCase>& cases,
                                    const LocalizeOptions& options, const std::function<void(std::size_t)>& progress);

/// What came of them.
struct LocalizeScore {
  std::size_t n = 0, right = 0, within_half_m = 0, ok = 0, right_ok = 0, wrong_ok = 0, ambiguous = 0,
              ambiguous_named = 0, degraded = 0, wrong_degraded = 0, lost = 0;
  std::size_t unmapped = 0;  ///< scans of rooms that the map has not
  double median_m = 0.0, median_deg = 0.0, ms_p50 = 0.0, ms_p99 = 0.0;
  double calibration_error = 0.0;
  std::vector<ReliabilityBin> reliability;  ///< of the confidence where a scan was not ambiguous
};
LocalizeScore score_of(const std::vector<LocalizeRow>& rows);

}  // namespace phasescan
