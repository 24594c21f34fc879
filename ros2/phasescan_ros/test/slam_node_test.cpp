// SlamNode as it is run: a process of its own, and another node of ROS 2 that talks with it.
#include <gtest/gtest.h>

#include <geometry_msgs/msg/pose_with_covariance_stamped.hpp>
#include <nav_msgs/msg/occupancy_grid.hpp>
#include <nav_msgs/msg/path.hpp>
#include <nav_msgs/srv/get_map.hpp>
#include <phasescan_ros/srv/load_state.hpp>
#include <phasescan_ros/srv/pause.hpp>
#include <phasescan_ros/srv/reset.hpp>
#include <phasescan_ros/srv/save_state.hpp>
#include <rcl_interfaces/srv/describe_parameters.hpp>
#include <std_msgs/msg/string.hpp>

#include "node_process.hpp"
#include "restart.hpp"
#include "robot.hpp"
#include "support/temp.hpp"

namespace phasescan_ros::test::slam_node_test {
namespace {

using geometry_msgs::msg::PoseWithCovarianceStamped;
using nav_msgs::msg::OccupancyGrid;

class SlamNodeRun : public ::testing::Test {
 protected:
  void start(std::map<std::string, std::string> parameters = {}) {
    process = std::make_unique<NodeProcess>(PHASESCAN_SLAM_NODE, "slam_toolbox", parameters);
    ASSERT_TRUE(tester.bring_up());
  }
  /// Places [from, to) of the tour, in step with the node.
  void drive(Robot& robot, std::size_t from, std::size_t to, double late_s = 0.0) {
    unanswered += robot.drive(from, to, answered_by(poses), late_s);
    EXPECT_TRUE(process->alive());
  }
  std::shared_ptr<nav_msgs::srv::GetMap::Response> get_map() {
    return tester.call<nav_msgs::srv::GetMap>("slam_toolbox/dynamic_map");
  }
  Pose2 last_pose() const {
    const auto& pose = poses->messages.back().pose.pose;
    return pose_of(pose.position, pose.orientation);
  }
  std::vector<Pose2> transforms_to(const std::string& child) const {
    std::vector<Pose2> out;
    for (const TFMessage& message : tf->messages) {
      for (const auto& t : message.transforms) {
        if (t.child_frame_id == child) out.push_back(pose_of(t.transform.translation, t.transform.rotation));
      }
    }
    return out;
  }

