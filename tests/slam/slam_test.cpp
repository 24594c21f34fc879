#include "phasescan/slam/slam.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <deque>
#include <functional>

#include "core/random.hpp"
#include "eval/trajectory_error.hpp"
#include "output/g2o.hpp"
#include "output/map_file.hpp"
#include "io/tum.hpp"
#include "slam/scan_store.hpp"
#include "support/toy_world.hpp"

namespace phasescan::slam_test {
namespace {

using testing::toy_scan;
using testing::toy_tour;
using testing::ToyLidar;
using testing::two_rooms;

/// All that a run leaves, as text.
std::string bytes_of(const SlamResult& result) {
  std::vector<StampedPose> stamped;
  for (const ScanResult& scan : result.scans) stamped.push_back({scan.stamp, scan.T_map_base});
  return format_tum(stamped) + format_g2o(result.keyframes, result.edges) + format_pgm(result.map);
}

/// Measurements of a tour through two rooms, 0.18 s apart.
std::vector<RangeMeasurement> tour_of(int laps, double speed = 0.4, double turn_rate = 1.2, std::uint64_t seed = 33) {
  const auto walls = two_rooms();
  Random random(seed);
  std::vector<RangeMeasurement> out;
  for (const Pose2& pose : toy_tour(0.18, speed, turn_rate, laps)) {
    const Stamp stamp = stamp_from_seconds(1.0 + 0.18 * static_cast<double>(out.size()));
    out.push_back({toy_scan(walls, pose, {}, random, stamp)});
  }
  return out;
}

struct TourResult {
  SlamResult result;
  ErrorStats ate;
};

TourResult run_tour(const SlamOptions& options, Executor* executor, int laps) {
  Slam slam(options, Schedule::kDeterministic, executor);
  for (const RangeMeasurement& m : tour_of(laps)) slam.add(m);
  TourResult run{slam.finish(), {}};
  AssociatedPoses pairs;
  pairs.reference = toy_tour(0.18, 0.4, 1.2, laps);
  pairs.estimate = run.result.trajectory();
  run.ate = error_stats(absolute_trajectory_errors(pairs));
  return run;
}

/// Keeps tasks until the test runs them: as slow as an executor can be.
class ManualExecutor final : public Executor {
 public:
  ~ManualExecutor() override { run_all(); }
  void run(std::function<void()> task) override { tasks_.push_back(std::move(task)); }
  void run_all() {
    while (!tasks_.empty()) {
      const auto task = std::move(tasks_.front());
      tasks_.pop_front();
      task();
    }
  }
  std::size_t waiting() const { return tasks_.size(); }

