/// A robot in a world of two rooms, by the messages of its drivers.
#pragma once

#include <geometry_msgs/msg/transform_stamped.hpp>
#include <sensor_msgs/msg/laser_scan.hpp>
#include <string>
#include <tf2_msgs/msg/tf_message.hpp>
#include <vector>

#include "core/random.hpp"
#include "support/toy_world.hpp"
#include "tester.hpp"

namespace phasescan_ros::test {

using phasescan::Pose2;
using sensor_msgs::msg::LaserScan;
using tf2_msgs::msg::TFMessage;

inline builtin_interfaces::msg::Time to_time(phasescan::Stamp stamp) {
  return rclcpp::Time(stamp);
}
inline phasescan::Stamp to_stamp(const builtin_interfaces::msg::Time& time) {
  return rclcpp::Time(time).nanoseconds();
}

inline TFMessage tf_message(phasescan::Stamp stamp, const std::string& parent, const std::string& child,
                            const Pose2& pose) {
  geometry_msgs::msg::TransformStamped out;
  out.header.stamp = to_time(stamp);
  out.header.frame_id = parent;
  out.child_frame_id = child;
  out.transform.translation.x = pose.x;
  out.transform.translation.y = pose.y;
  out.transform.rotation.z = std::sin(0.5 * pose.theta);
  out.transform.rotation.w = std::cos(0.5 * pose.theta);
  TFMessage message;
  message.transforms.push_back(out);
  return message;
}
template <class M>
Pose2 pose_of(const M& position, const geometry_msgs::msg::Quaternion& q) {
  return {position.x, position.y, 2.0 * std::atan2(q.z, q.w)};
}

class Robot {
 public:
  /// Beam by beam as a driver tells it, 10 scans a second by their stamps.
  /// @param wheels  publishes odom -> base_footprint, with wheels that drift
  Robot(Tester& tester, bool wheels, int beams = 360)
      : tester_(tester),
        wheels_(wheels),
        beams_(beams),
        scans_(tester.node(), "scan", rclcpp::SensorDataQoS()),
        tf_(tester.node(), "/tf", rclcpp::QoS(100)),
        tf_static_(tester.node(), "/tf_static", latched()) {}

  /// The mounting of the laser, and nothing moves before the node hears it.
  void stand_up() {
    tf_static_.publish(tf_message(0, "base_footprint", "laser", T_base_laser));
    EXPECT_TRUE(tester_.wait([&] { return scans_.hearers() > 0 && tf_.hearers() > 0 && tf_static_.hearers() > 0; }));
    tester_.pass(0.5);  // that the other side has met us too
  }
  Pose2 pose(std::size_t i) const { return tour_[i % tour_.size()]; }
  /// Where it was at a stamp of the first drive.
  Pose2 pose_at(phasescan::Stamp when) const {
    return pose(static_cast<std::size_t>(std::llround(static_cast<double>(when - stamp(0.0)) * 1e-8)));
  }
  /// Wheels that count 3 % too much, from a start of their own.
  Pose2 wheel_pose(std::size_t i) const { return Pose2{5, 5, 1} * Pose2{1.03 * pose(i).x, pose(i).y, pose(i).theta}; }
  static phasescan::Stamp stamp(double seconds) {
    return 1'700'000'000'000'000'000 + static_cast<phasescan::Stamp>(std::llround(seconds * 1e9));
  }
  LaserScan scan(std::size_t i, phasescan::Stamp stamp) {
    phasescan::testing::ToyLidar lidar;
    lidar.beams = beams_;
    const phasescan::Scan seen =
        phasescan::testing::toy_scan(phasescan::testing::two_rooms(), pose(i) * T_base_laser, lidar, random_, stamp);
    LaserScan out;
    out.header.stamp = to_time(stamp);
    out.header.frame_id = "laser";
    out.angle_min = static_cast<float>(-0.5 * lidar.field);
    out.angle_increment = static_cast<float>(lidar.field / lidar.beams);
    out.angle_max = out.angle_min + out.angle_increment * static_cast<float>(lidar.beams - 1);
    out.range_max = static_cast<float>(lidar.range_max);
    for (std::size_t k = 0; k < seen.size(); ++k)
      out.ranges.push_back(seen.is_hit(k) ? static_cast<float>(seen.ranges[k])
                                          : std::numeric_limits<float>::infinity());
    return out;
  }
  void publish(const LaserScan& scan) { scans_.publish(scan); }
  void publish(const TFMessage& message) { tf_.publish(message); }

  /// Place `i` of the tour at a time of its own: what wheels and laser say.
  void step(std::size_t i, phasescan::Stamp stamp) {
    if (wheels_) publish(tf_message(stamp, "odom", "base_footprint", wheel_pose(i)));
    publish(scan(i, stamp));
  }
  /// Scans [from, to) of the tour, each as soon as the one before was answered, `late_s` after the times of the tour.
  /// @param answered  whether a scan of this stamp was
  /// @returns how many were not answered within half a second
  template <class Answered>
  int drive(std::size_t from, std::size_t to, Answered answered, double late_s = 0.0) {
    int unanswered = 0;
    for (std::size_t i = from; i < to; ++i) {
      const phasescan::Stamp now = stamp(0.1 * static_cast<double>(i) + late_s);
      step(i, now);
      if (!tester_.wait([&] { return answered(now); }, 0.5)) ++unanswered;
    }
    return unanswered;
  }

  static constexpr Pose2 T_base_laser{0.1, 0.0, 0.0};

 private:
  Tester& tester_;
  bool wheels_;
  int beams_;
  Voice<LaserScan> scans_;
  Voice<TFMessage> tf_, tf_static_;
  std::vector<Pose2> tour_ = phasescan::testing::toy_tour(0.1, 0.5, 0.8);
  phasescan::Random random_{11};
};

/// Where `topic` has a message of this stamp or a later one.
template <class M>
auto answered_by(const std::shared_ptr<Heard<M>>& heard) {
  return [heard](phasescan::Stamp stamp) {
    return !heard->messages.empty() && to_stamp(heard->messages.back().header.stamp) >= stamp;
  };
}

}  // namespace phasescan_ros::test