  Tester tester{"slam_toolbox"};
  std::shared_ptr<Heard<PoseWithCovarianceStamped>> poses = tester.listen<PoseWithCovarianceStamped>("pose", 100);
  std::shared_ptr<Heard<TFMessage>> tf = tester.listen<TFMessage>("/tf", 1000);
  std::shared_ptr<Heard<diagnostic_msgs::msg::DiagnosticArray>> reports =
      tester.listen<diagnostic_msgs::msg::DiagnosticArray>("/diagnostics", 100);
  std::unique_ptr<NodeProcess> process;
  int unanswered = 0;
};

TEST_F(SlamNodeRun, ScansInMapTransformsPoseStatusDiagnosticsOut) {
  auto states = tester.listen<std_msgs::msg::String>("status", latched());
  auto paths = tester.listen<nav_msgs::msg::Path>("path", latched());
  start();
  Robot robot(tester, false);
  robot.stand_up();
  drive(robot, 0, 100);
  EXPECT_LE(unanswered, 5);
  const std::size_t with_path = [&] {  // the way comes with a map of keyframes, which are made beside the scans
    std::size_t i = 100;
    for (; paths->messages.empty() && i < 250; ++i) drive(robot, i, i + 1);
    return i;
  }();
  ASSERT_GT(poses->messages.size(), 90U);
  const Pose2 truth = robot.pose(with_path - 1);
  EXPECT_LT(translation_distance(last_pose(), truth), 0.1);
  EXPECT_EQ(poses->messages.back().header.frame_id, "map");
  EXPECT_GT(poses->messages.back().pose.covariance[0], 0.0);
  const auto odoms = transforms_to("odom"), bases = transforms_to("base_footprint");
  ASSERT_FALSE(odoms.empty());
  ASSERT_GT(bases.size(), 80U);
  EXPECT_LT(translation_distance(odoms.back() * bases.back(), truth), 0.15);
  EXPECT_FALSE(paths->messages.empty());
  EXPECT_TRUE(tester.wait([&] { return !reports->messages.empty(); }));
  ASSERT_FALSE(states->messages.empty());
  EXPECT_EQ(states->messages.back().data, "ok");
  EXPECT_EQ(process->stop(), 0);
}

TEST_F(SlamNodeRun, WhoComesLateGetsTheMap) {
  start();
  Robot robot(tester, true);
  robot.stand_up();
  drive(robot, 0, 60);
  // As nav2's map_saver and RViz ask for it.
  auto maps = tester.listen<OccupancyGrid>("map", latched());
  auto metadata = tester.listen<nav_msgs::msg::MapMetaData>("map_metadata", latched());
  ASSERT_TRUE(tester.wait([&] { return !maps->messages.empty() && !metadata->messages.empty(); }));
  const OccupancyGrid& map = maps->messages.back();
  EXPECT_EQ(map.header.frame_id, "map");
  EXPECT_EQ(map.data.size(), std::size_t{map.info.width} * map.info.height);
  EXPECT_FLOAT_EQ(map.info.resolution, 0.05F);
  EXPECT_EQ(metadata->messages.back().width, map.info.width);
  EXPECT_GT(std::count(map.data.begin(), map.data.end(), 100), 100);
  EXPECT_GT(std::count(map.data.begin(), map.data.end(), 0), 1000);
  // Wheels bring odom -> base, so the node brings map -> odom alone.
  for (const Pose2& base : transforms_to("base_footprint")) EXPECT_GT(base.x, 3.0);
}

TEST_F(SlamNodeRun, Services) {
  namespace srv = phasescan_ros::srv;
  const phasescan::test::TempFolder folder;
  start();
  Robot robot(tester, false);
  robot.stand_up();
  drive(robot, 0, 40);
  const auto map = get_map();
  ASSERT_TRUE(map);
  EXPECT_GT(std::count(map->map.data.begin(), map->map.data.end(), 100), 100);
  srv::SaveState::Request save;
  save.filename = folder / "a";
  EXPECT_EQ(tester.call<srv::SaveState>("slam_toolbox/save_state", save)->result, 0);
  save.filename = folder / "none/a";
  const auto refused = tester.call<srv::SaveState>("slam_toolbox/save_state", save);
  EXPECT_EQ(refused->result, 255);
  EXPECT_FALSE(refused->reason.empty());

  EXPECT_TRUE(tester.call<srv::Pause>("slam_toolbox/pause_new_measurements")->paused);
  const std::size_t before = poses->messages.size();
  robot.step(40, Robot::stamp(4.0));
  tester.pass(0.5);
  EXPECT_EQ(poses->messages.size(), before);
  EXPECT_FALSE(tester.call<srv::Pause>("slam_toolbox/pause_new_measurements")->paused);

  EXPECT_EQ(tester.call<srv::Reset>("slam_toolbox/reset")->result, 0);
  EXPECT_TRUE(get_map()->map.data.empty());
  srv::LoadState::Request load;
  load.filename = folder / "a";
  EXPECT_EQ(tester.call<srv::LoadState>("slam_toolbox/load_state", load)->result, 0);
  drive(robot, 41, 60);
  EXPECT_LT(translation_distance(last_pose(), robot.pose(59)), 0.1);  // of the run that was loaded
  load.filename = folder / "b";
  EXPECT_EQ(tester.call<srv::LoadState>("slam_toolbox/load_state", load)->result, 255);
}

TEST_F(SlamNodeRun, Parameters) {
  start({{"transform_timeout", "1"}, {"map.resolution_m", "0.1"}});  // 1 is taken for 1.0
  Robot robot(tester, false);
  robot.stand_up();
  drive(robot, 0, 20);
  EXPECT_FLOAT_EQ(get_map()->map.info.resolution, 0.1F);
  EXPECT_EQ(tester.set(rclcpp::Parameter("max_laser_range", 5.0)), "");
  EXPECT_EQ(tester.set(rclcpp::Parameter("max_laser_range", 6)), "");
  EXPECT_NE(tester.set(rclcpp::Parameter("max_laser_range", -5.0)).find("max_laser_range"), std::string::npos);
  EXPECT_NE(tester.set(rclcpp::Parameter("max_laser_range", "far")).find("max_laser_range"), std::string::npos);
  EXPECT_NE(tester.set(rclcpp::Parameter("base_frame", "x")).find("base_frame"), std::string::npos);
  EXPECT_EQ(tester.set(rclcpp::Parameter("loops.votes", 2)), "");
  drive(robot, 20, 40);
  EXPECT_LT(translation_distance(last_pose(), robot.pose(39)), 0.1);
  rcl_interfaces::srv::DescribeParameters::Request describe;
  describe.names = {"max_laser_range"};
  const auto described =
      tester.call<rcl_interfaces::srv::DescribeParameters>("slam_toolbox/describe_parameters", describe);
  ASSERT_EQ(described->descriptors.size(), 1U);
  EXPECT_FALSE(described->descriptors[0].description.empty());
}

TEST_F(SlamNodeRun, KilledAndStartedAgainItGoesOn) {
  const phasescan::test::TempFolder folder;
  const std::map<std::string, std::string> parameters = {{"state_file", folder / "run.phasescan"},
                                                         {"autosave_period", "2.0"}};
  start(parameters);
  Robot robot(tester, true);
  robot.stand_up();
  drive(robot, 0, 125);
  kill_and_start_again(tester, robot, 130, *poses, process, [&] { start(parameters); });
  if (HasFatalFailure()) return;
  // What was mapped before is on the map: both rooms.
  EXPECT_GT(get_map()->map.info.width * 0.05, 11.0);
}

TEST_F(SlamNodeRun, CtrlCSaves) {
  const phasescan::test::TempFolder folder;
  start({{"state_file", folder / "run.phasescan"}, {"autosave_period", "0"}});
  Robot robot(tester, false);
  robot.stand_up();
  drive(robot, 0, 20);
  EXPECT_FALSE(std::filesystem::exists(folder / "run.phasescan"));
  EXPECT_EQ(process->stop(), 0);
  EXPECT_TRUE(std::filesystem::exists(folder / "run.phasescan"));
}

TEST_F(SlamNodeRun, AStateThatIsNoneKeepsItUnconfigured) {
  const phasescan::test::TempFolder folder;
  process =
      std::make_unique<NodeProcess>(PHASESCAN_SLAM_NODE, "slam_toolbox",
                                    std::map<std::string, std::string>{{"state_file", folder.put("run", "nonsense")}});
  EXPECT_FALSE(tester.change_state(Transition::TRANSITION_CONFIGURE));
  EXPECT_TRUE(process->alive());
}

/// The same messages twice: a node each, in step, by the time of the bag.
TEST_F(SlamNodeRun, ABagTwiceGivesTheSameTrajectoryAndTheSameMap) {
  std::vector<PoseWithCovarianceStamped> trajectories[2];
  OccupancyGrid maps[2];
  for (int run = 0; run < 2; ++run) {
    start({{"deterministic", "true"}});
    Robot robot(tester, true);
    robot.stand_up();
    drive(robot, 0, 250);
    trajectories[run] = poses->messages;
    maps[run] = get_map()->map;
    process->stop();
    poses->messages.clear();
  }
  ASSERT_EQ(unanswered, 0);
  ASSERT_EQ(trajectories[0].size(), trajectories[1].size());
  EXPECT_TRUE(trajectories[0] == trajectories[1]);
  EXPECT_TRUE(maps[0] == maps[1]);
  EXPECT_GT(maps[0].data.size(), 10000U);
}

}  // namespace
}  // namespace phasescan_ros::test::slam_node_test
