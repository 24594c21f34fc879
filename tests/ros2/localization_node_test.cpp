// The localisation node as a whole, with a finder that answers what the test tells it to.
#include "ros2/localization_node.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

#include "ros2/node_support.hpp"
#include "support/temp.hpp"

namespace phasescan::ros2::localization_node_test {
namespace {

/// What the node asked of its finders, and what they answer.
struct Script {
  FoundPose answer;
  int made = 0, globally = 0, scans = 0;
  std::vector<Pose2> begun_at;
  std::vector<Eigen::Matrix3d> begun_with;
};

class ScriptedFinder final : public PoseFinder {
 public:
  explicit ScriptedFinder(Script& script) : script_(script) {}
  void initialize(const Pose2& pose, const Eigen::Matrix3d& covariance) override {
    script_.begun_at.push_back(pose);
    script_.begun_with.push_back(covariance);
  }
  void initialize_globally() override { ++script_.globally; }
  FoundPose add(const RangeMeasurement&) override {
    ++script_.scans;
    return script_.answer;
  }

 private:
  Script& script_;
};

class ScriptedFactory final : public PoseFinderFactory {
 public:
  std::unique_ptr<PoseFinder> make(const TrinaryMap& map) override {
    if (map.width < 2) throw std::invalid_argument("map.width: too small");
    ++script.made;
    return std::make_unique<ScriptedFinder>(script);
  }
  Script script;
};

OccupancyGrid grid(const std::string& frame = "map") {
  OccupancyGrid out;
  out.header.frame_id = frame;
  out.info = {0, 0.05F, 2, 2, {}};
  out.data = {0, 0, 100, -1};
  return out;
}

class Node : public ::testing::Test {
 protected:
  void start(bool with_map = true) {
    node = std::make_unique<LocalizationNode>(setup, factory, out);
    ASSERT_TRUE(node->configure(at(0)).done);
    node->on_transforms(tf_message(0, "base_footprint", "laser", {}), true, at(0));
    if (with_map) node->on_map(grid(), at(0));
    node->activate();
  }
  void answer(TrackingStatus status, const Pose2& pose) {
    factory.script.answer = {status, pose, 0.01 * Eigen::Matrix3d::Identity(), 0.99, {{pose, 0.99}, {{1, 1, 1}, 0.01}}};
  }
  void scan(double t, bool odometry = true) {
    if (odometry) node->on_transforms(tf_message(at(t), "odom", "base_footprint", {t, 0, 0}), false, at(t));
    node->on_scan("scan", toy_message({}, at(t), random), at(t));
  }
  PoseWithCovarianceStamped pose_message(const std::string& frame = "map") {
    return to_pose_message(at(0), frame, {3, 4, 0.5}, 0.25 * Eigen::Matrix3d::Identity());
  }