 private:
  std::deque<std::function<void()>> tasks_;
};

TEST(Slam, TwoLapsWithLoopsAreAccurate) {
  const TourResult run = run_tour({}, nullptr, 2);
  EXPECT_LT(run.ate.rmse, 0.01);
  EXPECT_LT(run.ate.max, 0.04);
  EXPECT_GT(run.result.loops.accepted, 20u);
  EXPECT_EQ(run.result.pieces, 1);
  EXPECT_EQ(run.result.scans_left_out(), 0u);
}

TEST(Slam, SameBytesInsideAndBesideTheCallerAndTwice) {
  ThreadExecutor executor;
  const std::string one = bytes_of(run_tour({}, nullptr, 2).result);
  EXPECT_EQ(one, bytes_of(run_tour({}, nullptr, 2).result));
  EXPECT_EQ(one, bytes_of(run_tour({}, &executor, 2).result));
}

TEST(Slam, UpdatesAreTheSameInsideAndBesideTheCaller) {
  // A batch each keyframe, and a first scan with nothing in it.
  SlamOptions options;
  options.slam.batch_nodes = 1;
  options.slam.polish = false;
  const auto said = [&](Executor* executor) {
    Slam slam(options, Schedule::kDeterministic, executor);
    std::string text;
    const auto say = [&text](const ScanUpdate& u) {
      const Pose2 p = u.T_map_base();
      text += std::to_string(p.x) + " " + std::to_string(p.y) + " " + std::to_string(p.theta) + " " +
              std::to_string(u.map_version) + " " + std::to_string(u.map_covariance ? u.map_covariance->trace() : 0.0);
    };
    say(slam.add({Scan{}}));
    for (const RangeMeasurement& m : tour_of(1, 0.5, 1.5, 8)) {
      say(slam.add(m));
      text += std::to_string(slam.map()->keyframes().size()) + "\n";
    }
    return text + bytes_of(slam.finish());
  };
  ThreadExecutor executor;
  const std::string one = said(nullptr);
  EXPECT_GT(one.size(), 10000u);
  EXPECT_TRUE(one == said(&executor));
}

TEST(Slam, ARunResumedAfterAnyScanEndsWithTheSameBytes) {
  SlamOptions options;
  options.slam.batch_nodes = 4;
  for (const bool bounded : {false, true}) {
    options.slam.bounded_memory = bounded;
    const std::vector<RangeMeasurement> tour = tour_of(2, 0.8, 2.0, 4);
    std::vector<SlamState> states;
    Slam whole(options);
    std::vector<std::string> said;
    for (const RangeMeasurement& m : tour) {
      const Pose2 p = whole.add(m).T_map_base();
      said.push_back(std::to_string(p.x) + std::to_string(p.y) + std::to_string(p.theta));
      states.push_back(whole.checkpoint());
    }
    const std::string bytes = bytes_of(whole.finish());
    // The first scans, where the first keyframe waits, and every so often later on, within a batch and at its border.
    for (std::size_t i = 0; i < states.size(); i += i < 6 ? 1 : 17) {
      Slam resumed(states[i], options);
      ASSERT_EQ(resumed.scans(), i + 1);
      for (std::size_t k = i + 1; k < tour.size(); ++k) {
        const Pose2 p = resumed.add(tour[k]).T_map_base();
        ASSERT_EQ(std::to_string(p.x) + std::to_string(p.y) + std::to_string(p.theta), said[k]) << i << " " << k;
      }
      ASSERT_TRUE(bytes_of(resumed.finish()) == bytes) << "resumed after scan " << i << ", bounded " << bounded;
    }
  }
}

TEST(Slam, UnderLatestAddNeverWaitsForASlowExecutor) {
  ManualExecutor executor;
  Slam slam({}, Schedule::kLatest, &executor);
  const std::vector<RangeMeasurement> tour = tour_of(1);
  std::size_t keyframes = 0;
  for (const RangeMeasurement& m : tour) {
    const ScanUpdate update = slam.add(m);
    keyframes += update.keyframe.has_value();
    EXPECT_EQ(update.map_version, 0u);  // nothing has been worked on
    EXPECT_FALSE(update.map_covariance.has_value());
  }
  EXPECT_GT(keyframes, 20u);
  EXPECT_EQ(executor.waiting(), 1u);  // one task works off all batches
  EXPECT_TRUE(slam.map()->keyframes().empty());
  executor.run_all();
  RangeMeasurement next = tour.back();
  next.scan.stamp += stamp_from_seconds(0.18);
  const ScanUpdate update = slam.add(next);
  EXPECT_GT(update.map_version, 0u);
  EXPECT_TRUE(update.map_covariance.has_value());
  EXPECT_GT(slam.map()->keyframes().size(), 20u);
  executor.run_all();
  const SlamResult result = slam.finish();
  EXPECT_EQ(result.scans.size(), tour.size() + 1);
  EXPECT_EQ(result.pieces, 1);
}

TEST(Slam, ASnapshotStaysAsItIs) {
  Slam slam;
  const std::vector<RangeMeasurement> tour = tour_of(1);
  std::shared_ptr<const MapSnapshot> early = slam.map();
  EXPECT_EQ(early->version(), 0u);
  EXPECT_EQ(early->draw().cells.size(), 1u);
  std::string drawn;
  for (std::size_t i = 0; i < tour.size(); ++i) {
    slam.add(tour[i]);
    if (i != tour.size() / 2) continue;
    early = slam.map();
    drawn = format_pgm(early->draw());
  }
  EXPECT_GT(early->version(), 0u);
  EXPECT_GT(early->keyframes().size(), 5u);
  EXPECT_GT(drawn.size(), 5000u);
  slam.finish();
  EXPECT_TRUE(format_pgm(early->draw()) == drawn);
  EXPECT_GT(slam.map()->keyframes().size(), early->keyframes().size());
}

TEST(Slam, TheObserverIsToldOfKeyframesLoopsCorrectionsAndWarnings) {
  struct Seen final : SlamObserver {
    std::vector<KeyframeId> keyframes;
    std::size_t loops = 0, corrections = 0;
    std::vector<std::string> warnings;
    void on_keyframe(KeyframeId keyframe, const Pose2&, ScanId) override { keyframes.push_back(keyframe); }
    void on_loop(const MapEdge& edge, bool accepted) override {
      EXPECT_TRUE(edge.loop);
      loops += accepted;
    }
    void on_correction(const Pose2&, const Pose2&, std::uint64_t) override { ++corrections; }
    void on_warning(ScanId, const std::string& kind, const std::string&, bool) override { warnings.push_back(kind); }
  } seen;
  Slam slam;
  slam.set_observer(&seen);
  const std::vector<RangeMeasurement> tour = tour_of(2);
  for (const RangeMeasurement& m : tour) slam.add(m);
  EXPECT_TRUE(slam.add(tour.back()).repeated);
  const SlamResult result = slam.finish();
  ASSERT_EQ(seen.keyframes.size(), result.keyframes.size());
  for (std::size_t i = 0; i < seen.keyframes.size(); ++i) EXPECT_EQ(seen.keyframes[i], static_cast<KeyframeId>(i));
  EXPECT_GT(seen.loops, 5u);
  EXPECT_GT(seen.corrections, 5u);
  EXPECT_EQ(seen.warnings, std::vector<std::string>{"repeated scan"});
  EXPECT_EQ(result.oddities.at("repeated scan").first, static_cast<ScanId>(tour.size()));
}

TEST(Slam, PredictsAlongTheMotionAndNotFarAhead) {
  Slam slam;
  EXPECT_FALSE(slam.predict(0).has_value());
  const std::vector<RangeMeasurement> tour = tour_of(1);
  ScanUpdate last;
  for (std::size_t i = 0; i < 30; ++i) last = slam.add(tour[i]);
  const Pose2 next = slam.predict(tour[30].scan.stamp).value();
  EXPECT_LT(translation_distance(next, slam.add(tour[30]).T_map_base()), 0.03);
  EXPECT_FALSE(slam.predict(tour[30].scan.stamp + stamp_from_seconds(1.5)).has_value());
}

TEST(Slam, OnTheMapAPoseIsLessSureTheLongerItsLastResultIsAgo) {
  SlamOptions options;
  options.slam.batch_nodes = 6;
  Slam slam(options);
  std::optional<ScanUpdate> first;  // of those with the same result
  std::size_t compared = 0;
  for (const RangeMeasurement& m : tour_of(1)) {
    const ScanUpdate update = slam.add(m);
    if (!update.map_covariance) continue;
    if (!first || first->map_version != update.map_version) first = update;
    // The sum of the positive eigenvalues grows with whatever tracking adds that takes nothing away.
    const Eigen::Matrix3d added = update.odom_covariance - first->odom_covariance;
    if (Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(added).eigenvalues()(0) <= 0.0) continue;
    EXPECT_GT(update.map_covariance->trace(), first->map_covariance->trace());
    ++compared;
  }
  EXPECT_GT(compared, 10u);
}

TEST(Slam, BoundedMemoryKeepsTheMapAndStopsGrowingInAKnownWorld) {
  SlamOptions options;
  options.slam.bounded_memory = true;
  const auto walls = two_rooms();
  const auto tour = toy_tour(0.18, 0.4, 1.2, 6);
  Random random(5);
  Slam slam(options);
  AssociatedPoses pairs;
  std::size_t nodes_halfway = 0;
  for (std::size_t i = 0; i < tour.size(); ++i) {
    slam.add({toy_scan(walls, tour[i], {}, random, stamp_from_seconds(0.18 * static_cast<double>(i)))});
    if (i == tour.size() / 2) nodes_halfway = slam.map()->keyframes().size();
  }
  const SlamResult result = slam.finish();
  pairs.reference = tour;
  pairs.estimate = result.trajectory();
  EXPECT_LT(error_stats(absolute_trajectory_errors(pairs)).rmse, 0.03);
  EXPECT_LT(result.keyframes.size(), nodes_halfway + nodes_halfway / 10 + 5);
  EXPECT_GT(result.map.cells.size(), 10000u);
}

TEST(Slam, OnePosePerMeasurementWhateverComes) {
  Slam slam;
  Random random(1);
  const auto walls = two_rooms();
  slam.add({Scan{}});
  slam.add({make_scan(std::vector<float>(100, 0.0F), {-1.0, 0.01, 0.0, 0.0})});
  RangeMeasurement m;
  for (int i = 0; i < 5; ++i) {
    m = {toy_scan(walls, {0.02 * i, 0, 0}, {}, random, stamp_from_seconds(0.1 * i))};
    slam.add(m);
  }
  slam.add(m);  // once more
  const SlamResult result = slam.finish();
  ASSERT_EQ(result.scans.size(), 8u);
  for (const ScanResult& scan : result.scans) EXPECT_TRUE(scan.T_map_base.is_finite());
  EXPECT_TRUE(result.scans[7].repeated);
  EXPECT_EQ(result.scans[7].T_map_base, result.scans[6].T_map_base);
  EXPECT_EQ(result.scans[0].status, TrackingStatus::kInitialising);
  EXPECT_EQ(result.scans[6].status, TrackingStatus::kOk);
}

TEST(Slam, ALogOfOneScanIsAMap) {
  Random random(1);
  Slam slam;
  ToyLidar lidar;
  lidar.turn_s = 0.18;
  slam.add({toy_scan(two_rooms(), {}, lidar, random, 0)});
  const SlamResult result = slam.finish();
  ASSERT_EQ(result.scans.size(), 1u);
  EXPECT_EQ(result.keyframes.size(), 1u);
  EXPECT_GT(result.map.cells.size(), 1000u);
}

TEST(Slam, CallersMistakesThrowAndNameTheField) {
  Slam slam;
  RangeMeasurement bad;
  bad.T_base_laser.x = std::nan("");
  EXPECT_THROW(slam.add(bad), std::invalid_argument);
  bad = {};
  bad.T_odom_base = Pose2{0, 0, std::nan("")};
  EXPECT_THROW(slam.add(bad), std::invalid_argument);
  EXPECT_EQ(slam.scans(), 0u);
  slam.finish();
  EXPECT_THROW(slam.finish(), std::logic_error);
  EXPECT_THROW(slam.add({}), std::logic_error);
  SlamOptions options;
  options.loops.votes = -1;
  EXPECT_THROW(Slam{options}, std::invalid_argument);
  options = {};
  options.match.match.min_confidence = 2.0;
  EXPECT_THROW(Slam{options}, std::invalid_argument);
}

TEST(Slam, NothingAtAllIsAnEmptyMap) {
  const SlamResult result = Slam().finish();
  EXPECT_TRUE(result.scans.empty());
  EXPECT_EQ(result.map.cells.size(), 1u);
}

TEST(ScanStore, KeepsRangesAndReasonsAndMakesNoWallOfWhatIsTooFar) {
  ScanStore store;
  const Scan scan = make_scan(std::vector<float>{0.5F, 129.9F, 140.0F, 0.0F, 999.0F}, {0.0, 0.01, 0.1, 200.0});
  const Scan kept = store.scan(store.add(scan, {}));
  EXPECT_NEAR(kept.ranges[0], 0.5F, 0.0011F);
  EXPECT_NEAR(kept.ranges[1], 129.9F, 0.0011F);
  EXPECT_EQ(kept.states[2], BeamState::kOutOfRange);
  EXPECT_EQ(kept.states[3], scan.states[3]);
  EXPECT_EQ(kept.states[4], scan.states[4]);
}

TEST(ScanStore, AMountingThatJittersMakesNoKindOfItsOwn) {
  ScanStore store;
  const Scan scan = make_scan(std::vector<float>(360, 2.0F), {0.0, 0.017, 0.1, 8.0});
  for (int i = 0; i < 50; ++i) store.add(scan, {0.1, 0.0, 1e-15 * i});
  EXPECT_EQ(store.kinds(), 1u);
  EXPECT_EQ(store.T_base_laser(40).theta, 1e-15 * 40);
}

TEST(ScanStore, ACopyKeepsWhatItHeldWhileTheFirstGrows) {
  ScanStore store;
  const auto at = [](int i) {
    return make_scan(std::vector<float>(10, 0.1F + 0.01F * static_cast<float>(i)), {0.0, 0.1});
  };
  std::vector<ScanStore> copies;
  for (int i = 0; i < 200; ++i) {
    copies.push_back(store);
    store.add(at(i), {});
  }
  for (std::size_t n = 0; n < copies.size(); ++n) {
    ASSERT_EQ(copies[n].size(), n);
    if (n > 0) {
      EXPECT_EQ(copies[n].scan(n - 1).ranges, store.scan(n - 1).ranges) << n;
    }
    EXPECT_THROW(copies[n].scan(n), std::out_of_range);
  }
}

}  // namespace
}  // namespace phasescan::slam_test
