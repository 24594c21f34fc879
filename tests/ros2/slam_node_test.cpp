// The SLAM node as a whole: what comes out, when, and what it makes of a hostile robot.
#include "ros2/slam_node.hpp"

#include <gtest/gtest.h>

#include <filesystem>

#include "phasescan/slam/state.hpp"
#include "ros2/node_support.hpp"
#include "support/temp.hpp"

namespace phasescan::ros2::slam_node_test {
namespace {

/// A robot that drives through two rooms: its scans, and wheels that drift.
class Robot {
 public:
  explicit Robot(SlamNode& node, bool wheels) : node_(node), wheels_(wheels) {
    node.on_transforms(tf_message(0, "base_footprint", "laser", T_base_laser), true, at(0));
  }
  /// Scans [from, to) of the tour, 10 a second, `late_s` by the clock after the first drive.
  void drive(std::size_t from, std::size_t to, double late_s = 0.0) {
    for (std::size_t i = from; i < to; ++i) {
      const double t = 0.1 * static_cast<double>(i) + late_s;
      if (wheels_) {
        node_.on_transforms(tf_message(at(t), "odom", "base_footprint", wheel_pose(i)), false, at(t));
      }
      node_.on_scan("scan", toy_message(pose(i) * T_base_laser, at(t), random_), at(t));
    }
  }
  Pose2 pose(std::size_t i) const { return tour_[std::min(i, tour_.size() - 1)]; }
  Pose2 wheel_pose(std::size_t i) const { return Pose2{5, 5, 1} * Pose2{1.03 * pose(i).x, pose(i).y, pose(i).theta}; }

  static constexpr Pose2 T_base_laser{0.1, 0.0, 0.0};

