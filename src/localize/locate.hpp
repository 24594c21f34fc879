/// Searches the map for one scan and says how sure the answer is.
#pragma once

#include "localize/global_search.hpp"
#include "localize/hypotheses.hpp"
#include "phasescan/localize/localizer.hpp"

namespace phasescan {

/// As search_map; where the answer does not convince, once more with more effort.
std::vector<FoundPose> search_thoroughly(const LocalizationMap::Data& map, const QueryScan& scan,
                                         const LocalizeOptions& options, GlobalSearchWorkspace& work);

/// What is known of a pose among others. @param margin  to the next pose
struct Judged {
  TrackingStatus status = TrackingStatus::kLost;
  double confidence = 0.0;
};
Judged judge_pose(const FoundPose& pose, double margin, const LocalizeOptions& options);
/// The same of a pose that is followed, by drive_confidence.
Judged judge_followed(const FoundPose& pose, Led led, double margin, const LocalizeOptions& options);

/// Fills pose, covariance, confidence, fit and hypotheses of an update, in the frame of the map.
/// @param T_base_laser  about the laser a revolution turns as a whole (revolution_turn_deg)
void report_hypotheses(const LocalizationMap::Data& map, const HypothesisSet& set, const Pose2& T_base_laser,
                       const LocalizeOptions& options, LocalizationUpdate& update);

/// @throws std::invalid_argument naming what is not finite
void check_measurement(const RangeMeasurement& measurement);

}  // namespace phasescan
