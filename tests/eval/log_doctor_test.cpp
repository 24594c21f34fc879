// The doctor finds what was put into a log, and nothing in a healthy one.
#include "eval/log_doctor.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "support/rooms.hpp"

namespace phasescan::log_doctor_test {
namespace {

constexpr int kScans = 60;

/// A robot that circles in the room, with wheel odometry; `change` spoils each entry.
std::vector<Finding> examine(const std::function<void(int, LogEntry&)>& change, double turn = 0.12,
                             const std::map<std::string, std::string>& facts = {}) {
  LogDoctor doctor;
  Pose2 pose{0.3, -0.2, 0.0};
  for (int k = 0; k < kScans; ++k) {
    LogEntry entry;
    entry.scan = test::cast_room(pose, 240, 0.005, 0.0, static_cast<std::uint64_t>(k) + 1);
    entry.scan.stamp = k * Stamp{200'000'000};
    entry.odometry = pose;
    entry.laser = "/scan";
    change(k, entry);
    doctor.add(entry);
    pose = pose * Pose2{0.05, 0.0, turn};
  }
  return doctor.findings(facts);
}

std::vector<std::string> kinds(const std::vector<Finding>& findings) {
  std::vector<std::string> out;
  for (const Finding& finding : findings) {
    EXPECT_FALSE(finding.seen.empty() || finding.meaning.empty() || finding.advice.empty()) << finding.kind;
    out.push_back(finding.kind);
  }
  return out;
}

using testing::Contains;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::Not;

TEST(LogDoctor, FindsNothingInAHealthyLog) {
  EXPECT_THAT(kinds(examine([](int, LogEntry&) {})), IsEmpty());
}

TEST(LogDoctor, FindsAMirroredSensorByItsTurns) {
  const auto mirror = [](int, LogEntry& entry) { entry.scan = mirrored_scan(entry.scan); };
  EXPECT_THAT(kinds(examine(mirror)), ElementsAre("mirrored sensor"));
  // A log that says that the laser is upside down is right.
  const auto said = [&](int k, LogEntry& entry) {
    mirror(k, entry);
    entry.flipped = true;
  };
  EXPECT_THAT(kinds(examine(said)), IsEmpty());
}

TEST(LogDoctor, FindsALaserThatLooksToTheRear) {
  const auto backwards = [](int, LogEntry& entry) { entry.scan.geometry.angle_min += kPi; };
  EXPECT_THAT(kinds(examine(backwards, 0.0)), Contains("mounted backwards"));
}

TEST(LogDoctor, FindsOdometryThatDisagrees) {
  const auto slip = [](int k, LogEntry& entry) { entry.odometry = Pose2{0.11 * k, 0.0, 0.0}; };
  EXPECT_THAT(kinds(examine(slip)), Contains("odometry disagrees"));
}

TEST(LogDoctor, FindsBadStampsBurstsAndGaps) {
  EXPECT_THAT(kinds(examine([](int k, LogEntry& e) { e.scan.stamp -= k == 9 ? Stamp{500'000'000} : 0; })),
              Contains("stamps backwards"));
  EXPECT_THAT(kinds(examine([](int k, LogEntry& e) { e.scan.stamp -= k % 5 == 4 ? Stamp{190'000'000} : 0; })),
              Contains("stamps in bursts"));
  EXPECT_THAT(kinds(examine([](int k, LogEntry& e) { e.scan.stamp += k > 30 ? Stamp{5'000'000'000} : 0; })),
              ElementsAre("gaps"));
  EXPECT_THAT(kinds(examine([](int k, LogEntry& e) { e.scan.stamp -= k == 7 ? Stamp{200'000'000} : 0; })),
              Contains("stamps repeated"));
}

TEST(LogDoctor, FindsWhatIsWrongInTheScans) {
  const auto vary = [](int k, LogEntry& e) {
    if (k % 2 == 0) e.scan = reduce_scan(e.scan, 0.0, 2);
  };
  EXPECT_THAT(kinds(examine(vary)), Contains("beams vary"));
  EXPECT_THAT(kinds(examine([](int, LogEntry& e) { e.scan.geometry.range_max = 0.0; })),
              ElementsAre("range_max unknown"));
  EXPECT_THAT(kinds(examine([](int, LogEntry& e) { e.scan = reduce_scan(e.scan, 1.5, 1); })),
              Contains("beams missing"));
  EXPECT_THAT(kinds(examine([](int, LogEntry& e) { e.scan.time_increment = 0.01; })),
              Contains("time_increment absurd"));
  std::optional<Scan> before;
  const auto twice = [&before](int k, LogEntry& e) {
    const Stamp stamp = e.scan.stamp;
    if (k == 20) e.scan = *before;
    before = e.scan;
    e.scan.stamp = stamp;
  };
  EXPECT_THAT(kinds(examine(twice)), Contains("scans doubled"));
  const auto blind = [](int, LogEntry& e) {
    for (std::size_t i = 100; i < 140; ++i) {
      e.scan.states[i] = BeamState::kNoReturn;
      e.scan.ranges[i] = std::numeric_limits<float>::quiet_NaN();
    }
  };
  EXPECT_THAT(kinds(examine(blind)), ElementsAre("blind sector"));
}

TEST(LogDoctor, FindsARobotTooFastForItsSensor) {
  EXPECT_THAT(kinds(examine([](int, LogEntry& e) { e.odometry.reset(); }, 0.5)), Contains("too fast for its rate"));
  EXPECT_THAT(kinds(examine([](int, LogEntry& e) { e.odometry.reset(); })), Not(Contains("too fast for its rate")));
}

TEST(LogDoctor, ASimulatedLaserAtRestIsNoRecorderThatRepeats) {
  std::optional<Scan> first;
  const auto at_rest = [&first](int k, LogEntry& e) {
    if (!first) first = e.scan;
    const Stamp stamp = e.scan.stamp;
    if (k < 20) {
      e.scan = *first;
      e.odometry = Pose2{0.3, -0.2, 0.0};
    }
    e.scan.stamp = stamp;
  };
  EXPECT_THAT(kinds(examine(at_rest)), Not(Contains("scans doubled")));
}

TEST(LogDoctor, ATurnThatWasLostMakesNoTimeIncrementAbsurd) {
  const auto lost = [](int k, LogEntry& e) { e.scan.time_increment = (k == 9 ? 2.0 : 1.0) * 0.19 / 240.0; };
  EXPECT_THAT(kinds(examine(lost)), Not(Contains("time_increment absurd")));
  EXPECT_THAT(kinds(examine([](int, LogEntry& e) { e.scan.time_increment = 0.19 / 240.0 / 50.0; })),
              Contains("time_increment too small"));
}

TEST(LogDoctor, SaysWhatTheReaderRemarked) {
  LogDoctor doctor;
  const auto findings = doctor.findings({}, {{"several frames", "/scan has .."}, {"no scans", ".."}, {"other", ".."}});
  EXPECT_THAT(kinds(findings), ElementsAre("several frames", "other"));
}

TEST(LogDoctor, HearsFromTheReaderWhatItReadAsUnknown) {
  EXPECT_THAT(kinds(examine([](int, LogEntry&) {}, 0.12, {{"time_increment absurd", "3 scans"}})),
              ElementsAre("time_increment absurd"));
}

}  // namespace
}  // namespace phasescan::log_doctor_test
