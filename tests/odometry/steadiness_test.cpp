#include "odometry/steadiness.hpp"

#include <gtest/gtest.h>

namespace phasescan {
namespace {

TEST(Steadiness, ARobotThatGlidesDoesNotJump) {
  Steadiness s;
  s.set_period(0.2);
  EXPECT_FALSE(s.jumps());
  for (int i = 0; i < 200; ++i) s.add({0.02, 0.01, 0.05});
  EXPECT_FALSE(s.jumps());
  s.add({5.0, 0.0, 3.0});  // one wild answer
  EXPECT_FALSE(s.jumps());
}

TEST(Steadiness, ScansFarApartJumpByHabitOrByTime) {
  Steadiness habit;
  habit.set_period(0.2);
  for (int i = 0; i < 30; ++i) habit.add({i % 2 == 0 ? 0.5 : -0.4, 0.0, 0.0});
  EXPECT_TRUE(habit.jumps());
  EXPECT_GT(habit.change_m(), 0.3);
  for (int i = 0; i < 60; ++i) habit.add({0.01, 0.0, 0.0});
  EXPECT_FALSE(habit.jumps());
  Steadiness turns;
  for (int i = 0; i < 30; ++i) turns.add({0.0, 0.0, i % 2 == 0 ? 0.5 : -0.5});
  EXPECT_TRUE(turns.jumps());
  Steadiness time;
  time.set_period(1.0);
  EXPECT_TRUE(time.jumps());
  time.set_period(0.0);
  EXPECT_FALSE(time.jumps());
}

}  // namespace
}  // namespace phasescan
