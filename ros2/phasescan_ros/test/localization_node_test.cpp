// LocalizationNode as it is run: a process of its own, a map server, and a robot that drives.
#include <gtest/gtest.h>

#include <geometry_msgs/msg/pose_with_covariance_stamped.hpp>
#include <nav_msgs/msg/occupancy_grid.hpp>
#include <std_msgs/msg/string.hpp>
#include <std_srvs/srv/empty.hpp>

#ifdef PHASESCAN_HAS_NAV2_MSGS
#include <nav2_msgs/msg/particle_cloud.hpp>
#include <nav2_msgs/srv/set_initial_pose.hpp>
#endif

#include "map_of_rooms.hpp"
#include "node_process.hpp"
#include "restart.hpp"
#include "robot.hpp"
#include "support/temp.hpp"

namespace phasescan_ros::test::localization_node_test {
namespace {

using geometry_msgs::msg::PoseWithCovarianceStamped;
using nav_msgs::msg::OccupancyGrid;

class LocalizationNodeRun : public ::testing::Test {
 protected:
  void start(const std::map<std::string, std::string>& parameters = {}) {
    process = std::make_unique<NodeProcess>(PHASESCAN_LOCALIZATION_NODE, "amcl", parameters);
    ASSERT_TRUE(tester.bring_up());
  }
  /// As map_server does.
  void serve_map() {
    maps = std::make_unique<Voice<OccupancyGrid>>(tester.node(), "map", latched());
    maps->publish(map_of_rooms());
    EXPECT_TRUE(tester.wait([&] { return maps->hearers() > 0; }));
    tester.pass(0.5);
  }
  void drive(Robot& robot, std::size_t from, std::size_t to, double late_s = 0.0) {
    robot.drive(from, to, answered_by(poses), late_s);
    EXPECT_TRUE(process->alive());
  }
  Pose2 last_pose() const {
    const auto& pose = poses->messages.back().pose.pose;
    return pose_of(pose.position, pose.orientation);
  }
  /// map -> odom of the last message that had it.
  const geometry_msgs::msg::TransformStamped* last_transform() const {
    for (auto message = tf->messages.rbegin(); message != tf->messages.rend(); ++message) {
      if (message->transforms.at(0).child_frame_id == "odom") return &message->transforms[0];
    }
    return nullptr;
  }
  void say_initial_pose(const Pose2& pose) {
    Voice<PoseWithCovarianceStamped> publisher(tester.node(), "initialpose", 10);
    ASSERT_TRUE(tester.wait([&] { return publisher.hearers() > 0; }));
    PoseWithCovarianceStamped message;
    message.header.frame_id = "map";
    message.pose.pose.position.x = pose.x;
    message.pose.pose.position.y = pose.y;
    message.pose.pose.orientation.z = std::sin(0.5 * pose.theta);
    message.pose.pose.orientation.w = std::cos(0.5 * pose.theta);
    message.pose.covariance[0] = message.pose.covariance[7] = 0.25;
    message.pose.covariance[35] = 0.07;
    publisher.publish(message);
    tester.pass(0.3);
  }

