#include "phasescan/io/log.hpp"

#include <gtest/gtest.h>

namespace phasescan::measurement_test {
namespace {

TEST(Measurement, ALaserUpsideDownIsMirroredAndTheOthersAreLeftAlone) {
  LogEntry entry;
  entry.scan = make_scan(std::vector<float>{1.0F, 2.0F, 0.0F}, {0.5, 0.1, 0.1, 8.0});
  entry.laser = "/scan";
  entry.T_base_laser = {0.2, 0.1, 0.3};
  entry.odometry = Pose2{1.0, 2.0, 0.5};
  const RangeMeasurement upright = to_measurement(entry);
  EXPECT_EQ(upright.scan.angle(1), 0.6);
  entry.flipped = true;
  const RangeMeasurement mirrored = to_measurement(entry);
  EXPECT_EQ(mirrored.scan.angle(1), -0.6);
  EXPECT_EQ(mirrored.scan.ranges[1], 2.0F);
  EXPECT_EQ(mirrored.laser, "/scan");
  EXPECT_EQ(mirrored.T_base_laser, entry.T_base_laser);
  EXPECT_EQ(mirrored.T_odom_base, entry.odometry);
}

}  // namespace
}  // namespace phasescan::measurement_test
