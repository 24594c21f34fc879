// What stamps say of the time between scans, and when they say nothing.
#include "odometry/scan_clock.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace phasescan::scan_clock_test {
namespace {

Scan scan_at(double seconds, double time_increment = 0.0) {
  const std::vector<float> ranges(100, 1.0F);
  Scan scan = make_scan(ranges, {0.0, 0.01, 0.0, 8.0});
  scan.stamp = stamp_from_seconds(seconds);
  scan.time_increment = time_increment;
  return scan;
}

/// Scans every `period` seconds until `until`.
ScanClock steady(double period, double until) {
  ScanClock clock;
  for (double t = 0.0; t < until - 1e-9; t += period) clock.add(scan_at(t));
  return clock;
}

TEST(ScanClock, CountsThePeriodsThatPassed) {
  const ScanClock clock = steady(0.1, 3.0);
  EXPECT_NEAR(clock.period_s, 0.1, 1e-9);
  for (const auto& [after, periods] :
       {std::pair{0.1, 1.0}, {0.2, 2.0}, {0.3, 3.0}, {0.8, 8.0}, {1.9, 15.0}, {4.0, 15.0}, {8.0, 3.0}, {0.04, 1.0}}) {
    ScanClock next = clock;
    EXPECT_EQ(next.add(scan_at(2.9 + after)).periods, periods) << after;
  }
}

TEST(ScanClock, ThreeMissingScansAreLost) {
  const auto lost_s = [](double step) {
    ScanClock clock = steady(0.1, 3.0);
    return clock.add(scan_at(2.9 + step)).lost_s();
  };
  EXPECT_EQ(lost_s(0.1), 0.0);
  EXPECT_EQ(lost_s(0.3), 0.0) << "two in a row may be bad scans that were left out";
  EXPECT_NEAR(lost_s(0.4), 0.4, 1e-9);
  EXPECT_NEAR(lost_s(1.2), 1.2, 1e-9);
  EXPECT_EQ(lost_s(60.0), 0.0) << "a gap has rules of its own";
}

TEST(ScanClock, StampsThatComeInBurstsSayNothing) {
  ScanClock clock;
  double t = 0.0;
  for (int k = 0; k < 40; ++k) clock.add(scan_at(t += 0.02 + 0.03 * (k % 7)));
  EXPECT_GT(clock.jitter_s, 0.05);
  EXPECT_EQ(clock.add(scan_at(t + 0.3)).periods, 1.0);
}

TEST(ScanClock, SeveralScansAtATimeAreNoFastClock) {
  ScanClock clock;
  double t = 0.0;
  for (int k = 0; k < 60; ++k) clock.add(scan_at(t += k % 3 == 0 ? 0.6 : 0.002));
  const ScanTiming timing = clock.add(scan_at(t + 0.6));
  EXPECT_TRUE(timing.unsteady);
  EXPECT_EQ(timing.periods, 1.0) << "not three hundred steps of 2 ms";
  ScanClock lossy;
  for (int k = 0; k < 60; ++k) lossy.add(scan_at(t += k % 7 == 0 ? 0.5 : 0.1));
  EXPECT_FALSE(lossy.add(scan_at(t + 0.1)).unsteady) << "one in seven comes late: scans were lost";
}

TEST(ScanClock, InBurstsALongStepMayHaveLostScans) {
  ScanClock clock;
  double t = 0.0;
  for (int k = 0; k < 40; ++k) clock.add(scan_at(t += 0.02 + 0.03 * (k % 7)));
  const auto after = [&clock, t](double step) { return ScanClock(clock).add(scan_at(t + step)); };
  EXPECT_TRUE(after(0.2).unsteady);
  EXPECT_EQ(after(0.2).unsure_s, 0.0);
  EXPECT_NEAR(after(0.5).unsure_s, 0.5, 1e-9);
  EXPECT_EQ(after(0.5).lost_s(), 0.0) << "nobody knows";
  EXPECT_EQ(after(60.0).unsure_s, 0.0) << "a gap has rules of its own";
  ScanClock even = steady(0.1, 3.0);
  const ScanTiming timing = even.add(scan_at(3.5));
  EXPECT_FALSE(timing.unsteady);
  EXPECT_EQ(timing.unsure_s, 0.0);
}

TEST(ScanClock, AGapIsLongInSecondsAndInPeriods) {
  const auto gap_after = [](double period, double pause) {
    ScanClock clock = steady(period, 40.0 * period);
    const bool gap = clock.add(scan_at(39.0 * period + pause)).gap;
    EXPECT_EQ(clock.gaps, gap ? 1u : 0u);
    return gap;
  };
  EXPECT_TRUE(gap_after(0.1, 7.0));
  EXPECT_FALSE(gap_after(0.1, 4.0)) << "a burst of lost scans";

  EXPECT_FALSE(gap_after(0.5, 6.0)) << "a slow sensor that lost a few scans";
  EXPECT_TRUE(gap_after(0.5, 9.0));
}

TEST(ScanClock, StampsThatRepeatOrGoBackAreCountedAndNotLearned) {
  ScanClock clock = steady(0.1, 3.0);
  const ScanClock before = clock;
  EXPECT_FALSE(clock.add(scan_at(2.9)).gap);
  EXPECT_FALSE(clock.add(scan_at(1.0)).gap);
  EXPECT_EQ(clock.repeated, 1u);
  EXPECT_EQ(clock.backwards, 1u);
  EXPECT_EQ(clock.period_s, before.period_s);
}

TEST(ScanClock, ATurnThatLastsLongerThanItsPeriodIsAWrongHeader) {
  ScanClock clock = steady(0.1, 3.0);
  EXPECT_NEAR(clock.add(scan_at(3.0, 0.001)).duration_s, 0.099, 1e-9);
  EXPECT_NEAR(clock.add(scan_at(3.1, -0.001)).duration_s, 0.099, 1e-9) << "beams listed last to first";
  EXPECT_EQ(clock.add(scan_at(3.2, 0.002)).duration_s, 0.0);
  EXPECT_EQ(clock.add(scan_at(3.3)).duration_s, 0.0);
  ScanClock first;
  EXPECT_NEAR(first.add(scan_at(0.0, 0.002)).duration_s, 0.198, 1e-9) << "no period is known yet";
  EXPECT_EQ(ScanClock{}.add(scan_at(0.0, 0.1)).duration_s, 0.0) << "no lidar turns so slowly";
}

}  // namespace
}  // namespace phasescan::scan_clock_test