 private:
  SlamNode& node_;
  bool wheels_;
  std::vector<Pose2> tour_ = testing::toy_tour(0.1, 0.5, 0.8);
  Random random_{11};
};

SlamNode::Setup setup() {
  SlamNode::Setup out;
  out.node.deterministic = true;
  return out;
}

double error_m(const Pose2& a, const Pose2& b) {
  return translation_distance(a, b);
}

TEST(SlamNodeTest, WithoutOdometryItPublishesTheWholeWayFromMapToBase) {
  KeptOutputs out;
  SlamNode node(setup(), out);
  ASSERT_TRUE(node.configure(at(0)).done);
  node.activate();
  Robot robot(node, false);
  robot.drive(0, 200);
  const auto bases = out.of("base_footprint"), odoms = out.of("odom");
  ASSERT_GT(bases.size(), 190U);
  ASSERT_GT(odoms.size(), 100U);
  EXPECT_EQ(bases.back().header.frame_id, "odom");
  EXPECT_EQ(odoms.back().header.frame_id, "map");
  // The map begins where the base was at first, which is the world's origin here.
  EXPECT_LT(error_m(pose_of(odoms.back()) * pose_of(bases.back()), robot.pose(199)), 0.1);
  // Stamped after the last scan.
  EXPECT_EQ(odoms.back().header.stamp, bases.back().header.stamp + stamp_from_seconds(0.2));
  ASSERT_GT(out.poses.size(), 190U);
  EXPECT_LT(error_m(to_pose2(out.poses.back().pose.pose), robot.pose(199)), 0.1);
  EXPECT_EQ(out.poses.back().header.frame_id, "map");
  EXPECT_GT(out.poses.back().pose.covariance[0], 0.0);
  ASSERT_GE(out.maps.size(), 3U);
  EXPECT_GT(std::count(out.maps.back().data.begin(), out.maps.back().data.end(), 100), 200);
  EXPECT_FALSE(out.paths.empty());
  EXPECT_NE(std::find(out.states.begin(), out.states.end(), "ok"), out.states.end());
  EXPECT_GE(out.reports.size(), 19U);
}

TEST(SlamNodeTest, TheFirstScanBringsAMap) {
  KeptOutputs out;
  SlamNode node(setup(), out);
  ASSERT_TRUE(node.configure(at(0)).done);
  node.activate();
  Robot robot(node, true);
  robot.drive(0, 4);
  ASSERT_FALSE(out.maps.empty());
  EXPECT_GT(std::count(out.maps.front().data.begin(), out.maps.front().data.end(), 0), 1000);
}

TEST(SlamNodeTest, WithWheelsItPublishesMapToOdomAlone) {
  KeptOutputs out;
  SlamNode node(setup(), out);
  ASSERT_TRUE(node.configure(at(0)).done);
  node.activate();
  Robot robot(node, true);
  robot.drive(0, 150);
  EXPECT_TRUE(out.of("base_footprint").empty());
  const auto odoms = out.of("odom");
  ASSERT_FALSE(odoms.empty());
  EXPECT_LT(error_m(pose_of(odoms.back()) * robot.wheel_pose(149), robot.pose(149)), 0.12);
}

TEST(SlamNodeTest, EveryScanBringsItsMapToOdomAtOnce) {
  KeptOutputs out;
  SlamNode node(setup(), out);
  ASSERT_TRUE(node.configure(at(0)).done);
  node.activate();
  Robot robot(node, true);
  robot.drive(0, 20);
  for (std::size_t i = 20; i < 30; ++i) {
    node.tick(at(0.1 * static_cast<double>(i) - 0.01));  // by time it has just been published
    robot.drive(i, i + 1);
    EXPECT_EQ(out.of("odom").back().header.stamp, at(0.1 * static_cast<double>(i)) + stamp_from_seconds(0.2));
  }
}

TEST(SlamNodeTest, TheSameMessagesGiveTheSameBytes) {
  std::vector<std::uint8_t> bytes[2];
  for (auto& run : bytes) {
    KeptOutputs out;
    SlamNode node(setup(), out);
    ASSERT_TRUE(node.configure(at(0)).done);
    node.activate();
    Robot(node, true).drive(0, 200);
    run = out.bytes();
  }
  EXPECT_GT(bytes[0].size(), 10000U);
  EXPECT_EQ(bytes[0], bytes[1]);
}

TEST(SlamNodeTest, NothingIsPublishedBeforeActivationOrWhilePaused) {
  KeptOutputs out;
  SlamNode node(setup(), out);
  Robot robot(node, false);
  robot.drive(0, 5);
  EXPECT_FALSE(node.reset(at(0)).done);
  ASSERT_TRUE(node.configure(at(0)).done);
  EXPECT_FALSE(node.configure(at(0)).done);
  robot.drive(5, 10);
  EXPECT_TRUE(out.transform_list.empty());
  EXPECT_FALSE(node.dynamic_map());
  node.activate();
  node.pause(true);
  robot.drive(10, 20);
  EXPECT_TRUE(out.transform_list.empty());
  node.pause(false);
  robot.drive(20, 40);
  EXPECT_FALSE(out.transform_list.empty());
  EXPECT_TRUE(node.dynamic_map());
}

TEST(SlamNodeTest, KilledAndStartedAgainItGoesOnWhereItWas) {
  const test::TempFolder folder;
  SlamNode::Setup options = setup();
  options.node.state_file = folder / "run.phasescan";
  options.node.autosave_period = 2.0;
  {
    KeptOutputs out;
    SlamNode node(options, out);
    ASSERT_TRUE(node.configure(at(0)).done);
    node.activate();
    Robot(node, false).drive(0, 125);
    // No word of goodbye: what was saved while running must do.
  }
  ASSERT_TRUE(std::filesystem::exists(options.node.state_file));
  KeptOutputs out;
  SlamNode node(options, out);
  ASSERT_TRUE(node.configure(at(0)).done);
  EXPECT_GE(node.scans(), 100U);
  node.activate();
  Robot robot(node, false);
  robot.drive(130, 150);
  ASSERT_FALSE(out.poses.empty());
  EXPECT_LT(error_m(to_pose2(out.poses.back().pose.pose), robot.pose(149)), 0.1);
  // And once more by the orderly way.
  node.deactivate(at(15));
  node.cleanup();
  EXPECT_EQ(node.lifecycle(), Lifecycle::kUnconfigured);
  ASSERT_TRUE(node.configure(at(15)).done);
  EXPECT_GE(node.scans(), 140U);
}

TEST(SlamNodeTest, AStateThatIsNoneIsSaidAndRefused) {
  const test::TempFolder folder;
  SlamNode::Setup options = setup();
  options.node.state_file = folder.put("run.phasescan", "no state at all");
  KeptOutputs out;
  SlamNode node(options, out);
  const Answer answer = node.configure(at(0));
  EXPECT_FALSE(answer.done);
  EXPECT_NE(answer.why.find("run.phasescan"), std::string::npos);
  EXPECT_EQ(node.lifecycle(), Lifecycle::kUnconfigured);
  EXPECT_FALSE(node.save_state(folder / "x", at(0)).done);
  EXPECT_EQ(node.diagnostics().count(Trouble::kSaveFailed), 1U);
}

TEST(SlamNodeTest, ServicesSaveLoadExtendReset) {
  const test::TempFolder folder;
  KeptOutputs out;
  SlamNode node(setup(), out);
  ASSERT_TRUE(node.configure(at(0)).done);
  node.activate();
  Robot robot(node, false);
  robot.drive(0, 60);
  ASSERT_TRUE(node.save_state(folder / "a", at(6)).done);
  EXPECT_FALSE(node.save_state(folder / "none/b", at(6)).done);
  EXPECT_TRUE(node.reset(at(6)).done);
  EXPECT_EQ(node.scans(), 0U);
  ASSERT_TRUE(node.load_state(folder / "a", true, at(6)).done);
  const std::size_t before = node.scans();
  robot.drive(60, 80);
  EXPECT_GT(node.scans(), before + 15);
  EXPECT_EQ(node.finish().sessions.size(), 2U);
}

TEST(SlamNodeTest, ALoopedBagGoesOnOnTheSameMap) {
  KeptOutputs out;
  SlamNode node(setup(), out);
  ASSERT_TRUE(node.configure(at(0)).done);
  node.activate();
  Robot robot(node, true);
  robot.drive(0, 120);
  robot.drive(0, 60);
  EXPECT_EQ(node.diagnostics().count(Trouble::kClockJumpedBack), 1U);
  EXPECT_GE(node.scans(), 175U);
  EXPECT_EQ(out.reports.back().status.at(0).level, DiagnosticStatus::kWarn);
}

TEST(SlamNodeTest, ReconfiguredWhileRunning) {
  KeptOutputs out;
  SlamNode node(setup(), out);
  ASSERT_TRUE(node.configure(at(0)).done);
  node.activate();
  Robot robot(node, false);
  robot.drive(0, 40);
  EXPECT_TRUE(node.set_parameter("max_laser_range", 5.0, at(4)).done);
  EXPECT_TRUE(node.set_parameter("loops.votes", std::int64_t{2}, at(4)).done);
  EXPECT_FALSE(node.set_parameter("base_frame", std::string("x"), at(4)).done);
  EXPECT_FALSE(node.set_parameter("loops.votes", std::int64_t{0}, at(4)).done);
  EXPECT_EQ(std::get<std::int64_t>(node.parameters().find("loops.votes")->get()), 2);
  EXPECT_EQ(node.diagnostics().count(Trouble::kReconfigured), 2U);
  robot.drive(40, 80);
  ASSERT_FALSE(out.poses.empty());
  EXPECT_LT(error_m(to_pose2(out.poses.back().pose.pose), robot.pose(79)), 0.1);
}

TEST(SlamNodeTest, SilenceIsTold) {
  KeptOutputs out;
  SlamNode node(setup(), out);
  ASSERT_TRUE(node.configure(at(0)).done);
  node.activate();
  for (int i = 0; i < 100; ++i) node.tick(at(0.05 * i));
  ASSERT_EQ(out.reports.size(), 5U);
  EXPECT_EQ(out.reports.front().status.at(0).level, DiagnosticStatus::kOk);  // it has just begun to listen
  EXPECT_EQ(out.reports.back().status.at(0).level, DiagnosticStatus::kStale);
  EXPECT_TRUE(out.transform_list.empty());
}

TEST(SlamNodeTest, AnyOrderOfMessagesIsSurvived) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    Random random(seed);
    KeptOutputs out;
    SlamNode node(setup(), out);
    const std::vector<Pose2> tour = testing::toy_tour(0.1, 0.5, 0.8);
    double t = 0.0;
    for (int i = 0; i < 250; ++i) {
      t += random.uniform(-0.02, 0.2);
      if (random.chance(0.02)) t -= random.uniform(0.0, 30.0);
      LaserScan scan = toy_message(tour[static_cast<std::size_t>(i) % tour.size()], at(t), random,
                                   random.chance(0.1) ? "other" : "laser");
      if (random.chance(0.1)) scan.ranges.resize(random.below(400));
      if (random.chance(0.05)) scan = random_message<LaserScan>(seed * 1000 + static_cast<std::uint64_t>(i));
      if (random.chance(0.1)) std::fill(scan.ranges.begin(), scan.ranges.end(), std::nanf(""));
      switch (random.below(12)) {
        case 0:
          node.configure(at(t));
          break;
        case 1:
          node.activate();
          break;
        case 2:
          random.chance(0.2) ? node.deactivate(at(t)) : node.tick(at(t));
          break;
        case 3:
          node.on_transforms(tf_message(at(t), "odom", "base_footprint", {0.1 * i, 0, 0}), false, at(t));
          break;
        case 4:
          node.on_transforms(tf_message(at(t), "base_footprint", "laser", {0.1, 0, 0}), random.chance(0.5), at(t));
          break;
        case 5:
          node.on_transforms(random_message<TFMessage>(seed + static_cast<std::uint64_t>(i)), random.chance(0.5),
                             at(t));
          break;
        case 6:
          node.set_parameter("odometry", std::string("tf"), at(t));
          break;
        case 7:
          node.pause(random.chance(0.3));
          break;
        default:
          break;
      }
      node.on_scan(random.chance(0.9) ? "scan" : "scan2", scan, at(t));
    }
    for (const PoseWithCovarianceStamped& pose : out.poses) EXPECT_TRUE(to_pose2(pose.pose.pose).is_finite());
  }
}

}  // namespace
}  // namespace phasescan::ros2::slam_node_test
