/// From scan messages and transforms to measurements: scans wait until it is known where their laser and the robot
/// stood at their stamp, and leave in the order of their stamps, whatever came first.
#pragma once

#include <deque>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "phasescan/core/options.hpp"
#include "phasescan/scan/scan.hpp"
#include "ros2/diagnostics.hpp"
#include "ros2/scan_gate.hpp"
#include "ros2/transform_buffer.hpp"

namespace phasescan {
namespace ros2 {

/// Where the robot's odometry comes from.
enum class OdometrySource {
  kAuto,   ///< transforms where there are any; else none
  kTf,     ///< odom -> base in /tf; scans wait for it
  kTopic,  ///< messages of the odometry topic
  kNone,   ///< none: the node publishes odom -> base itself
};

struct IntakeOptions {
  std::string base_frame = "base_footprint";
  std::string odom_frame = "odom";
  OdometrySource odometry = OdometrySource::kAuto;
  bool mounting_from_tf = true;  ///< else each laser sits at the base, looking ahead
  double range_min_m = 0.0;      ///< nearer returns are left out
  double range_max_m = 0.0;      ///< farther ones are out of range; 0: as the sensor says
  int every = 1;                 ///< only each so-manieth scan is used
};

/// A scan ready to be added, and what its answer is composed with.
struct ReadyScan {
  RangeMeasurement measurement;
  std::string topic;
  bool new_session = false;  ///< the clock went back before it
};

/// Feed it messages in the order in which they come; take what is ready. Without threads, without a clock of its own.
class ScanIntake {
 public:
  ScanIntake(IntakeOptions options, Diagnostics& diagnostics) : options_(std::move(options)), told_(diagnostics) {}

  void add_scan(const std::string& topic, const LaserScan& message, Stamp now);
  void add_transforms(const TFMessage& message, bool is_static, Stamp now);
  void add_odometry(const Odometry& message, Stamp now);
  /// Transforms that this node publishes itself come back to it: these are not taken for odometry.
  void note_own_odometry(Stamp stamp, const Pose2& T_odom_base);

  /// The scans that are ready now, oldest first.
  std::vector<ReadyScan> take_ready(Stamp now);

  /// Scans that wait are not wanted any more.
  void drop_waiting() { queue_.clear(); }

  void set_options(IntakeOptions options) { options_ = std::move(options); }
  const IntakeOptions& options() const { return options_; }
  /// Whether odom -> base of somebody else is there.
  bool has_odometry() const { return odometry_seen_; }
  /// False while it is still open whether odometry will come (kAuto).
  bool odometry_decided() const {
    return odometry_seen_ || without_odometry_ || options_.odometry == OdometrySource::kNone;
  }
  /// Whether a scan was ever ready.
  bool took_any() const { return last_taken_.has_value(); }
  std::size_t waiting() const { return queue_.size(); }
  const TransformBuffer& transforms() const { return transforms_; }

  /// Forgets scans and transforms that are later: the clock was set back.
  void restart_at(Stamp stamp);

  /// Scans that wait at most, of each laser.
  static constexpr std::size_t kDepth = 10;
  /// Scans of a laser that wait for odometry that nobody ever saw, before it is taken for not there.
  static constexpr std::size_t kWaitForOdometry = 3;
  /// A laser whose next scan does not come for so long is not waited for [s].
  static constexpr double kWaitForLaser_s = 0.3;
  /// Odometry whose newest message is older than a scan by more is not waited for [s].
  static constexpr double kOdometryLost_s = 1.0;
  /// A laser that was quiet for so long is gone [s].
  static constexpr double kLaserGone_s = 2.0;
  /// Scan planes tilted by more are told.
  static constexpr double kMostTilt_rad = 0.1;

 private:
  struct Waiting {
    std::string topic, frame;
    Scan scan;
  };
  struct Readiness {
    bool ready = false, drop = false;
    Pose2 T_base_laser;
    bool flipped = false;
    std::optional<Pose2> T_odom_base;
  };

  bool other_lasers_are_past(const Waiting& scan) const;
  Readiness mounting_of(const Waiting& scan, Stamp now);
  Readiness readiness_of(const Waiting& scan, Stamp now);
  void odometry_of(const Waiting& scan, Readiness& out, Stamp now);
  std::size_t waiting_of(const std::string& topic) const;
  void push_out(const std::string& topic, Stamp now);
  bool is_own(const TransformStamped& transform) const;
  RangeMeasurement measure(Waiting&& scan, const Readiness& at) const;

  IntakeOptions options_;
  Diagnostics& told_;
  ScanGate gate_;
  TransformBuffer transforms_, odometry_;
  std::deque<Waiting> queue_;            // by stamp
  std::map<std::string, Stamp> newest_;  // stamp of each laser's newest scan
  std::map<std::string, int> skipped_;   // of each laser, since its last scan that was used
  std::optional<Stamp> last_taken_;
  std::deque<std::pair<Stamp, Pose2>> own_;
  bool odometry_seen_ = false, without_odometry_ = false, session_begins_ = false;
};

}  // namespace ros2

template <>
inline std::span<const std::string_view> enum_names<ros2::OdometrySource>() {
  static constexpr std::string_view kNames[] = {"auto", "tf", "topic", "none"};
  return kNames;
}

}  // namespace phasescan
