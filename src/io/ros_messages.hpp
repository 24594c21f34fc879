/// The ROS messages that make a laser log, in both wire forms: ROS 1 (packed) and CDR (aligned, ROS 2).
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "io/bytes.hpp"
#include "phasescan/core/pose2.hpp"
#include "phasescan/core/time.hpp"
#include "phasescan/scan/scan.hpp"

namespace phasescan::ros {

enum class Wire {
  kRos1,
  kCdr,
  kJson,      ///< foxglove.LaserScan only
  kProtobuf,  ///< foxglove.LaserScan only
  kUnknown,   ///< nothing that is read
};

struct Header {
  Stamp stamp = 0;
  std::string frame_id;
};

/// sensor_msgs/LaserScan as it is on the wire.
struct LaserScan {
  Header header;
  float angle_min = 0, angle_max = 0, angle_increment = 0;
  float time_increment = 0, scan_time = 0;
  float range_min = 0, range_max = 0;
  std::vector<float> ranges;
  std::vector<float> intensities;
};

/// Rigid motion in space, T_parent_child. The quaternion is normalised on reading; all zeros are read as no rotation.
struct Pose3 {
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
};

/// nav_msgs/Odometry, the pose only: T_frame_child.
struct Odometry {
  Header header;
  std::string child_frame_id;
  Pose3 pose;
};

/// geometry_msgs/TransformStamped: T_frame_child.
struct Transform {
  Header header;
  std::string child_frame_id;
  Pose3 pose;
};

/// geometry_msgs/PoseWithCovarianceStamped of what moves in a plane.
struct PoseEstimate {
  Header header;
  Pose2 pose;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< of (x, y, theta) in the header's frame
};
/// Where x, y and theta stand among (x, y, z, roll, pitch, yaw), of which the message has a covariance.
inline constexpr int kPlanar[] = {0, 1, 5};

/// @name Decoders. `out` keeps its buffers between calls.
/// @throws DecodeError where the bytes do not hold the message they should, or a pose is not finite.
/// @{
void decode(Wire wire, Bytes data, LaserScan& out);
/// sensor_msgs/MultiEchoLaserScan: the first echo of each beam, the nearest.
void decode_multi_echo(Wire wire, Bytes data, LaserScan& out);
void decode(Wire wire, Bytes data, Odometry& out);
void decode(Wire wire, Bytes data, std::vector<Transform>& out);
/// Height, roll and pitch are left out.
void decode(Wire wire, Bytes data, PoseEstimate& out);
/// @}

/// What a message's numbers are in.
struct ScanUnits {
  double angle = 1.0;  ///< times the angles = radians
  double range = 1.0;  ///< times the ranges = metres
  bool increment_from_ends = false;
};

/// A library scan of a message. Limits that are nonsense are unknown; an increment that is nonsense is taken from
/// angle_max; a time_increment under which one turn would take over two seconds, or that is negative, is unknown (0);
/// an intensity that is not finite is 0.
/// @throws DecodeError where the beams have no direction.
Scan to_scan(const LaserScan& message, const ScanUnits& units = {});

/// The message that says what a scan says (beams at even angles). `scan_time` [s], 0 = unknown.
/// @throws std::invalid_argument for a scan whose per-beam angles are not even.
LaserScan from_scan(const Scan& scan, const std::string& frame_id, double scan_time);

}  // namespace phasescan::ros
