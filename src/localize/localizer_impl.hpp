/// How a Localizer works: what it keeps, and its steps from one scan to the next.
#pragma once

#include <optional>
#include <vector>

#include "localize/locate.hpp"
#include "localize/map_data.hpp"
#include "localize/past_views.hpp"
#include "phasescan/localize/localizer.hpp"

namespace phasescan {

inline constexpr double kKeepGap = 18.0;         ///< hypotheses this far behind are dropped
inline constexpr double kLeastExplained = 0.35;  ///< share of the hits: less is no answer
inline constexpr int kSearchEveryScans = 5;      ///< while lost

/// Odometry does not say how the robot came here.
inline bool broke(const OdometryUpdate& odometry) {
  return odometry.status == TrackingStatus::kLost || odometry.diagnostics.new_segment;
}

/// What is known of the robot from scan to scan.
struct LocalizerState {
  HypothesisSet set;
  PastViews past;
  std::optional<PoseEstimate> given;  ///< by initialize, for the next scan
  Pose2 T_odom_last, T_odom_view;
  double way_since_search = 0.0;
  double last_explained = 0.0;  ///< by what is followed
  Stamp poor_since = 0;
  int poor_scans = 0;
  int scans_since_search = 0;
  bool located = false;
  ScanId scans = 0;
};

struct Localizer::Impl {
  LocalizationMap map;
  LocalizeOptions options;
  OdometryOptions odometry_options;
  Odometry odometry;
  LocalizerState state;
  QueryWorkspace query_work;
  GlobalSearchWorkspace search_work;

  LocalizationUpdate add(const RangeMeasurement& measurement);
  void take_given(const QueryScan& query, const Pose2& T_odom_base);
  void track(const QueryScan& query, const OdometryUpdate& odometry_update, bool new_view);
  void notice_carrying(const Pose2& T_odom_base);
  double explained_share(const Pose2& T_odom_base) const;
  bool explains_past(FoundPose& pose, const Pose2& T_odom_base) const;
  std::vector<FoundPose> find(const QueryScan& query, const Pose2& T_odom_base);
  bool fits_poorly(const OdometryUpdate& odometry_update) const;
  bool wants_search(bool poor, TrackingStatus status) const;
  void search(const QueryScan& query, const Pose2& T_odom_base, bool poor);
  bool explains_enough(const Pose2& T_odom_base) const;
  bool is_followed(const Pose2& T_odom_base) const;
  Judged judge_best(const Pose2& T_odom_base) const;
  void judge(bool poor, const RangeMeasurement& measurement, LocalizationUpdate& update);
  std::size_t most() const { return static_cast<std::size_t>(options.max_hypotheses); }
};

}  // namespace phasescan
