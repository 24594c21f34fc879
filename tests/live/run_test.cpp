// A run in its threads: who is slow pays for it alone, tasks run between scans, a new drive finds its place.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <thread>

#include "live/clocks.hpp"
#include "phasescan/live/live.hpp"
#include "support/toy_world.hpp"

namespace phasescan::live::run_test {
namespace {

using namespace phasescan::testing;

/// Scans as fast as they are taken.
class Scans final : public LiveSource {
 public:
  Scans(std::size_t count, bool waits) : count_(count), waits_(waits) {}
  void run(const std::function<bool()>& stop, const std::function<void(LiveScan)>& hand,
           const std::function<void(const std::string&)>&) override {
    for (std::size_t i = 0; i < count_ && !stop(); ++i) {
      RangeMeasurement measurement;
      measurement.scan = make_scan(std::vector<float>(8, 1.0F), {0.0, 0.1, 0.0, 0.0});
      measurement.scan.stamp = static_cast<Stamp>(i) * 100'000'000;
      hand({measurement, steady_ns(), i == count_ / 2 && restarts});
    }
  }
  bool can_wait() const override { return waits_; }
  bool restarts = false;

 private:
  std::size_t count_;
  bool waits_;
};

/// Answers at once, or after a while.
class Clerk final : public LiveEngine {
 public:
  LiveUpdate add(std::shared_ptr<const RangeMeasurement> measurement) override {
    if (tracking.exchange(true)) overlapped = true;
    std::this_thread::sleep_for(pause);
    LiveUpdate update;
    update.update.stamp = measurement->scan.stamp;
    update.measurement = std::move(measurement);
    tracking = false;
    return update;
  }
  std::string set_pose(const Pose2&) override { return ""; }
  std::string relocalise() override { return ""; }
  void restart() override { ++restarted; }
  std::chrono::milliseconds pause{0};
  std::atomic<bool> tracking{false}, overlapped{false};
  int restarted = 0;
};

class Counting final : public LiveSink {
 public:
  void take(const LiveUpdate& update) override {
    std::this_thread::sleep_for(pause);
    if (update.restarted) ++restarted;
    ++taken;
  }
  std::chrono::milliseconds pause{0};
  int taken = 0, restarted = 0;
};

bool never() {
  return false;
}
void say_nothing(const std::string&) {}

TEST(LiveRun, ASlowSinkLosesTheOldestAndHoldsUpNobody) {
  Scans source(400, true);
  Clerk engine;
  Counting quick, slow;
  slow.pause = std::chrono::milliseconds(5);
  engine.pause = std::chrono::milliseconds(1);
  const LiveSummary summary = run_live(source, engine, {&quick, &slow}, nullptr, never, say_nothing);
  EXPECT_EQ(summary.scans, 400U);
  EXPECT_EQ(quick.taken, 400);
  EXPECT_LT(slow.taken, 400);
  EXPECT_EQ(summary.not_shown[0], 0U);
  EXPECT_EQ(summary.not_shown[1] + static_cast<std::uint64_t>(slow.taken), 400U) << "what is left out is counted";
}

TEST(LiveRun, ALogWaitsAndASensorDoesNot) {
  Clerk engine;
  engine.pause = std::chrono::milliseconds(1);
  Scans sensor(200, false), log(200, true);
  const LiveSummary fast = run_live(sensor, engine, {}, nullptr, never, say_nothing);
  EXPECT_LT(fast.scans, 200U);
  EXPECT_EQ(fast.scans + fast.dropped, 200U);
  EXPECT_EQ(run_live(log, engine, {}, nullptr, never, say_nothing).scans, 200U);
}

TEST(LiveRun, TasksAreDoneBetweenScansAndTheLastOnesToo) {
  Scans source(100, true);
  Clerk engine;
  engine.pause = std::chrono::milliseconds(1);
  LiveTasks tasks;
  std::atomic<int> done{0};
  std::atomic<bool> during{false};
  std::thread asking([&] {
    for (int i = 0; i < 30; ++i) {
      if (!tasks.post([&] {
            if (engine.tracking) during = true;
            ++done;
          }))
        break;
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
  });
  run_live(source, engine, {}, &tasks, never, say_nothing);
  asking.join();
  EXPECT_GT(done, 0);
  EXPECT_FALSE(during);
  const int before = done;
  EXPECT_FALSE(tasks.post([&] { ++done; })) << "the run is over";
  EXPECT_EQ(done, before);
}

TEST(LiveRun, TooManyTasksAreRefused) {
  LiveTasks tasks;
  int taken = 0;
  for (int i = 0; i < 1000; ++i) taken += tasks.post([] {}) ? 1 : 0;
  EXPECT_GT(taken, 10);
  EXPECT_LT(taken, 1000);
}

TEST(LiveRun, ALogThatBeginsAgainRestartsTheEngine) {
  Scans source(50, true);
  source.restarts = true;
  Clerk engine;
  Counting sink;
  run_live(source, engine, {&sink}, nullptr, never, say_nothing);
  EXPECT_EQ(engine.restarted, 1);
  EXPECT_EQ(sink.restarted, 1);
}

TEST(LiveRun, WhatASinkThrowsEndsTheRun) {
  class Throwing final : public LiveSink {
    void take(const LiveUpdate&) override { throw std::runtime_error("no more"); }
  } sink;
  Scans source(100000000, true);
  Clerk engine;
  EXPECT_THROW(run_live(source, engine, {&sink}, nullptr, never, say_nothing), std::runtime_error);
}

/// A tour through two rooms, twice, and what becomes of it where somebody asks for something after the first round.
struct Drive {
  Slam slam;
  std::unique_ptr<LiveEngine> engine;  // watches slam
  std::vector<Pose2> tour = toy_tour(0.2, 0.4, 1.0);
  std::vector<Wall> walls = two_rooms();
  Random random{3};
  Stamp stamp = stamp_from_seconds(100.0);

  Drive() {
    engine = slam_engine(slam, [] { return Slam(); });
  }
  LiveUpdate add(std::size_t i) {
    stamp += stamp_from_seconds(0.2);
    return engine->add(
        std::make_shared<const RangeMeasurement>(RangeMeasurement{toy_scan(walls, tour[i], {}, random, stamp)}));
  }
};

TEST(SlamEngine, ADriveThatIsToFindItselfIsLostUntilItHas) {
  Drive drive;
  for (std::size_t i = 0; i < drive.tour.size(); ++i) drive.add(i);
  drive.engine->relocalise();
  EXPECT_FALSE(is_tracked(drive.add(0).update.status));
  EXPECT_EQ(drive.add(1).update.status, TrackingStatus::kLost);
  std::size_t found = 0;
  double error = 0.0;
  for (std::size_t i = 2; i < drive.tour.size(); ++i) {
    const LiveUpdate update = drive.add(i);
    EXPECT_EQ(update.on_map, is_tracked(update.update.status));
    if (!update.on_map) continue;
    ++found;
    const Pose2 truth = drive.tour.front().inverse() * drive.tour[i];
    error = std::max(error, translation_distance(truth, update.update.T_map_base()));
  }
  EXPECT_GT(found, drive.tour.size() / 4) << "the same rooms are known again";
  EXPECT_LT(error, 0.3) << "and it stands where it is";
}

TEST(SlamEngine, APoseThatIsToldIsShownAsUnsure) {
  Drive drive;
  for (std::size_t i = 0; i < 100; ++i) drive.add(i);
  drive.engine->set_pose(Pose2(1.0, 2.0, 0.5));
  drive.add(100);
  const LiveUpdate update = drive.add(101);
  EXPECT_EQ(update.update.status, TrackingStatus::kDegraded);
  EXPECT_FALSE(update.on_map);
  EXPECT_LT(translation_distance(update.update.T_map_base(), Pose2(1.0, 2.0, 0.5)), 0.3);
  EXPECT_GT(update.update.map_covariance.value()(0, 0), 0.1);
  EXPECT_THROW(drive.engine->set_pose(Pose2(std::nan(""), 0, 0)), std::invalid_argument);
}

/// Carried off into a room that was never seen, and back to another place of the map: until the map shows where that
/// is, no pose is called ok.
TEST(SlamEngine, WhereTrackingBrokeNoPoseIsOkUntilTheMapSaysSo) {
  Drive drive;
  const std::size_t half = drive.tour.size() / 2;
  for (std::size_t i = 0; i < half; ++i) drive.add(i);
  const std::vector<Wall> known = drive.walls;
  const Eigen::Vector2d at = drive.tour[half].translation();
  const auto corner = [&at](int k) {
    const double radius = k % 2 == 0 ? 0.9 : 1.6, angle = kTwoPi * k / 14.0;
    return Eigen::Vector2d(at + Eigen::Vector2d(radius * std::cos(angle), radius * std::sin(angle)));
  };
  drive.walls.clear();
  for (int i = 0; i < 14; ++i) drive.walls.push_back({corner(i), corner(i + 1)});
  std::size_t wrong = 0, right = 0;
  for (std::size_t i = 0; i < 40; ++i) {
    const LiveUpdate update = drive.add(half);
    wrong += i >= 2 && update.update.status == TrackingStatus::kOk;
  }
  drive.walls = known;
  for (std::size_t i = 0; i < drive.tour.size(); ++i) {
    const LiveUpdate update = drive.add(i);
    if (update.update.status != TrackingStatus::kOk) continue;
    const Pose2 truth = drive.tour.front().inverse() * drive.tour[i];
    ++(translation_distance(truth, update.update.T_map_base()) < 0.3 ? right : wrong);
    EXPECT_TRUE(update.on_map);
  }
  EXPECT_EQ(wrong, 0U);
  EXPECT_GT(right, drive.tour.size() / 4);
}

TEST(SlamEngine, ARestartForgets) {
  Drive drive;
  for (std::size_t i = 0; i < 60; ++i) drive.add(i);
  drive.engine->relocalise();
  drive.engine->restart();
  EXPECT_EQ(drive.slam.scans(), 0U);
  drive.add(0);
  EXPECT_EQ(drive.add(1).update.status, TrackingStatus::kOk);
}

/// A run of days: what it holds of its way is no more after ten rounds than after four, also where all began anew.
TEST(SlamEngine, ALongRunHoldsSoManyPoses) {
  constexpr std::size_t kPoses = 100;
  SlamOptions options;
  options.slam.bounded_memory = true;
  const auto begin = [&options] { return Slam(options, Schedule::kLatest); };
  Slam slam = begin();
  Drive drive;
  drive.engine = slam_engine(slam, begin, kPoses);
  for (const bool again : {false, true}) {
    if (again) drive.engine->restart();
    std::size_t early = 0, late = 0;
    for (int round = 0; round < 10; ++round) {
      for (std::size_t i = 0; i < drive.tour.size(); i += 2) {
        drive.add(i);
        if (i % 50 != 0) continue;
        const std::size_t held = slam.checkpoint().scans();
        ((round < 4) ? early : late) = std::max((round < 4) ? early : late, held);
      }
    }
    EXPECT_GT(slam.scans(), 10 * kPoses);
    EXPECT_LE(late, early + 10);
    EXPECT_LT(late, 5 * kPoses);
  }
}

}  // namespace
}  // namespace phasescan::live::run_test