  Tester tester{"amcl"};
  std::shared_ptr<Heard<PoseWithCovarianceStamped>> poses =
      tester.listen<PoseWithCovarianceStamped>("amcl_pose", latched());
  std::shared_ptr<Heard<TFMessage>> tf = tester.listen<TFMessage>("/tf", 1000);
  std::shared_ptr<Heard<std_msgs::msg::String>> states = tester.listen<std_msgs::msg::String>("status", latched());
  std::unique_ptr<Voice<OccupancyGrid>> maps;
  std::unique_ptr<NodeProcess> process;
};

// nav2's own check of a localiser: an initial pose, then a pose within 0.25 m.
TEST_F(LocalizationNodeRun, AnInitialPoseThenAPoseWithinAQuarterOfAMetre) {
  start();
  serve_map();
  Robot robot(tester, true);
  robot.stand_up();
  say_initial_pose({0.3, -0.2, 0.15});
  drive(robot, 0, 5);
  ASSERT_FALSE(poses->messages.empty());
  EXPECT_LT(translation_distance(last_pose(), robot.pose(4)), 0.25);
  EXPECT_EQ(process->stop(), 0);
}

TEST_F(LocalizationNodeRun, NoInitialPoseATransformWithEveryScan) {
  start();
  serve_map();
  Robot robot(tester, true);
  robot.stand_up();
  drive(robot, 0, 60);
  ASSERT_FALSE(poses->messages.empty());
  EXPECT_LT(translation_distance(last_pose(), robot.pose(59)), 0.15);
  ASSERT_FALSE(states->messages.empty());
  EXPECT_EQ(states->messages.back().data, "ok");
  const auto is_of_last_scan = [&] {  // scan + transform_tolerance
    return last_transform() != nullptr && to_stamp(last_transform()->header.stamp) == Robot::stamp(5.9 + 1.0);
  };
  ASSERT_TRUE(tester.wait(is_of_last_scan, 2.0));
  const auto* transform = last_transform();
  EXPECT_EQ(transform->header.frame_id, "map");
  const Pose2 base = pose_of(transform->transform.translation, transform->transform.rotation) * robot.wheel_pose(59);
  EXPECT_LT(translation_distance(base, robot.pose(59)), 0.15);
  // A robot that stands still gets its transform all the same.
  const std::size_t before = tf->messages.size();
  for (int i = 0; i < 10; ++i) {
    robot.publish(tf_message(Robot::stamp(6.0 + 0.1 * i), "odom", "base_footprint", robot.wheel_pose(59)));
    robot.publish(robot.scan(59, Robot::stamp(6.0 + 0.1 * i)));
    tester.pass(0.1);
  }
  EXPECT_GE(tf->messages.size(), before + 18);  // ours of the wheels, and the node's
}

TEST_F(LocalizationNodeRun, ServicesOfAmcl) {
  start();
  serve_map();
  Robot robot(tester, true);
  robot.stand_up();
  drive(robot, 0, 40);
  EXPECT_TRUE(tester.call<std_srvs::srv::Empty>("request_nomotion_update"));
  poses->messages.clear();
  EXPECT_TRUE(tester.call<std_srvs::srv::Empty>("reinitialize_global_localization"));
  drive(robot, 40, 80);
  ASSERT_FALSE(poses->messages.empty());
  EXPECT_LT(translation_distance(last_pose(), robot.pose(79)), 0.15);
  EXPECT_EQ(tester.set(rclcpp::Parameter("transform_tolerance", 0.5)), "");
  EXPECT_NE(tester.set(rclcpp::Parameter("scan_topic", "x")).find("scan_topic"), std::string::npos);
}

#ifdef PHASESCAN_HAS_NAV2_MSGS
TEST_F(LocalizationNodeRun, InitialPoseByServiceAndACloudOfHypotheses) {
  auto clouds = tester.listen<nav2_msgs::msg::ParticleCloud>("particle_cloud", rclcpp::SensorDataQoS());
  start();
  serve_map();
  Robot robot(tester, true);
  robot.stand_up();
  nav2_msgs::srv::SetInitialPose::Request request;
  request.pose.header.frame_id = "map";
  request.pose.pose.pose.position.x = 0.3;
  request.pose.pose.pose.orientation.w = 1.0;
  request.pose.pose.covariance[0] = request.pose.pose.covariance[7] = 0.25;
  request.pose.pose.covariance[35] = 0.07;
  EXPECT_TRUE(tester.call<nav2_msgs::srv::SetInitialPose>("set_initial_pose", request));
  drive(robot, 0, 5);
  ASSERT_FALSE(poses->messages.empty());
  EXPECT_LT(translation_distance(last_pose(), robot.pose(4)), 0.25);
  EXPECT_TRUE(tester.wait([&] { return !clouds->messages.empty() && !clouds->messages.back().particles.empty(); }));
}
#endif

TEST_F(LocalizationNodeRun, KilledAndStartedAgainItGoesOn) {
  const phasescan::test::TempFolder folder;
  const std::map<std::string, std::string> parameters = {{"saved_pose_filepath", folder / "pose"}};
  start(parameters);
  serve_map();
  Robot robot(tester, true);
  robot.stand_up();
  drive(robot, 0, 60);
  kill_and_start_again(tester, robot, 62, *poses, process, [&] { start(parameters); });
}

}  // namespace
}  // namespace phasescan_ros::test::localization_node_test
