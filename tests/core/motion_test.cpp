#include "core/motion.hpp"

#include <gtest/gtest.h>

namespace phasescan::motion_test {
namespace {

TEST(Motion, HalfAMotionTwiceIsTheMotion) {
  const Pose2 motion{0.4, -0.1, 1.2}, half = scale_motion(motion, 0.5), both = half * half;
  EXPECT_NEAR(both.x, motion.x, 1e-12);
  EXPECT_NEAR(both.y, motion.y, 1e-12);
  EXPECT_NEAR(both.theta, motion.theta, 1e-12);
  EXPECT_NEAR(scale_motion(motion, -1.0).x, motion.inverse().x, 1e-12);
}

TEST(Motion, TheMeanTwistTakesThatLong) {
  const Pose2 motion{0.4, -0.1, 1.2}, again = exp_twist(mean_twist(motion, 0.3), 0.3);
  EXPECT_NEAR(translation_distance(again, motion), 0.0, 1e-12);
  EXPECT_NEAR(again.theta, motion.theta, 1e-12);
}

TEST(Motion, AFrameOnTheBaseGoesWhereItsTwistSays) {
  const Pose2 T_base_frame{0.3, -0.2, 2.0};
  const Twist2 base{0.5, 0.1, -0.7};
  const Pose2 by_base = T_base_frame.inverse() * exp_twist(base, 0.4) * T_base_frame;
  const Pose2 by_frame = exp_twist(twist_of_frame(T_base_frame, base), 0.4);
  EXPECT_NEAR(translation_distance(by_base, by_frame), 0.0, 1e-12);
  EXPECT_NEAR(by_base.theta, by_frame.theta, 1e-12);
}

}  // namespace
}  // namespace phasescan::motion_test
