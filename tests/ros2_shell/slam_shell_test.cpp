// The package's SLAM node, built against stand-ins for rclcpp: that it has the form that rclcpp asks for, and hands
// things on. What a real rclcpp makes of it is tested by the package's launch tests, where there is one.
#include <gtest/gtest.h>

#include <nav_msgs/srv/get_map.hpp>
#include <phasescan_ros/srv/load_state.hpp>
#include <phasescan_ros/srv/pause.hpp>
#include <phasescan_ros/srv/reset.hpp>
#include <phasescan_ros/srv/save_state.hpp>
#include <rclcpp_components/register_node_macro.hpp>
#include <rclcpp_lifecycle/lifecycle_node.hpp>
#include <thread>

#include "ros2/node_support.hpp"
#include "support/temp.hpp"

namespace phasescan::ros2::slam_shell_test {
namespace {

using CallbackReturn = rclcpp_lifecycle::LifecycleNode::CallbackReturn;

class SlamShell : public ::testing::Test {
 protected:
  void SetUp() override {
    rclcpp::stand_in_bus() = {};
    bus().overrides["mounting_from_tf"] = false;
    bus().overrides["odometry"] = std::string("none");
    bus().overrides["transform_timeout"] = std::int64_t{1};  // as people write 1.0
    bus().now_ns = at(0);
  }
  static rclcpp::StandInBus& bus() { return rclcpp::stand_in_bus(); }
  void start() {
    node = rclcpp_components::stand_in_components().at("phasescan_ros::SlamNode")();
    ASSERT_EQ(node->on_configure({}), CallbackReturn::SUCCESS);
    ASSERT_EQ(node->on_activate({}), CallbackReturn::SUCCESS);
  }
  template <class M>
  void say(const std::string& topic, const M& message) {
    const std::vector<std::uint8_t> bytes = encode(message);
    rclcpp::SerializedMessage out(bytes.size());
    std::copy(bytes.begin(), bytes.end(), out.get_rcl_serialized_message().buffer);
    out.get_rcl_serialized_message().buffer_length = bytes.size();
    bus().publish(topic, out);
  }
  void drive(int from, int to) {
    const auto tour = testing::toy_tour(0.1, 0.5, 0.8);
    for (int i = from; i < to; ++i) {
      bus().now_ns = at(0.1 * i);
      say("scan", toy_message(tour[static_cast<std::size_t>(i)], at(0.1 * i), random));
      node->tick();
    }
  }
  template <class S>
  typename S::Response call(const std::string& name, typename S::Request request = {}) {
    typename S::Response response;
    bus().services.at(name)(&request, &response);
    return response;
  }
  template <class M>
  std::vector<M> said(const std::string& topic) {
    std::vector<M> out;
    for (const auto& bytes : bus().said[topic]) out.push_back(decode<M>(bytes));
    return out;
  }

  std::shared_ptr<rclcpp_lifecycle::LifecycleNode> node;
  Random random{4};
};

TEST_F(SlamShell, ScansInTransformsMapAndPoseOut) {
  start();
  drive(0, 40);
  node->on_deactivate({});
  node->on_cleanup({});
  node.reset();  // waits for the thread that draws
  EXPECT_GT(said<PoseWithCovarianceStamped>("pose").size(), 35U);
  ASSERT_FALSE(said<OccupancyGrid>("map").empty());
  EXPECT_FALSE(said<MapMetaData>("map_metadata").empty());
  EXPECT_FALSE(said<String>("status").empty());
  EXPECT_FALSE(said<DiagnosticArray>("/diagnostics").empty());
  bool odom = false, base = false;
  for (const TFMessage& message : said<TFMessage>("/tf")) {
    odom = odom || message.transforms.at(0).child_frame_id == "odom";
    base = base || message.transforms.at(0).child_frame_id == "base_footprint";
  }
  EXPECT_TRUE(odom && base);
}

TEST_F(SlamShell, ParametersOfTheNodeAreThoseOfTheLibrary) {
  start();
  EXPECT_GT(node->declared.size(), 50U);
  for (const auto& [name, descriptor] : node->declared) EXPECT_FALSE(descriptor.description.empty()) << name;
  const auto set = [&](const std::string& name, rclcpp::ParameterValue value) {
    return node->on_set({rclcpp::Parameter(name, std::move(value))});
  };
  EXPECT_TRUE(set("max_laser_range", rclcpp::ParameterValue(5.0)).successful);
  EXPECT_TRUE(set("use_sim_time", rclcpp::ParameterValue(true)).successful);
  const auto refused = set("max_laser_range", rclcpp::ParameterValue(-5.0));
  EXPECT_FALSE(refused.successful);
  EXPECT_NE(refused.reason.find("max_laser_range"), std::string::npos);
  EXPECT_FALSE(set("base_frame", rclcpp::ParameterValue(std::string("x"))).successful);
}

TEST_F(SlamShell, AWrongParameterOfALaunchFileIsSaid) {
  bus().overrides["throttle_scans"] = std::int64_t{0};
  try {
    rclcpp_components::stand_in_components().at("phasescan_ros::SlamNode")();
    FAIL();
  } catch (const rclcpp::exceptions::InvalidParameterValueException& error) {
    EXPECT_NE(std::string(error.what()).find("throttle_scans"), std::string::npos);
  }
}

TEST_F(SlamShell, Services) {
  namespace srv = phasescan_ros::srv;
  const test::TempFolder folder;
  start();
  drive(0, 20);
  EXPECT_FALSE(call<nav_msgs::srv::GetMap>("slam_toolbox/dynamic_map").map.bytes.empty());
  EXPECT_EQ(call<srv::SaveState>("slam_toolbox/save_state", {folder / "a"}).result, 0);
  const auto refused = call<srv::SaveState>("slam_toolbox/save_state", {folder / "none/a"});
  EXPECT_EQ(refused.result, 255);
  EXPECT_FALSE(refused.reason.empty());
  EXPECT_TRUE(call<srv::Pause>("slam_toolbox/pause_new_measurements").paused);
  EXPECT_FALSE(call<srv::Pause>("slam_toolbox/pause_new_measurements").paused);
  EXPECT_EQ(call<srv::LoadState>("slam_toolbox/load_state", {folder / "a", true}).result, 0);
  EXPECT_EQ(call<srv::LoadState>("slam_toolbox/load_state", {folder / "b", false}).result, 255);
  EXPECT_EQ(call<srv::Reset>("slam_toolbox/reset").result, 0);
  EXPECT_EQ(node->on_shutdown({}), CallbackReturn::SUCCESS);
}

TEST_F(SlamShell, BytesThatAreNoneAndPackagesThatAreMissing) {
  bus().missing_types["diagnostic_msgs/msg/DiagnosticArray"] = "";
  start();
  rclcpp::SerializedMessage none(3);
  none.get_rcl_serialized_message().buffer_length = 3;
  bus().publish("scan", none);
  bus().publish("/tf", none);
  drive(0, 10);
  EXPECT_FALSE(bus().said.contains("/diagnostics"));
  EXPECT_FALSE(said<PoseWithCovarianceStamped>("pose").empty());
}

TEST_F(SlamShell, AStateThatCannotBeReadKeepsItUnconfigured) {
  const test::TempFolder folder;
  bus().overrides["state_file"] = folder.put("state", "nonsense");
  node = rclcpp_components::stand_in_components().at("phasescan_ros::SlamNode")();
  EXPECT_EQ(node->on_configure({}), CallbackReturn::FAILURE);
}

}  // namespace
}  // namespace phasescan::ros2::slam_shell_test
