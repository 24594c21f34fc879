/// Laser odometry: every scan is matched against a local map of the last keyframes.
#pragma once

#include <cstddef>
#include <deque>
#include <memory>
#include <optional>

#include "phasescan/core/pose2.hpp"
#include "phasescan/core/time.hpp"
#include "odometry/local_map.hpp"
#include "odometry/map_points.hpp"
#include "odometry/motion_habits.hpp"
#include "phasescan/odometry/options.hpp"
#include "odometry/registration.hpp"
#include "odometry/scan_clock.hpp"
#include "odometry/scan_to_scan.hpp"
#include "odometry/steadiness.hpp"
#include "odometry/wheel_witness.hpp"
#include "phasescan/scan/range_measurement.hpp"
#include "scan/surface.hpp"

namespace phasescan {

/// What one scan brought. Poses of the base; "mid" is the middle of the scan's turn, "stamp" its first beam.
struct OdometryStep {
  Pose2 T_odom_mid;      ///< what was matched
  Pose2 T_odom_stamp;    ///< the same at the scan's stamp
  Twist2 twist;          ///< of the base [m/s, rad/s], 0 where time is unknown
  bool tracked = false;  ///< false: no match was found, the pose is a prediction
  bool is_keyframe = false;
  bool searched = false;     ///< the wide search was needed
  bool caught = false;       ///< it was the full search (fft-mh) against the last good scan that found the pose
  bool new_segment = false;  ///< the local map was begun anew: nothing ties this pose to those before but a prediction
  double overlap = 0.0;      ///< share of hits on the local map's surfaces
  double residual_m = 0.0;
  Eigen::Matrix3d information =
      Eigen::Matrix3d::Zero();  ///< of the pose relative to the last keyframe, frame of the base
  WheelVerdict wheels = WheelVerdict::kNone;
  /// With the second scan the motion during the first is known: its keyframe stands here, and its points were unbent.
  std::optional<Pose2> T_odom_first;
};

/// Tracks a robot through its scans. Deterministic; bounded work and memory per scan.
class Odometry {
 public:
  /// @throws std::invalid_argument naming the option out of bounds.
  explicit Odometry(const OdometryOptions& options = {});

  /// The next scan, of any laser of the robot.
  OdometryStep add(const RangeMeasurement& measurement);

  /// The last scan's surface in the frame of the base at mid-scan, without small things of which it is not known that
  /// they stay; shared, so that keyframes cost no copy.
  std::shared_ptr<const MapPoints> last_points() const { return points_; }
  const WheelWitness& wheels() const { return wheels_; }
  const ScanClock& clock() const { return clock_; }

 private:
  static constexpr double kSlow = 0.95;       // weight of the past in what is usual
  static constexpr double kLeastTrust = 0.6;  // wheels that agreed less often lately are not heard
  struct WindowFrame {
    std::shared_ptr<const MapPoints> points;
    Pose2 T_odom_base;
  };
  void extract(const Scan& scan, const Pose2& T_base_laser, const Twist2& twist, double duration_s);
  Pose2 predict(const std::optional<Pose2>& wheel_step, double periods, double* score) const;
  PosePrior make_prior(const Pose2& mean, Eigen::Matrix3d step_covariance, double periods) const;
  /// Where the match says little along one direction, the pose there is the one that all hits fit best.
  void slide_unseen(const PosePrior& prior, Registration& found) const;
  /// Along a bare corridor the match says nothing of the motion; if the habits do, it is done again with what they say.
  void assume_habit(double turn, double periods, PosePrior& prior, Registration& found) const;
  bool hears_wheels() const { return wheels_.trust_distance() >= kLeastTrust && wheels_.trust_turn() >= kLeastTrust; }
  Pose2 hear_wheels(const Pose2& moved, const Pose2& wheel_step, Eigen::Matrix3d& known) const;
  Eigen::Matrix3d grow_information(const Eigen::Matrix3d& matched, const Eigen::Matrix3d& known, const Pose2& moved);
  /// The scan as it is matched against the last one: without the small things that may be people.
  RangeMeasurement without_people(const RangeMeasurement& measurement) const;
  /// A match in the frame of the map, where the scan's points are expressed.
  struct LastScanWitness {
    Pose2 T_map_mid;
    Eigen::Matrix3d covariance;
    bool usable = false, certain = false;
  };
  std::optional<LastScanWitness> ask_last_scan(const RangeMeasurement& measurement, const Twist2& twist,
                                               const Pose2& T_stamp_mid);
  /// What is expected, with what a match against the last scan says.
  PosePrior hear_last_scan(const PosePrior& prior, const LastScanWitness& last) const;
  Registration match(const std::optional<LastScanWitness>& last, const Pose2& guess, double periods, PosePrior& prior,
                     OdometryStep& step);
  void look_around(const PosePrior& prior, Registration& found, double& score) const;
  void catch_fall(const std::optional<LastScanWitness>& last, PosePrior& prior, Registration& found, double& score,
                  OdometryStep& step) const;
  /// Leaves out the small things that may be people: those that the map does not hold where they are expected.
  void choose_points();
  void insert_keyframe(OdometryStep& step);
  void rebuild_map();
  void unbend_first(const Twist2& twist, OdometryStep& step);
  void hold_still(OdometryStep& step);

  OdometryOptions options_;
  WheelWitness wheels_;
  MotionHabits habits_;
  bool ask_habits_ = false;  // the wheels cannot be asked
  ScanClock clock_;
  ScanToScan last_scan_;
  SurfaceWorkspace surface_work_;
  SurfacePoints surface_;
  std::shared_ptr<MapPoints> all_points_;
  std::shared_ptr<MapPoints> points_;  // those that the pose is found by
  std::vector<std::size_t> chosen_;    // which these are
  std::vector<int> beams_;             // of all points
  std::vector<int> left_out_;          // beams of the others
  LocalMap map_;
  std::deque<WindowFrame> window_;
  bool started_ = false;
  struct First {
    RangeMeasurement measurement;
    double duration_s = 0.0;
    std::shared_ptr<MapPoints> all_points, points;
  };
  std::optional<First> first_;  // until the second scan has come
  Pose2 T_odom_mid_;            // of the last scan
  Steadiness steadiness_;
  Pose2 step_;  // motion per period, base frame, as last found
  Eigen::Matrix3d step_covariance_ = Eigen::Vector3d(0.0025, 0.0025, 0.01).asDiagonal();
  Eigen::Matrix3d since_keyframe_ = Eigen::Matrix3d::Zero();  // covariance of the pose relative to the last keyframe
  Twist2 twist_;
  double usual_score_ = 0.5;  // slow mean of the prediction's score
  double usual_final_ = 0.5;  // the same of the finished match
  int untracked_ = 0;
  Pose2 still_sum_;  // standstill: sum of poses relative to the first
  Pose2 still_first_;
  int still_count_ = 0;
};

}  // namespace phasescan
