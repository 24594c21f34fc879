#include "slam/input_check.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace phasescan::input_check_test {
namespace {

Scan scan_at(double seconds, float range = 2.0F, std::size_t beams = 100, std::size_t hits = 100) {
  std::vector<float> ranges(beams, 0.0F);
  for (std::size_t i = 0; i < hits; ++i) ranges[i] = range;
  Scan scan = make_scan(ranges, {0.0, 0.01, 0.0, 10.0});
  scan.stamp = stamp_from_seconds(seconds);
  return scan;
}

/// Counts by kind after two scans of one laser.
std::size_t count(const Scan& first, const Scan& second, const char* kind) {
  InputCheckState check;
  check_input(check, {first, "a"}, 0);
  check_input(check, {second, "a"}, 1);
  const auto found = check.oddities.find(kind);
  return found == check.oddities.end() ? 0 : found->second.count;
}

bool damaged(const InputCheckState& check) {
  return std::any_of(check.oddities.begin(), check.oddities.end(), [](const auto& o) { return o.second.damage; });
}

TEST(InputCheck, EachOddityOfTime) {
  const Scan now = scan_at(100.0);
  EXPECT_EQ(count(now, scan_at(100.2, 2.1F), "gap"), 0u);
  EXPECT_EQ(count(now, scan_at(400.0, 2.1F), "gap"), 1u);
  EXPECT_EQ(count(now, scan_at(99.9, 2.1F), "stamps out of order"), 1u);
  EXPECT_EQ(count(now, scan_at(50.0, 2.1F), "time going backwards"), 1u);
  EXPECT_EQ(count(now, scan_at(100.0, 2.1F), "same stamp"), 1u);
  EXPECT_EQ(count(now, scan_at(100.0), "same stamp"), 0u);  // the same scan once more is that, no more
  EXPECT_EQ(count(now, scan_at(100.0), "repeated scan"), 1u);
  EXPECT_EQ(count(now, scan_at(100.2), "repeated scan"), 0u);  // at rest without noise scans are alike
}

TEST(InputCheck, FewReturnsAndNone) {
  const Scan now = scan_at(1.0);
  EXPECT_EQ(count(now, scan_at(1.2, 2.0F, 100, 15), "few returns"), 1u);
  EXPECT_EQ(count(now, scan_at(1.2, 2.0F, 100, 40), "few returns"), 0u);
  EXPECT_EQ(count(now, scan_at(1.2, 2.0F, 100, 0), "few returns"), 0u);
  EXPECT_EQ(count(now, scan_at(1.2, 2.0F, 100, 0), "scan without a return"), 1u);
  EXPECT_EQ(count(now, scan_at(1.2, 2.0F, 50, 50), "beam count changes"), 1u);
}

TEST(InputCheck, OnlyBrokenInputIsDamage) {
  InputCheckState gaps;
  check_input(gaps, {scan_at(1.0), "a"}, 0);
  check_input(gaps, {scan_at(500.0), "a"}, 1);
  check_input(gaps, {scan_at(500.1), "b"}, 2);
  EXPECT_FALSE(damaged(gaps));
  EXPECT_EQ(gaps.oddities.at("several lasers").count, 1u);
  EXPECT_EQ(gaps.oddities.at("gap").first, 1);
  EXPECT_EQ(gaps.oddities.at("gap").what, "no scan for 499000 ms");
  InputCheckState jumps;
  check_input(jumps, {scan_at(1.0), "a", {}, Pose2{0, 0, 0}}, 0);
  const InputVerdict jump = check_input(jumps, {scan_at(1.2), "a", {}, Pose2{30, 0, 0}}, 1);
  EXPECT_TRUE(damaged(jumps));
  ASSERT_EQ(jump.notes.size(), 1u);
  EXPECT_EQ(jump.notes[0].kind, "odometry jump");
  // What a robot can drive while nothing is logged is no jump.
  InputCheckState pause;
  check_input(pause, {scan_at(1.0), "a", {}, Pose2{0, 0, 0}}, 0);
  check_input(pause, {scan_at(61.0), "a", {}, Pose2{30, 0, 0}}, 1);
  EXPECT_FALSE(damaged(pause));
}

TEST(InputCheck, RangesThatStayWhileTheWheelsMoveAreFrozen) {
  const auto frozen = [](const Pose2& moved, float range, double stamp) {
    InputCheckState state;
    check_input(state, {scan_at(1.0), "a", {}, Pose2{0, 0, 0}}, 0);
    check_input(state, {scan_at(stamp, range), "a", {}, moved}, 1);
    return state.oddities.contains("frozen scan");
  };
  EXPECT_TRUE(frozen({0.1, 0, 0}, 2.0F, 1.1));
  EXPECT_TRUE(frozen({0, 0, -0.05}, 2.0F, 1.1));
  EXPECT_FALSE(frozen({0, 0, 0}, 2.0F, 1.1)) << "a simulator without noise at a stand";
  EXPECT_FALSE(frozen({0.1, 0, 0}, 2.1F, 1.1));
  EXPECT_FALSE(frozen({0.1, 0, 0}, 2.0F, 1.0)) << "the same message twice is a repeated scan";
}

}  // namespace
}  // namespace phasescan::input_check_test
