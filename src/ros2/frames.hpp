/// map -> odom of what scans say about map -> base, and odom -> base where nobody else publishes it.
#pragma once

#include <optional>
#include <string>

#include "phasescan/core/pose2.hpp"
#include "ros2/convert.hpp"

namespace phasescan::ros2 {

struct FrameNames {
  std::string map, odom, base;
};

/// T_map_odom as the last scan gave it. It stays as it is while scans bring no pose: what hangs on it moves on with
/// odometry.
class MapToOdom {
 public:
  explicit MapToOdom(FrameNames names) : names_(std::move(names)) {}

  /// A scan came. @param T_map_base, T_odom_base  at its stamp, where known; both are needed for a new T_map_odom
  void add_scan(Stamp stamp, const std::optional<Pose2>& T_map_base, const std::optional<Pose2>& T_odom_base) {
    stamp_ = stamp;
    if (T_map_base && T_odom_base) T_map_odom_ = *T_map_base * T_odom_base->inverse();
  }
  /// To publish: stamped `ahead_s` after the last scan. Nothing before the first pose.
  std::optional<TransformStamped> transform(double ahead_s) const {
    if (!T_map_odom_) return std::nullopt;
    return to_transform(stamp_ + stamp_from_seconds(ahead_s), names_.map, names_.odom, *T_map_odom_);
  }
  TransformStamped odom_to_base(Stamp stamp, const Pose2& T_odom_base) const {
    return to_transform(stamp, names_.odom, names_.base, T_odom_base);
  }
  const std::optional<Pose2>& T_map_odom() const { return T_map_odom_; }
  /// The clock went back, or the map is another: what was published before is void.
  void forget() { T_map_odom_.reset(); }

 private:
  FrameNames names_;
  Stamp stamp_ = 0;
  std::optional<Pose2> T_map_odom_;
};

}  // namespace phasescan::ros2
