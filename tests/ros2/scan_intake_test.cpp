// Scans that wait for transforms, and everything that can be wrong with them.
#include "ros2/scan_intake.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "ros2/node_support.hpp"

namespace phasescan::ros2::scan_intake_test {
namespace {

class Intake : public ::testing::Test {
 protected:
  void mount(const std::string& laser = "laser", const Pose2& pose = {0.2, 0, 0}) {
    intake.add_transforms(tf_message(0, "base_footprint", laser, pose), true, now);
  }
  void odometry(double t, const Pose2& pose = {}) {
    intake.add_transforms(tf_message(at(t), "odom", "base_footprint", pose), false, now);
  }
  LaserScan message(double t, const std::string& frame = "laser") { return toy_message({}, at(t), random, frame); }
  std::vector<ReadyScan> scan(double t, const std::string& topic = "scan", const std::string& frame = "laser") {
    now = at(t);
    intake.add_scan(topic, message(t, frame), now);
    return intake.take_ready(now);
  }
  std::uint64_t count(Trouble trouble) const { return told.count(trouble); }
  void with(OdometrySource source) {
    IntakeOptions options;
    options.odometry = source;
    intake.set_options(options);
  }

  Random random{1};
  Diagnostics told{"node"};
  ScanIntake intake{{}, told};
  Stamp now = 0;
};

TEST_F(Intake, WithoutOdometryScansGoOnAfterAFewWereWaitedFor) {
  mount();
  std::size_t ready = 0;
  for (int i = 0; i < 10; ++i) ready += scan(0.1 * i).size();
  EXPECT_EQ(ready, 10U);
  EXPECT_FALSE(intake.has_odometry());
  EXPECT_TRUE(intake.odometry_decided());
}

TEST_F(Intake, OdometryIsInterpolatedAtTheStamp) {
  mount();
  odometry(0.0, {1.0, 0, 0});
  odometry(0.2, {2.0, 0, 0.2});
  const std::vector<ReadyScan> ready = scan(0.05);
  ASSERT_EQ(ready.size(), 1U);
  ASSERT_TRUE(ready[0].measurement.T_odom_base);
  EXPECT_NEAR(ready[0].measurement.T_odom_base->x, 1.25, 1e-9);
  EXPECT_NEAR(ready[0].measurement.T_odom_base->theta, 0.05, 1e-9);
  EXPECT_NEAR(ready[0].measurement.T_base_laser.x, 0.2, 1e-12);
}

TEST_F(Intake, TheOrderInWhichMessagesComeDoesNotMatter) {
  // The same messages, transforms 0, 3 or 7 messages late: the same measurements.
  std::vector<std::vector<ReadyScan>> runs;
  for (const int late : {0, 3, 7}) {
    Random noise(5);
    Diagnostics diagnostics("node");
    ScanIntake run({}, diagnostics);
    run.add_transforms(tf_message(0, "base_footprint", "laser", {0.2, 0, 0}), true, 0);
    run.add_transforms(tf_message(at(-0.05), "odom", "base_footprint", {}), false, 0);
    runs.emplace_back();
    for (int i = 0; i < 40 + late; ++i) {
      if (i < 40) run.add_scan("scan", toy_message({}, at(0.1 * i), noise), at(0.1 * i));
      if (i >= late)
        run.add_transforms(tf_message(at(0.1 * (i - late) + 0.05), "odom", "base_footprint", {0.1 * (i - late), 0, 0}),
                           false, 0);
      for (ReadyScan& ready : run.take_ready(at(0.1 * i))) runs.back().push_back(std::move(ready));
    }
  }
  ASSERT_EQ(runs[0].size(), 40U);
  for (const auto& run : runs) {
    ASSERT_EQ(run.size(), 40U);
    for (std::size_t i = 0; i < run.size(); ++i) {
      EXPECT_EQ(run[i].measurement.scan.stamp, runs[0][i].measurement.scan.stamp);
      EXPECT_EQ(run[i].measurement.T_odom_base, runs[0][i].measurement.T_odom_base);
    }
  }
}

TEST_F(Intake, ScansBeforeTransformsWaitAndAreTold) {
  for (int i = 0; i < 5; ++i) EXPECT_TRUE(scan(0.1 * i).empty());
  EXPECT_GT(count(Trouble::kScanBeforeTransform), 0U);
  mount();
  std::size_t ready = intake.take_ready(now).size();
  for (int i = 5; i < 10; ++i) ready += scan(0.1 * i).size();
  EXPECT_EQ(ready, 10U);  // none of them is lost
  EXPECT_EQ(count(Trouble::kQueueFull), 0U);
}

TEST_F(Intake, WithoutAnyTransformTheOldestAreLeftOutAndCounted) {
  for (int i = 0; i < 50; ++i) EXPECT_TRUE(scan(0.1 * i).empty());
  EXPECT_EQ(intake.waiting(), ScanIntake::kDepth);
  EXPECT_EQ(count(Trouble::kQueueFull), 50U - ScanIntake::kDepth);
  IntakeOptions options;
  options.mounting_from_tf = false;
  options.odometry = OdometrySource::kNone;
  intake.set_options(options);
  EXPECT_EQ(intake.take_ready(now).size(), ScanIntake::kDepth);
}

TEST_F(Intake, AGapInOdometryDelaysAndIsTold) {
  mount();
  for (double t = -0.1; t < 1.0; t += 0.05) odometry(t);
  std::size_t ready = 0;
  for (int i = 0; i < 10; ++i) ready += scan(0.1 * i).size();
  EXPECT_GE(ready, 9U);
  for (int i = 10; i < 40; ++i) {
    for (const ReadyScan& one : scan(0.1 * i)) {
      ++ready;
      EXPECT_TRUE(one.measurement.scan.stamp <= at(1.0) || !one.measurement.T_odom_base);
    }
  }
  EXPECT_GT(count(Trouble::kTransformGap), 0U);
  EXPECT_LE(intake.waiting(), ScanIntake::kDepth);
  for (double t = 4.0; t < 5.0; t += 0.05) odometry(t);
  ready += intake.take_ready(now).size();
  const auto after = scan(4.5);
  ASSERT_FALSE(after.empty());
  EXPECT_TRUE(after.back().measurement.T_odom_base);
}

TEST_F(Intake, ALoopedBagBeginsANewSession) {
  mount();
  for (double t = -0.1; t < 20.0; t += 0.05) odometry(t);
  for (int i = 0; i < 190; ++i) scan(0.1 * i);
  // From the beginning again; a transform of then comes first.
  odometry(-0.1);
  odometry(0.3);
  const std::vector<ReadyScan> again = scan(0.0);
  ASSERT_EQ(again.size(), 1U);
  EXPECT_TRUE(again[0].new_session);
  EXPECT_TRUE(again[0].measurement.T_odom_base);
  EXPECT_EQ(count(Trouble::kClockJumpedBack), 1U);
  EXPECT_FALSE(scan(0.1).at(0).new_session);
}

TEST_F(Intake, TwoDriversOnATopicAreTold) {
  mount();
  mount("other");
  with(OdometrySource::kNone);
  for (int i = 0; i < 10; ++i) scan(0.1 * i, "scan", i % 2 == 0 ? "laser" : "other");
  EXPECT_EQ(count(Trouble::kTwoPublishers), 9U);
  // Of one frame, with stamps that go to and fro.
  scan(1.0);
  EXPECT_TRUE(scan(0.95).empty());
  EXPECT_EQ(count(Trouble::kOutOfOrder), 1U);
}

TEST_F(Intake, TwoLasersComeInTheOrderOfTheirStamps) {
  mount("front", {0.2, 0, 0});
  mount("back", {-0.2, 0, kPi});
  with(OdometrySource::kNone);
  std::vector<ReadyScan> all;
  const auto take = [&](std::vector<ReadyScan> more) {
    for (ReadyScan& one : more) all.push_back(std::move(one));
  };
  for (int i = 0; i < 20; ++i) {
    // What the laser in front saw comes after what the other saw 50 ms later.
    take(scan(0.1 * i + 0.05, "scan_back", "back"));
    take(scan(0.1 * i, "scan_front", "front"));
  }
  ASSERT_GE(all.size(), 37U);
  for (std::size_t i = 1; i < all.size(); ++i)
    EXPECT_GE(all[i].measurement.scan.stamp, all[i - 1].measurement.scan.stamp) << i;
  EXPECT_NE(all[4].measurement.laser, all[5].measurement.laser);
  // One of them falls silent: the other goes on.
  std::size_t alone = 0;
  for (int i = 20; i < 60; ++i) alone += scan(0.1 * i, "scan_front", "front").size();
  EXPECT_GE(alone, 37U);
}

TEST_F(Intake, AnUpsideDownLaserIsMirrored) {
  with(OdometrySource::kNone);
  TransformStamped upside = to_transform(0, "base_footprint", "laser", {0.1, 0.05, 0});
  upside.transform.rotation = {1, 0, 0, 0};  // rolled by half a turn
  intake.add_transforms({{upside}}, true, now);
  const Pose2 T_world_base{1.0, 0.3, 0.4};
  const Pose2 T_world_laser = T_world_base * Pose2{0.1, 0.05, 0};
  testing::ToyLidar lidar;
  lidar.noise = 0.0;
  const Scan hung = testing::toy_scan(testing::two_rooms(), T_world_laser, lidar, random, at(0.0), {}, true);
  intake.add_scan("scan", ros::from_scan(hung, "laser", 0.1), now);
  const std::vector<ReadyScan> ready = intake.take_ready(now);
  ASSERT_EQ(ready.size(), 1U);
  const RangeMeasurement& got = ready[0].measurement;
  // Each beam, by way of its mounting, ends where a ray from there ends.
  for (std::size_t i = 0; i < got.scan.size(); i += 7) {
    if (!got.scan.is_hit(i)) continue;
    const Pose2 from = T_world_base * got.T_base_laser;
    EXPECT_NEAR(got.scan.ranges[i],
                testing::toy_range(testing::two_rooms(), from.translation(), from.theta + got.scan.angle(i)), 1e-3);
  }
}

TEST_F(Intake, AMountingThatMovesIsReadAtEachStamp) {
  with(OdometrySource::kNone);
  for (int i = 0; i <= 10; ++i)
    intake.add_transforms(tf_message(at(0.1 * i), "base_footprint", "laser", {0, 0, 0.1 * i}), false, now);
  const auto ready = scan(0.55);
  ASSERT_EQ(ready.size(), 1U);
  EXPECT_NEAR(ready[0].measurement.T_base_laser.theta, 0.55, 1e-6);
}

TEST_F(Intake, ATiltedLaserIsTold) {
  with(OdometrySource::kNone);
  TransformStamped tilted = to_transform(0, "base_footprint", "laser", {});
  tilted.transform.rotation = {0, std::sin(0.2), 0, std::cos(0.2)};
  intake.add_transforms({{tilted}}, true, now);
  scan(0.0);
  EXPECT_EQ(count(Trouble::kTiltedLaser), 1U);
}

TEST_F(Intake, OwnTransformsAreNotOdometry) {
  mount();
  for (int i = 0; i < 20; ++i) {
    const std::size_t ready = scan(0.1 * i).size();
    if (i < 5) continue;
    ASSERT_EQ(ready, 1U);
    intake.note_own_odometry(at(0.1 * i), {0.01 * i, 0, 0});
    odometry(0.1 * i, {0.01 * i, 0, 0});  // comes back by way of /tf
  }
  EXPECT_FALSE(intake.has_odometry());
  EXPECT_EQ(count(Trouble::kOdometryConflict), 0U);
  odometry(1.96, {3.0, 0, 0});
  odometry(2.2, {3.1, 0, 0});
  EXPECT_EQ(count(Trouble::kOdometryConflict), 2U);
  EXPECT_EQ(scan(2.0).size(), 1U);
  EXPECT_TRUE(intake.has_odometry());
}

TEST_F(Intake, OdometryOfATopic) {
  mount();
  with(OdometrySource::kTopic);
  for (int i = 0; i < 5; ++i) {
    Odometry message;
    message.header = {at(0.1 * i), "anything"};
    message.pose.pose = to_pose({0.5 * i, 0, 0});
    intake.add_odometry(message, now);
  }
  const auto ready = scan(0.25);
  ASSERT_EQ(ready.size(), 1U);
  EXPECT_NEAR(ready[0].measurement.T_odom_base->x, 1.25, 1e-9);
}

TEST_F(Intake, MessagesThatAreNoScans) {
  mount();
  with(OdometrySource::kNone);
  LaserScan scan = message(0.0);
  const auto put = [&](const LaserScan& bad) {
    intake.add_scan("scan", bad, now);
    return intake.take_ready(now).size();
  };
  LaserScan bad = scan;
  bad.ranges.clear();
  EXPECT_EQ(put(bad), 0U);
  EXPECT_EQ(count(Trouble::kNoBeams), 1U);
  bad = scan;
  bad.header.frame_id.clear();
  EXPECT_EQ(put(bad), 0U);
  bad = scan;
  bad.angle_increment = bad.angle_max = bad.angle_min = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(put(bad), 0U);
  EXPECT_EQ(count(Trouble::kBadScan), 2U);
  bad = scan;
  std::fill(bad.ranges.begin(), bad.ranges.end(), std::numeric_limits<float>::quiet_NaN());
  EXPECT_EQ(put(bad), 1U);  // it says that nothing is there
  EXPECT_EQ(count(Trouble::kNoReturns), 1U);
  bad = message(0.1);
  bad.ranges.resize(100);
  EXPECT_EQ(put(bad), 1U);
  EXPECT_EQ(count(Trouble::kBeamsChanged), 1U);
  bad = message(0.2);
  bad.header.stamp = 0;  // a driver without a clock
  now = at(0.3);
  EXPECT_EQ(put(bad), 1U);
}

TEST_F(Intake, LimitsAndThrottle) {
  mount();
  IntakeOptions options;
  options.odometry = OdometrySource::kNone;
  options.range_max_m = 4.0;
  options.range_min_m = 2.6;
  options.every = 3;
  intake.set_options(options);
  std::vector<ReadyScan> all;
  for (int i = 0; i < 9; ++i) {
    for (ReadyScan& one : scan(0.1 * i)) all.push_back(std::move(one));
  }
  ASSERT_EQ(all.size(), 3U);
  EXPECT_EQ(all[1].measurement.scan.stamp, at(0.3));
  int hits = 0;
  for (std::size_t i = 0; i < all[0].measurement.scan.size(); ++i) {
    if (!all[0].measurement.scan.is_hit(i)) continue;
    ++hits;
    EXPECT_GE(all[0].measurement.scan.ranges[i], 2.6F);
    EXPECT_LE(all[0].measurement.scan.ranges[i], 4.0F);
  }
  EXPECT_GT(hits, 10);
}

TEST_F(Intake, BadTransformsAreTold) {
  TFMessage bad = tf_message(0, "base_footprint", "laser", {std::nan(""), 0, 0});
  intake.add_transforms(bad, true, now);
  EXPECT_EQ(count(Trouble::kBadTransform), 1U);
}

TEST(DiagnosticsTest, TheWorstOfTheLastSecondsCountsAndAllAreListed) {
  Diagnostics told("slam");
  EXPECT_EQ(told.report(at(0), "ok", {}).status.at(0).level, DiagnosticStatus::kOk);
  told.note(Trouble::kBeamsChanged, at(1), "100 beams");
  told.note(Trouble::kTransformGap, at(1), "a gap");
  told.note(Trouble::kNoBeams, at(2), "none");
  DiagnosticStatus status = told.report(at(3), "ok", {{"scans", "5"}}).status.at(0);
  EXPECT_EQ(status.level, DiagnosticStatus::kError);
  EXPECT_EQ(status.message, "no_beams: none");
  EXPECT_EQ(status.name, "slam: phasescan");
  EXPECT_EQ(status.values.size(), 4U);
  status = told.report(at(60), "ok", {}).status.at(0);
  EXPECT_EQ(status.level, DiagnosticStatus::kOk);
  EXPECT_EQ(status.message, "ok");
  EXPECT_EQ(status.values.size(), 3U);
  // After the clock was set back, what lies in its future is not recent for ever.
  told.clock_jumped(at(-1000));
  EXPECT_FALSE(told.is_recent(Trouble::kNoBeams, at(-900)));
}

}  // namespace
}  // namespace phasescan::ros2::scan_intake_test