  LocalizationNode::Setup setup;
  ScriptedFactory factory;
  KeptOutputs out;
  std::unique_ptr<LocalizationNode> node;
  Random random{1};
};

TEST_F(Node, MapToOdomGoesOutWithEveryScanAndNotBeforeTheFirstPose) {
  start();
  factory.script.answer = {TrackingStatus::kInitialising, std::nullopt, Eigen::Matrix3d::Identity(), 0.0, {}};
  scan(0.0);
  scan(0.1);
  EXPECT_TRUE(out.transform_list.empty());
  EXPECT_TRUE(out.poses.empty());
  answer(TrackingStatus::kOk, {5, 5, kPi / 2});
  scan(0.2);
  answer(TrackingStatus::kLost, {});
  scan(0.3);
  scan(0.4);
  const auto odoms = out.of("odom");
  ASSERT_EQ(odoms.size(), 3U);
  EXPECT_EQ(odoms[0].header.stamp, at(1.2));  // scan + transform_tolerance
  EXPECT_EQ(odoms[2].header.stamp, at(1.4));
  // map -> odom * odom -> base is the pose found, also afterwards.
  for (const TransformStamped& odom : odoms) {
    const Pose2 base = pose_of(odom) * Pose2{0.2, 0, 0};
    EXPECT_NEAR(base.x, 5.0, 1e-9);
    EXPECT_NEAR(base.theta, kPi / 2, 1e-9);
  }
  ASSERT_EQ(out.poses.size(), 1U);
  EXPECT_EQ(out.poses[0].header.stamp, at(0.2));
  EXPECT_EQ(out.poses[0].header.frame_id, "map");
  EXPECT_NEAR(out.poses[0].pose.covariance[35], 0.01, 1e-12);
  EXPECT_EQ(out.clouds.size(), 5U);
  EXPECT_EQ(out.clouds[2].particles.size(), 2U);
  EXPECT_EQ(out.states, (std::vector<std::string>{"initialising", "ok", "lost"}));
  EXPECT_EQ(node->diagnostics().count(Trouble::kLost), 2U);
}

TEST_F(Node, AnInitialPoseBeforeActivationIsAppliedThen) {
  node = std::make_unique<LocalizationNode>(setup, factory, out);
  node->on_initial_pose(pose_message(), at(0));
  ASSERT_TRUE(node->configure(at(0)).done);
  node->on_map(grid(), at(0));
  EXPECT_TRUE(factory.script.begun_at.empty());
  node->activate();
  ASSERT_EQ(factory.script.begun_at.size(), 1U);
  EXPECT_NEAR(factory.script.begun_at[0].x, 3.0, 1e-12);
  EXPECT_NEAR(factory.script.begun_with[0](0, 0), 0.25, 1e-12);
  // And once only.
  node->deactivate(at(1));
  node->activate();
  EXPECT_EQ(factory.script.begun_at.size(), 1U);
}

TEST_F(Node, PosesThatCannotBeUsedAreTold) {
  start();
  node->on_initial_pose(pose_message("odom"), at(0));
  PoseWithCovarianceStamped bad = pose_message();
  bad.pose.pose.position.x = std::nan("");
  node->on_initial_pose(bad, at(0));
  EXPECT_TRUE(factory.script.begun_at.empty());
  EXPECT_EQ(node->diagnostics().count(Trouble::kBadPose), 2U);
  bad = pose_message("/map");
  bad.pose.covariance.fill(0.0);  // as some tools send it
  node->on_initial_pose(bad, at(0));
  ASSERT_EQ(factory.script.begun_at.size(), 1U);
  EXPECT_GT(factory.script.begun_with[0](0, 0), 0.1);
}

TEST_F(Node, TheInitialPoseOfTheParameters) {
  setup.node.set_initial_pose = true;
  setup.node.initial_x = 7.0;
  start();
  ASSERT_EQ(factory.script.begun_at.size(), 1U);
  EXPECT_EQ(factory.script.begun_at[0].x, 7.0);
  node->deactivate(at(1));
  node->activate();
  EXPECT_EQ(factory.script.begun_at.size(), 1U);
  ASSERT_TRUE(node->set_parameter("always_reset_initial_pose", true, at(1)).done);
  node->deactivate(at(2));
  node->activate();
  EXPECT_EQ(factory.script.begun_at.size(), 2U);
}

TEST_F(Node, MapsThatComeLateAgainOrWrong) {
  start(false);
  scan(0.0);
  EXPECT_EQ(factory.script.scans, 0);
  EXPECT_GT(node->diagnostics().count(Trouble::kNoMap), 0U);
  EXPECT_FALSE(node->reinitialize_global_localization(at(0)).done);
  node->on_map(grid("world"), at(0));
  OccupancyGrid bad = grid();
  bad.data.pop_back();
  node->on_map(bad, at(0));
  EXPECT_EQ(node->diagnostics().count(Trouble::kBadMap), 2U);
  EXPECT_EQ(factory.script.made, 0);
  node->on_map(grid(), at(0));
  answer(TrackingStatus::kOk, {2, 2, 0});
  scan(0.1);
  EXPECT_EQ(factory.script.scans, 1);
  // Another map: the pose of before is a guess for it.
  node->on_map(grid(), at(0.2));
  EXPECT_EQ(factory.script.made, 2);
  ASSERT_EQ(factory.script.begun_at.size(), 1U);
  EXPECT_EQ(factory.script.begun_at[0].x, 2.0);
  ASSERT_TRUE(node->set_parameter("first_map_only", true, at(0.2)).done);
  node->on_map(grid(), at(0.3));
  EXPECT_EQ(factory.script.made, 2);
}

TEST_F(Node, WithoutOdometryItPublishesItsOwn) {
  start();
  answer(TrackingStatus::kOk, {5, 5, 0});
  for (int i = 0; i < 20; ++i) scan(0.1 * i, false);
  ASSERT_FALSE(out.of("base_footprint").empty());
  const Pose2 whole = pose_of(out.of("odom").back()) * pose_of(out.of("base_footprint").back());
  EXPECT_NEAR(whole.x, 5.0, 1e-9);
}

TEST_F(Node, GlobalLocalisationAndALoopedBag) {
  start();
  answer(TrackingStatus::kOk, {5, 5, 0});
  for (int i = 0; i < 50; ++i) scan(0.1 * i);
  EXPECT_TRUE(node->reinitialize_global_localization(at(5)).done);
  EXPECT_TRUE(node->request_nomotion_update().done);
  EXPECT_EQ(factory.script.globally, 1);
  answer(TrackingStatus::kLost, {});
  const std::size_t before = out.of("odom").size();
  scan(0.0);  // begins again, and nothing is found: what was published before is void
  EXPECT_EQ(factory.script.globally, 2);
  EXPECT_EQ(out.of("odom").size(), before);
  EXPECT_EQ(node->diagnostics().count(Trouble::kClockJumpedBack), 1U);
}

TEST_F(Node, TransformsCanBeSwitchedOff) {
  setup.node.tf_broadcast = false;
  start();
  answer(TrackingStatus::kOk, {5, 5, 0});
  scan(0.0);
  EXPECT_TRUE(out.transform_list.empty());
  EXPECT_EQ(out.poses.size(), 1U);
}

TEST_F(Node, ThePoseIsSavedAndReadAgain) {
  const test::TempFolder folder;
  setup.node.saved_pose_filepath = folder / "pose";
  start();
  answer(TrackingStatus::kOk, {5, 6, 0.25});
  for (int i = 0; i < 5; ++i) scan(0.1 * i);
  node->deactivate(at(1));
  factory.script.begun_at.clear();
  start();
  ASSERT_EQ(factory.script.begun_at.size(), 1U);
  EXPECT_EQ(factory.script.begun_at[0], (Pose2{5, 6, 0.25}));
  // A file that is none is told, and does no harm.
  folder.put("pose", "nonsense");
  start();
  EXPECT_EQ(node->diagnostics().count(Trouble::kSaveFailed), 1U);
}

TEST_F(Node, NoScansAreStale) {
  start();
  for (int i = 0; i < 50; ++i) node->tick(at(0.1 * i));
  ASSERT_EQ(out.reports.size(), 5U);
  EXPECT_EQ(out.reports.front().status.at(0).level, DiagnosticStatus::kOk);  // it has just begun to listen
  EXPECT_EQ(out.reports.back().status.at(0).level, DiagnosticStatus::kStale);
  EXPECT_EQ(out.reports.back().status.at(0).name, "amcl: phasescan");
}

}  // namespace
}  // namespace phasescan::ros2::localization_node_test
