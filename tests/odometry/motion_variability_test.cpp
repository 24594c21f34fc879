#include "odometry/motion_variability.hpp"

#include <gtest/gtest.h>

namespace phasescan::motion_variability_test {
namespace {

TEST(MotionVariability, SmallStepsAreDense) {
  MotionVariability s;
  s.set_period(0.2);
  EXPECT_FALSE(s.is_sparse());
  for (int i = 0; i < 200; ++i) s.add({0.02, 0.01, 0.05});
  EXPECT_FALSE(s.is_sparse());
  s.add({5.0, 0.0, 3.0});  // one wild answer
  EXPECT_FALSE(s.is_sparse());
}

TEST(MotionVariability, ScansFarApartAreSparseByWhatWasSeenOrByTime) {
  MotionVariability habit;
  habit.set_period(0.2);
  for (int i = 0; i < 30; ++i) habit.add({i % 2 == 0 ? 0.5 : -0.4, 0.0, 0.0});
  EXPECT_TRUE(habit.is_sparse());
  EXPECT_GT(habit.change_m(), 0.3);
  for (int i = 0; i < 60; ++i) habit.add({0.01, 0.0, 0.0});
  EXPECT_FALSE(habit.is_sparse());
  MotionVariability turns;
  for (int i = 0; i < 30; ++i) turns.add({0.0, 0.0, i % 2 == 0 ? 0.5 : -0.5});
  EXPECT_TRUE(turns.is_sparse());
  MotionVariability time;
  time.set_period(1.0);
  EXPECT_TRUE(time.is_sparse());
  time.set_period(0.0);
  EXPECT_FALSE(time.is_sparse());
}

}  // namespace
}  // namespace phasescan::motion_variability_test
