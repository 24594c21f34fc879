// A tracker made from a state goes on with the same bytes as one that never stopped.
#include <gtest/gtest.h>

#include <cstring>
#include <string>
#include <vector>

#include "odometry/tracker.hpp"
#include "support/state_bytes.hpp"
#include "support/toy_logs.hpp"

namespace phasescan::checkpoint_test {
namespace {

using testing::from_bytes;
using testing::to_bytes;

std::string bytes_of(const TrackerStep& step) {
  StateWriter out;
  out.write(step.stamp), out.write(step.status), out.write(step.T_odom_mid), out.write(step.T_odom_stamp);
  out.write(step.covariance), out.write(step.information), out.write(step.twist), out.write(step.keyframe);
  const TrackingDiagnostics& d = step.diagnostics;
  out.write(d.overlap), out.write(d.residual_m), out.write(d.wide_search), out.write(d.full_search);
  out.write(d.new_segment), out.write(d.wheels);
  out.write(step.keyframes);
  return out.bytes;
}

TEST(Checkpoint, AfterAnyScanAResumedTrackerGoesOnWithTheSameBytes) {
  constexpr std::size_t kScans = 150, kAhead = 4, kToTheEnd = 40;
  for (const testing::ToyLog& log : testing::toy_logs(kScans)) {
    std::vector<std::string> states, steps;
    Tracker whole;
    for (const RangeMeasurement& m : log.measurements) {
      steps.push_back(bytes_of(whole.add(m)));
      states.push_back(to_bytes(whole.state()));
    }
    for (std::size_t k = 0; k + 1 < steps.size(); ++k) {
      // By its bytes: what `visit` does not name is not there.
      Tracker resumed({}, from_bytes<OdometryState>(states[k]));
      const std::size_t last = k % kToTheEnd == 0 ? steps.size() : std::min(steps.size(), k + 1 + kAhead);
      for (std::size_t i = k + 1; i < last; ++i) {
        ASSERT_TRUE(bytes_of(resumed.add(log.measurements[i])) == steps[i])
            << log.name << ": resumed after scan " << k << ", scan " << i << " differs";
        ASSERT_TRUE(to_bytes(resumed.state()) == states[i]) << log.name << " " << k << " " << i;
      }
    }
  }
}

TEST(Checkpoint, ACopyOfTheStateIsNotChangedByGoingOn) {
  const testing::ToyLog log = testing::turning_lidar_log(40);
  Tracker tracker;
  for (std::size_t i = 0; i < 20; ++i) tracker.add(log.measurements[i]);
  const OdometryState copy = tracker.state();
  const std::string before = to_bytes(copy);
  for (std::size_t i = 20; i < 40; ++i) tracker.add(log.measurements[i]);
  EXPECT_TRUE(to_bytes(copy) == before);
}

TEST(Checkpoint, TheHeadingOfAKeyframeIsNeverSurerThanThatOfTheOneBefore) {
  for (const testing::ToyLog& log : testing::toy_logs(200)) {
    Tracker tracker;
    double before = 0.0;
    for (const RangeMeasurement& m : log.measurements) {
      tracker.add(m);
      const double now = tracker.state().keyframe_covariance(2, 2);
      EXPECT_GE(now, before) << log.name;
      before = now;
    }
    EXPECT_GT(before, 0.0);
  }
}

TEST(Checkpoint, TheFirstKeyframeIsPartOfTheState) {
  // Handed out with the second scan, deskewed by it, by whichever tracker sees that.
  const testing::ToyLog log = testing::turning_lidar_log(3);
  Tracker tracker;
  const TrackerStep first = tracker.add(log.measurements[0]);
  EXPECT_TRUE(first.keyframe);
  EXPECT_TRUE(first.keyframes.empty());
  Tracker resumed({}, tracker.state());
  const TrackerStep second = resumed.add(log.measurements[1]);
  ASSERT_FALSE(second.keyframes.empty());
  EXPECT_EQ(second.keyframes.front().scan, 0);
  EXPECT_TRUE(resumed.finish().empty());
  // Where no second scan comes it is handed out in the end, once.
  EXPECT_EQ(tracker.finish().size(), 1u);
  EXPECT_TRUE(tracker.finish().empty());
}

}  // namespace
}  // namespace phasescan::checkpoint_test
