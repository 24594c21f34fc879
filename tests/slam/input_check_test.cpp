#include "slam/input_check.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace phasescan {
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
  InputCheck check;
  check.add(first, "a", std::nullopt, "f:1");
  check.add(second, "a", std::nullopt, "f:2");
  const auto found = check.oddities().find(kind);
  return found == check.oddities().end() ? 0 : found->second.count;
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
  InputCheck gaps;
  gaps.add(scan_at(1.0), "a", std::nullopt, "f:1");
  gaps.add(scan_at(500.0), "a", std::nullopt, "f:2");
  gaps.add(scan_at(500.1), "b", std::nullopt, "f:3");
  EXPECT_FALSE(gaps.damaged());
  EXPECT_EQ(gaps.oddities().at("several lasers").count, 1u);
  EXPECT_EQ(gaps.oddities().at("gap").first, "f:2: no scan for 499000 ms");
  InputCheck jumps;
  jumps.add(scan_at(1.0), "a", Pose2{0, 0, 0}, "f:1");
  jumps.add(scan_at(1.2), "a", Pose2{30, 0, 0}, "f:2");
  EXPECT_TRUE(jumps.damaged());
  // What a robot can drive while nothing is logged is no jump.
  InputCheck pause;
  pause.add(scan_at(1.0), "a", Pose2{0, 0, 0}, "f:1");
  pause.add(scan_at(61.0), "a", Pose2{30, 0, 0}, "f:2");
  EXPECT_FALSE(pause.damaged());
}

}  // namespace
}  // namespace phasescan
