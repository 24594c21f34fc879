/// The tracker: from scans to poses and keyframes. `Odometry` and `Slam` are made of it.
///
/// A scan goes through these stages, each in a file of its own:
///  1. scan_clock, motion_model   time and wheels since the last scan; what rules apply (search_policy)
///  2. frame                      surface, points at mid-scan, those that are static
///  3. motion_model               what pose is expected
///  4. scan_to_scan, pose_solver  the pose on the local map; once more with the scan deskewed by the motion found
///  5. motion_model               fused with expectation and wheels, learned from
///  6. tracker                    zero-velocity update, keyframes, the map
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "odometry/frame.hpp"
#include "odometry/local_map.hpp"
#include "odometry/pose_solver.hpp"
#include "odometry/scan_to_scan.hpp"
#include "odometry/state.hpp"
#include "phasescan/odometry/odometry.hpp"
#include "phasescan/odometry/options.hpp"

namespace phasescan {

/// How well a scan fits what came before it.
struct ScanFit {
  bool judged = false;       ///< false: nothing before it says what to expect
  double score_share = 0.0;  ///< of the usual score that it reaches on the map
  /// How far its motion is off that of the scan before and off the wheels', the nearer of them [m], [rad].
  double off_m = 0.0, off_rad = 0.0;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("judged", self.judged);
    v("score_share", self.score_share);
    v("off_m", self.off_m);
    v("off_rad", self.off_rad);
  }
};

/// What one scan brought. Poses of the base; "mid" is the middle of the scan's turn, "stamp" its first beam.
struct TrackerStep {
  Stamp stamp = 0;
  TrackingStatus status = TrackingStatus::kInitialising;
  Pose2 T_odom_mid;                                       ///< what was matched
  Pose2 T_odom_stamp;                                     ///< the same at the scan's stamp
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();   ///< of (x, y, theta) of the pose along the axes of odom
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();  ///< of the pose relative to the last keyframe, frame of base
  Twist2 twist;                                           ///< of the base [m/s, rad/s], 0 where time is unknown
  bool keyframe = false;                                  ///< the scan became part of the local map
  TrackingDiagnostics diagnostics;
  ScanFit fit;
  /// Final, in order. The keyframe of the first scan comes with the second one, others with their own scan.
  std::vector<TrackedKeyframe> keyframes;

  bool tracked() const { return is_tracked(status); }

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("stamp", self.stamp);
    v("status", self.status);
    v("T_odom_mid", self.T_odom_mid);
    v("T_odom_stamp", self.T_odom_stamp);
    v("covariance", self.covariance);
    v("information", self.information);
    v("twist", self.twist);
    v("keyframe", self.keyframe);
    v("overlap", self.diagnostics.overlap);
    v("residual_m", self.diagnostics.residual_m);
    v("wide_search", self.diagnostics.wide_search);
    v("full_search", self.diagnostics.full_search);
    v("new_segment", self.diagnostics.new_segment);
    v("wheels", self.diagnostics.wheels);
    v("fit", self.fit);
    v("keyframes", self.keyframes);
  }
};

/// Deterministic; bounded work and memory per scan. The state is all it knows: a tracker made from a copy goes on with
/// the same bytes.
class Tracker {
 public:
  /// @throws std::invalid_argument naming the option out of bounds.
  /// @param match  of the matches with the last scan
  explicit Tracker(const OdometryOptions& options = {}, OdometryState state = {}, const MatchOptions& match = {});

  /// The next scan, of any laser of the robot.
  TrackerStep add(const RangeMeasurement& measurement);
  /// Goes on from another state, as if it had been made of it.
  void restore(OdometryState state);
  /// The keyframe of a log of one scan, where no second came.
  std::vector<TrackedKeyframe> finish();

  const OdometryState& state() const { return state_; }
  const LocalMap& map() const { return map_; }

 private:
  /// One scan and what was told of it before the match.
  struct Scanned {
    const RangeMeasurement& measurement;
    MotionInput motion;
    SearchPolicy policy;
    Frame frame;
    bool new_laser = false;  ///< heard for the first time
    MotionPrediction expected;
  };
  /// Its pose on the map.
  struct Solution {
    PoseSolution pose;
    bool first_deskewed = false;  ///< the first keyframe was changed by what was found
  };
  Scanned begin(const RangeMeasurement& measurement);
  Frame frame_of(const RangeMeasurement& measurement, const Twist2& twist, double duration_s,
                 const SearchPolicy& policy);
  void start(const Scanned& scanned, TrackerStep& step);
  void expect(Scanned& scanned);
  Solution solve(Scanned& scanned);
  std::optional<LastScanMatch> match_last_scan(const Scanned& scanned);
  void solve_deskewed(Scanned& scanned, Solution& solution);
  void test_deskewing(const Scanned& scanned, double turn_rad, const Solution& solution);
  bool deskews() const { return options_.deskew && !state_.deskew_test.refuted(); }
  void deskew_first(const Twist2& twist, const SearchPolicy& policy);
  bool is_matched(const Scanned& scanned, const PoseSolution& pose);
  void judge_fit(const Scanned& scanned, double score_share, const Pose2& step_before, const Pose2& moved,
                 TrackerStep& step) const;
  Pose2 correct(const Scanned& scanned, const PoseSolution& pose, TrackerStep& step);
  Pose2 coast(const Scanned& scanned, TrackerStep& step);
  void move(const Scanned& scanned, const Pose2& moved, TrackerStep& step);
  void remember(const Scanned& scanned, TrackerStep& step);
  bool wants_keyframe(const Scanned& scanned, const TrackerStep& step) const;
  void insert_keyframe(const Scanned& scanned, TrackerStep& step);
  void emit_first(bool deskewed, TrackerStep& step);
  void rebuild_map();
  Pose2 T_map_last() const { return map_.T_world_map().inverse() * state_.T_odom_mid; }

  OdometryOptions options_;
  OdometryState state_;
  // What follows is made from the state, or buffers.
  LocalMap map_;
  ScanToScan scan_to_scan_;
  FrameWorkspace work_;
};

}  // namespace phasescan
