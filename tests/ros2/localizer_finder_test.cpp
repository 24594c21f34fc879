// The localisation node with the localiser of the library: nav2's own checks, with a robot that is simulated.
#include "ros2/localizer_finder.hpp"

#include <gtest/gtest.h>

#include "ros2/localization_node.hpp"
#include "ros2/node_support.hpp"
#include "ros2/slam_node.hpp"

namespace phasescan::ros2::localizer_finder_test {
namespace {

/// The map that the SLAM node makes of both rooms. Its frame is the robot's first pose, the world's origin.
const OccupancyGrid& mapped_rooms() {
  static const OccupancyGrid grid = [] {
    KeptOutputs out;
    SlamNode::Setup setup;
    setup.node.deterministic = true;
    setup.node.mounting_from_tf = false;
    setup.node.odometry = OdometrySource::kNone;
    SlamNode node(setup, out);
    node.configure(at(0));
    node.activate();
    Random random(3);
    double t = 0.0;
    for (const Pose2& pose : testing::toy_tour(0.1, 0.5, 0.8)) {
      t += 0.1;
      node.on_scan("scan", toy_message(pose, at(t), random), at(t));
    }
    return node.dynamic_map().value_or(OccupancyGrid{});
  }();
  return grid;
}

class Loopback : public ::testing::Test {
 protected:
  void SetUp() override {
    LocalizationNode::Setup setup;
    setup.node.mounting_from_tf = false;
    node = std::make_unique<LocalizationNode>(setup, finders, out);
    finders.add_parameters(node->parameters());
    ASSERT_TRUE(node->configure(at(0)).done);
    node->on_map(mapped_rooms(), at(0));
    node->activate();
    ASSERT_EQ(node->diagnostics().count(Trouble::kBadMap), 0U) << node->diagnostics().what(Trouble::kBadMap);
  }
  /// Drives on along the tour; wheels count 6 % too much and turn 4 % too little.
  void drive(std::size_t scans) {
    for (std::size_t i = 0; i < scans; ++i, ++k, t += 0.1) {
      const Pose2 step = tour[(k + tour.size() - 1) % tour.size()].inverse() * tour[k % tour.size()];
      wheels = wheels * Pose2{1.06 * step.x, step.y, 0.96 * step.theta};
      node->on_transforms(tf_message(at(t), "odom", "base_footprint", wheels), false, at(t));
      node->on_scan("scan", toy_message(truth(), at(t), random), at(t));
    }
    --k, t -= 0.1;  // at the last scan
  }
  Pose2 truth() const { return tour[k % tour.size()]; }
  /// Where transforms put the robot: what costmaps and planners see.
  std::optional<Pose2> seen() const {
    const auto odoms = out.of("odom");
    if (odoms.empty()) return std::nullopt;
    return pose_of(odoms.back()) * wheels;
  }
  double error_m() const { return seen() ? translation_distance(*seen(), truth()) : 1e9; }

  std::vector<Pose2> tour = testing::toy_tour(0.1, 0.5, 0.8);
  std::size_t k = 0;
  double t = 0.0;
  Pose2 wheels{3, -2, 1};
  LocalizerFinders finders;
  KeptOutputs out;
  std::unique_ptr<LocalizationNode> node;
  Random random{9};
};

TEST_F(Loopback, AnInitialPoseThenAPoseWithinAQuarterOfAMetre) {
  node->on_initial_pose(to_pose_message(at(0), "map", {0.3, -0.2, 0.15}, 0.25 * Eigen::Matrix3d::Identity()), at(0));
  drive(3);
  ASSERT_FALSE(out.poses.empty());
  EXPECT_LT(translation_distance(to_pose2(out.poses.back().pose.pose), truth()), 0.25);
}

TEST_F(Loopback, NoInitialPoseAndSpoiledOdometry) {
  drive(40);
  EXPECT_LT(error_m(), 0.15);
  k += 1;
  t += 0.1;
  int far = 0, scans = 0;
  for (; scans < 150; ++scans) {
    drive(1);
    far += error_m() > 0.25;
    ++k, t += 0.1;
  }
  EXPECT_EQ(far, 0) << "of " << scans;
}

}  // namespace
}  // namespace phasescan::ros2::localizer_finder_test
