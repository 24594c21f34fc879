// Robots as they are: both nodes get what no driver should send. None may end, and diagnostics name what was met.
#include <gtest/gtest.h>

#include <limits>

#include "map_of_rooms.hpp"
#include "node_process.hpp"
#include "robot.hpp"

namespace phasescan_ros::test::hostile_test {
namespace {

using diagnostic_msgs::msg::DiagnosticArray;
using nav_msgs::msg::OccupancyGrid;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

struct Node {
  std::string name, executable;
  friend void PrintTo(const Node& node, std::ostream* out) { *out << node.name; }
};

class Hostile : public ::testing::TestWithParam<Node> {
 protected:
  void SetUp() override {
    tester = std::make_unique<Tester>(GetParam().name);
    reports = tester->listen<DiagnosticArray>("/diagnostics", 100);
    maps = std::make_unique<Voice<OccupancyGrid>>(tester->node(), "map_of_server", latched());
    maps->publish(map_of_rooms());
    const bool localizes = GetParam().name == "amcl";
    process =
        std::make_unique<NodeProcess>(GetParam().executable, GetParam().name,
                                      localizes ? std::map<std::string, std::string>{{"map_topic", "map_of_server"}}
                                                : std::map<std::string, std::string>{});
    ASSERT_TRUE(tester->bring_up());
    robot = std::make_unique<Robot>(*tester, true);
  }
  void TearDown() override {
    ASSERT_TRUE(process->alive());
    EXPECT_EQ(process->stop(), 0);
  }
  void drive(int scans, double period_s = 0.03) {
    for (int i = 0; i < scans; ++i, ++at) {
      robot->step(at, now());
      tester->pass(period_s);
    }
  }
  phasescan::Stamp now() const { return Robot::stamp(0.1 * static_cast<double>(at) + late_s); }
  /// Says a scan that was spoiled, at its turn.
  template <class Spoil>
  void say(Spoil spoil) {
    robot->publish(tf_message(now(), "odom", "base_footprint", robot->wheel_pose(at)));
    LaserScan scan = robot->scan(at, now());
    spoil(scan);
    robot->publish(scan);
    ++at;
    tester->pass(0.05);
  }
  void expect_named(const std::string& kind) {
    EXPECT_TRUE(tester->wait([&] { return named(*reports, kind); }, 15.0)) << kind;
    EXPECT_TRUE(process->alive()) << kind;
  }

  std::unique_ptr<Tester> tester;
  std::shared_ptr<Heard<DiagnosticArray>> reports;
  std::unique_ptr<Voice<OccupancyGrid>> maps;
  std::unique_ptr<NodeProcess> process;
  std::unique_ptr<Robot> robot;
  std::size_t at = 0;
  double late_s = 0.0;
};

TEST_P(Hostile, ScansBeforeTransformsThenGapsInThem) {
  tester->pass(1.0);
  drive(20);  // where the laser sits nobody has said
  expect_named("scan_before_transform");
  expect_named("queue_full");
  robot->stand_up();
  drive(20);
  for (int i = 0; i < 30; ++i, ++at) {  // the wheels are silent for three seconds
    robot->publish(robot->scan(at, now()));
    tester->pass(0.03);
  }
  drive(20);
  expect_named("transform_gap");
}

TEST_P(Hostile, TheClockJumpsBack) {
  robot->stand_up();
  drive(40);
  at = 0;  // the bag begins again
  drive(40);
  expect_named("clock_jumped_back");
}

TEST_P(Hostile, TwoDriversOnOneTopic) {
  robot->stand_up();
  drive(20);
  for (int i = 0; i < 20; ++i) {
    drive(1);
    robot->publish([&] {
      LaserScan scan = robot->scan(at, now());
      scan.header.frame_id = "other_laser";
      return scan;
    }());
    tester->pass(0.03);
  }
  expect_named("two_publishers");
}

TEST_P(Hostile, ScansThatAreNone) {
  robot->stand_up();
  drive(20);
  say([](LaserScan& scan) { scan.ranges.clear(); });
  say([](LaserScan& scan) { std::fill(scan.ranges.begin(), scan.ranges.end(), kNan); });
  say([](LaserScan& scan) { scan.ranges.resize(170); });
  say([](LaserScan& scan) { scan.angle_increment = kNan; });
  say([](LaserScan& scan) { scan.range_max = -std::numeric_limits<float>::infinity(); });
  say([](LaserScan& scan) { scan.header.frame_id.clear(); });
  say([](LaserScan& scan) { scan.time_increment = 1e30F; });
  say([](LaserScan& scan) { scan.intensities.assign(7, kNan); });
  say([](LaserScan& scan) { scan.ranges.assign(20'000, 1.0F); });
  drive(20);
  for (const char* kind : {"no_beams", "no_returns", "beams_changed", "bad_scan"}) expect_named(kind);
}

TEST_P(Hostile, TransformsThatAreNone) {
  robot->stand_up();
  drive(20);
  robot->publish(tf_message(now(), "odom", "base_footprint", {kNan, 0, 0}));
  robot->publish(tf_message(now(), "laser", "base_footprint", {1, 0, 0}));  // a loop
  robot->publish(tf_message(now(), "odom", "odom", {1, 0, 0}));
  robot->publish(TFMessage{});
  drive(20);
  expect_named("bad_transform");
}

TEST_P(Hostile, ReconfiguredWhileRunning) {
  const bool localizes = GetParam().name == "amcl";
  robot->stand_up();
  for (int i = 0; i < 5; ++i) {
    drive(5);
    EXPECT_EQ(tester->set(rclcpp::Parameter(localizes ? "laser_max_range" : "max_laser_range", 5.0 + i)), "");
  }
  expect_named("reconfigured");
}

TEST_P(Hostile, UpAndDownWhileScansCome) {
  robot->stand_up();
  for (int i = 0; i < 3; ++i) {
    drive(10);
    EXPECT_TRUE(tester->change_state(Transition::TRANSITION_DEACTIVATE));
    drive(5);
    EXPECT_TRUE(tester->change_state(Transition::TRANSITION_CLEANUP));
    drive(5);
    EXPECT_TRUE(tester->bring_up());
  }
  drive(10);
}

TEST_P(Hostile, NothingComes) {
  ASSERT_TRUE(tester->wait([&] { return !reports->messages.empty(); }));
  EXPECT_FALSE(named(*reports, "no_scans"));  // it has just begun to listen
  expect_named("no_scans");
}

INSTANTIATE_TEST_SUITE_P(BothNodes, Hostile,
                         ::testing::Values(Node{"slam_toolbox", PHASESCAN_SLAM_NODE},
                                           Node{"amcl", PHASESCAN_LOCALIZATION_NODE}),
                         [](const auto& info) { return info.param.name; });

}  // namespace
}  // namespace phasescan_ros::test::hostile_test
