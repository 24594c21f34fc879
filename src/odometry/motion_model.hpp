/// What is expected of the robot's motion before a scan is matched, and what is kept of it afterwards.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "odometry/local_map.hpp"
#include "odometry/map_points.hpp"
#include "odometry/motion_prior.hpp"
#include "odometry/motion_variability.hpp"
#include "odometry/registration.hpp"
#include "odometry/scan_clock.hpp"
#include "odometry/search_policy.hpp"
#include "odometry/wheel_monitor.hpp"
#include "phasescan/core/pose2.hpp"
#include "phasescan/odometry/options.hpp"

namespace phasescan {

/// What is known of the motion up to the scan that just came.
struct MotionInput {
  ScanTiming timing;
  double seconds = 0.0;             ///< since the scan before, 0 = unknown
  std::optional<Pose2> wheel_step;  ///< by the wheels' own account
  Twist2 twist;                     ///< of the base during the scan, as far as it can be told before the match
};

struct MotionPrediction {
  Pose2 step;                        ///< of those tried the one that explains the scan best
  double score = 0.0;                ///< how well it does
  PosePrior prior;                   ///< of the pose, frame of the map
  std::optional<PosePrior> learned;  ///< what the learned motion says in its place where the scan does not show it
};

/// A step as it was matched and what is known of it.
struct MotionUpdate {
  Pose2 moved;            ///< from the last base to this one, wheels included
  Eigen::Matrix3d seen;   ///< information of the match, frame of the new base
  Eigen::Matrix3d known;  ///< the same with what was expected and the wheels
  WheelConsistency wheels = WheelConsistency::kNone;
};

/// Constant velocity, wheels, and motion learned from what was seen. Plain values.
struct MotionModel {
  WheelOdometryMonitor wheels;
  MotionPrior learned;
  MotionVariability variability;
  Pose2 step;  ///< motion per usual period, frame of the base, as last found
  Eigen::Matrix3d step_covariance = Eigen::Vector3d(0.0025, 0.0025, 0.01).asDiagonal();
  Twist2 twist;
  double usual_score = 0.5;  ///< slow mean of the score of predictions

  /// Time and wheels of the next scan.
  MotionInput begin_scan(const ScanTiming& timing, const std::optional<Pose2>& T_odom_base,
                         const OdometryOptions& options);
  /// After a gap nothing is known of the speed.
  void forget_speed();
  /// Chooses among going on as before, rest, the wheels' step and turns by how well each explains a few points, and
  /// says what the pose is expected to be.
  /// @param T_map_last  the base with the scan before
  /// @param new_laser   the scan is of a laser that was not heard before: how well a step explains it says nothing
  MotionPrediction predict(const LocalMap& map, const MapPoints& points, const Pose2& T_map_last,
                           const MotionInput& input, const SearchPolicy& policy, bool new_laser,
                           const OdometryOptions& options) const;
  /// Where stamps cannot tell whether scans are missing, a step several times as long as the ones before can: so many
  /// periods have passed.
  MotionInput with_scans_missing(MotionInput input, const Pose2& moved) const;
  /// Joins a match with what was expected and with the wheels.
  /// @param prior  that the match was found with
  MotionUpdate fuse(const Registration& found, const PosePrior& prior, const Pose2& moved, const MotionInput& input);
  /// Learns from a step that was matched.
  void correct(const MotionUpdate& update, double prediction_score, const MotionInput& input);
  /// Where no match was found: what to take for the step. Expects half as fast a motion next.
  Pose2 step_without_match(const Pose2& predicted, const MotionInput& input);
  /// The twist that the last step was made with, where time is known.
  void set_twist(const Pose2& moved, const MotionInput& input);

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("wheels", self.wheels);
    v("learned", self.learned);
    v("variability", self.variability);
    v("step", self.step);
    v("step_covariance", self.step_covariance);
    v("twist", self.twist);
    v("usual_score", self.usual_score);
  }

 private:
  bool trusts_wheel_distance() const;
  bool trusts_wheels() const;
  PosePrior prior_of(const Pose2& T_map_last, const Pose2& mean, Eigen::Matrix3d covariance, double periods,
                     const SearchPolicy& policy) const;
  void probe(const LocalMap& map, const MapPoints& points, const Pose2& T_map_last, const MotionInput& input,
             MotionPrediction& best) const;
  Pose2 fuse_wheels(const Pose2& moved, const Pose2& wheel_step, Eigen::Matrix3d& known) const;
};

/// How uncertain the pose relative to the last keyframe is, frame of the base. Plain values.
struct RelativeUncertainty {
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  /// The part of it that stays when the map moves on. A match sees relative to all keyframes of the map: of its error
  /// 2 / (n + 1) are left in the map of n keyframes in the end; an error of a step that no match saw stays whole.
  Eigen::Matrix3d drift = Eigen::Matrix3d::Zero();

  /// After another step: where the match sees, it sees relative to the map; where it does not, every step adds its own
  /// uncertainty.
  void grow(const MotionUpdate& update, std::size_t map_keyframes);
  /// After a step without a match.
  void grow_unseen();

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("covariance", self.covariance);
    v("drift", self.drift);
  }
};

}  // namespace phasescan
