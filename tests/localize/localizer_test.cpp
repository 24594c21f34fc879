// Where a robot is on a map: one scan alone, and a drive.
#include "phasescan/localize/localizer.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

#include "support/toy_map.hpp"

namespace phasescan::localizer_test {
namespace {

using testing::toy_map;
using testing::toy_scan;
using testing::ToyLidar;
using testing::two_rooms;

RangeMeasurement measured(Scan scan) {
  return {std::move(scan), "", {}, {}};
}

bool is_right(const Pose2& pose, const Pose2& truth) {
  return translation_distance(pose, truth) < 0.1 && angle_distance(pose.theta, truth.theta) < deg_to_rad(3.0);
}

TEST(LocalizationMap, RefusesMapsThatNobodyCanBeLocalisedIn) {
  const auto refuses = [](TrinaryMap map) { EXPECT_THROW(LocalizationMap::from_grid(map), std::invalid_argument); };
  refuses({});
  TrinaryMap map = toy_map(two_rooms(), {0, 0});
  TrinaryMap other = map;
  other.cells.pop_back();
  refuses(other);
  for (const double resolution : {0.0, -0.05, std::numeric_limits<double>::quiet_NaN()}) {
    other = map;
    other.resolution_m = resolution;
    refuses(other);
  }
  other = map;
  other.origin.theta = std::numeric_limits<double>::quiet_NaN();
  refuses(other);
  for (const CellState all : {CellState::kFree, CellState::kOccupied, CellState::kUnknown}) {
    other = map;
    std::fill(other.cells.begin(), other.cells.end(), all);
    refuses(other);
  }
  other = {1, 1, 0.05, {}, {CellState::kFree}};
  refuses(other);
  EXPECT_GT(LocalizationMap::from_grid(map).views(), 300U);
}

/// A single scan is enough, on maps of other cells and with a turned origin, with any mounting.
TEST(Locate, FindsScansWithNoGuess) {
  Random random(4);
  for (const auto& [cell, yaw] :
       {std::pair{0.05, 0.0}, std::pair{0.05, 0.6}, std::pair{0.02, 0.0}, std::pair{0.1, -2.0}}) {
    const LocalizationMap map = LocalizationMap::from_grid(toy_map(two_rooms(), {0, 0}, cell, yaw));
    int right = 0, false_ok = 0;
    for (int n = 0; n < 25; ++n) {
      const bool first = n % 2 == 0;
      const Pose2 T_map_base{first ? random.uniform(-1.5, 2.5) : random.uniform(3.5, 7.0), random.uniform(-1.2, 1.0),
                             random.uniform(-kPi, kPi)};
      RangeMeasurement m = measured({});
      m.T_base_laser = {0.1, -0.05, 0.3};
      m.scan = toy_scan(two_rooms(), T_map_base * m.T_base_laser, ToyLidar{}, random, 0);
      const LocalizationUpdate update = locate(map, m);
      ASSERT_TRUE(update.T_map_base);
      const bool good = is_right(*update.T_map_base, T_map_base);
      right += good;
      false_ok += update.status == TrackingStatus::kOk && !good;
    }
    EXPECT_GE(right, 24) << cell << " " << yaw;
    EXPECT_EQ(false_ok, 0) << cell << " " << yaw;
  }
}

/// A room without any feature looks the same after half a turn: both poses are named and none is called ok.
TEST(Locate, SaysAmbiguousInARoomThatLooksTheSameAfterHalfATurn) {
  const std::vector<testing::Wall> walls = {{{0, 0}, {5, 0}}, {{5, 0}, {5, 3}}, {{5, 3}, {0, 3}}, {{0, 3}, {0, 0}}};
  const LocalizationMap map = LocalizationMap::from_grid(toy_map(walls, {1, 1}));
  Random random(8);
  int named = 0;
  for (int n = 0; n < 20; ++n) {
    const Pose2 truth{random.uniform(0.5, 4.5), random.uniform(0.5, 2.5), random.uniform(-kPi, kPi)};
    const LocalizationUpdate update = locate(map, measured(toy_scan(walls, truth, ToyLidar{}, random, 0)));
    EXPECT_EQ(update.status, TrackingStatus::kAmbiguous) << n;
    for (const PoseEstimate& h : update.hypotheses) named += is_right(h.T_map_base, truth);
  }
  EXPECT_GE(named, 20);
}

TEST(Locate, SaysLostOfAPlaceThatTheMapHasNot) {
  const LocalizationMap map = LocalizationMap::from_grid(toy_map(two_rooms(), {0, 0}));
  const auto elsewhere = testing::corridor_with_niches(20, 0.6);
  Random random(2);
  for (int n = 0; n < 10; ++n) {
    const Pose2 pose{random.uniform(3, 17), random.uniform(-0.4, 0.4), random.uniform(-kPi, kPi)};
    const LocalizationUpdate update = locate(map, measured(toy_scan(elsewhere, pose, ToyLidar{}, random, 0)));
    EXPECT_NE(update.status, TrackingStatus::kOk) << n;
  }
}

TEST(Locate, AScanWithoutReturnsSaysNothing) {
  const LocalizationMap map = LocalizationMap::from_grid(toy_map(two_rooms(), {0, 0}));
  const LocalizationUpdate update =
      locate(map, measured(make_scan(std::vector<float>(360, 0.0F), {0.0, kTwoPi / 360, 0.1, 6.0})));
  EXPECT_EQ(update.status, TrackingStatus::kInitialising);
  EXPECT_FALSE(update.T_map_base);
  RangeMeasurement bad = measured(make_scan(std::vector<float>(360, 1.0F), {0.0, kTwoPi / 360, 0.1, 6.0}));
  bad.T_base_laser.x = std::numeric_limits<double>::infinity();
  EXPECT_THROW(locate(map, bad), std::invalid_argument);
}

/// Drives along poses; counts scans that are ok, and those that are and should not be.
struct Driven {
  int ok = 0, false_ok = 0, scans = 0;
};
Driven drive(Localizer& localizer, const std::vector<Pose2>& way, Random& random, Stamp begin = 0,
             const Pose2& T_world_map = {}) {
  Driven driven;
  for (std::size_t i = 0; i < way.size(); ++i) {
    const LocalizationUpdate update = localizer.add(
        measured(toy_scan(two_rooms(), way[i], ToyLidar{}, random, begin + static_cast<Stamp>(i) * 100'000'000)));
    ++driven.scans;
    if (update.status != TrackingStatus::kOk) continue;
    ++driven.ok;
    driven.false_ok += !is_right(T_world_map * *update.T_map_base, way[i]);
  }
  return driven;
}

TEST(Localizer, FollowsADriveFromNothing) {
  Localizer localizer(LocalizationMap::from_grid(toy_map(two_rooms(), {0, 0}, 0.05, 0.4)));
  Random random(6);
  const Driven driven = drive(localizer, testing::toy_tour(0.1, 0.4, 0.8), random);
  EXPECT_EQ(driven.false_ok, 0);
  EXPECT_GE(driven.ok, driven.scans * 97 / 100);
}

TEST(Localizer, NoticesThatItWasCarriedAwayAndFindsItselfAgain) {
  Localizer localizer(LocalizationMap::from_grid(toy_map(two_rooms(), {0, 0})));
  Random random(6);
  std::vector<Pose2> way = testing::toy_tour(0.1, 0.4, 0.8);
  way.resize(80);
  EXPECT_EQ(drive(localizer, way, random).false_ok, 0);
  std::vector<Pose2> elsewhere;
  for (int i = 0; i < 60; ++i) elsewhere.push_back({6.5 - 0.02 * i, -0.5, 2.9});
  Driven after;
  int false_ok_in_a_row = 0, most_in_a_row = 0;
  for (std::size_t i = 0; i < elsewhere.size(); ++i) {
    const LocalizationUpdate update = localizer.add(measured(
        toy_scan(two_rooms(), elsewhere[i], ToyLidar{}, random, 8'000'000'000 + static_cast<Stamp>(i) * 100'000'000)));
    const bool ok = update.status == TrackingStatus::kOk, right = ok && is_right(*update.T_map_base, elsewhere[i]);
    after.ok += right;
    false_ok_in_a_row = ok && !right ? false_ok_in_a_row + 1 : 0;
    most_in_a_row = std::max(most_in_a_row, false_ok_in_a_row);
  }
  EXPECT_LE(most_in_a_row, 3);
  EXPECT_GE(after.ok, 45);
}

/// Of two_rooms.
TrinaryMap map_of_first_room() {
  TrinaryMap map = toy_map(two_rooms(), {0, 0});
  for (int k = 0; k < map.height; ++k) {
    for (int i = 0; i < map.width; ++i) {
      const Eigen::Vector2d p =
          map.origin * Eigen::Vector2d((i + 0.5) * map.resolution_m, (k + 0.5) * map.resolution_m);
      if (p.x() > 2.9) map.cells[static_cast<std::size_t>(k * map.width + i)] = CellState::kUnknown;
    }
  }
  return map;
}

/// The map has the first room alone, and turned by half a turn the other one looks like it: nothing there is ok, and
/// the first room is known again.
TEST(Localizer, NothingIsOkAtAWrongPlaceInARoomThatTheMapHasNot) {
  Localizer localizer(LocalizationMap::from_grid(map_of_first_room()));
  Random random(6);
  int wrong_ok = 0, ok_in_first = 0, in_first = 0, in_second = 0;
  Stamp stamp = 0;
  for (const Pose2& pose : testing::toy_tour(0.1, 0.4, 0.8)) {
    const LocalizationUpdate u =
        localizer.add(measured(toy_scan(two_rooms(), pose, ToyLidar{}, random, stamp += 100'000'000)));
    const bool ok = u.status == TrackingStatus::kOk;
    wrong_ok += ok && !is_right(*u.T_map_base, pose);
    const bool first = pose.x < 2.0;
    in_first += first, in_second += pose.x > 3.5;
    ok_in_first += ok && first;
  }
  EXPECT_GT(in_second, 30);
  EXPECT_EQ(wrong_ok, 0);
  EXPECT_GE(ok_in_first, in_first * 9 / 10) << in_first;
}

/// From the pose that was ok on, odometry leads through the room that the map lacks: degraded, with a pose, never lost.
TEST(Localizer, IsNotLostSoonInARoomThatTheMapHasNot) {
  Localizer localizer(LocalizationMap::from_grid(map_of_first_room()));
  Random random(6);
  int lost = 0, in_second = 0;
  Stamp stamp = 0;
  for (const Pose2& pose : testing::toy_tour(0.1, 0.4, 0.8)) {
    const LocalizationUpdate u =
        localizer.add(measured(toy_scan(two_rooms(), pose, ToyLidar{}, random, stamp += 100'000'000)));
    in_second += pose.x > 3.5;
    lost += u.status == TrackingStatus::kLost;
    EXPECT_TRUE(!u.T_map_base || is_right(*u.T_map_base, pose)) << pose.x;
  }
  EXPECT_GT(in_second, 30);
  EXPECT_EQ(lost, 0);
}

/// One scan of which a part is new may be of a room that the map has not: views of the way decide. Until then nothing
/// is a pose to go by.
TEST(Localizer, AFirstScanThatIsNotWhollyExplainedIsAmbiguousUntilTheWayConfirmsIt) {
  Localizer localizer(LocalizationMap::from_grid(toy_map(two_rooms(), {0, 0})));
  Random random(6);
  const std::vector<Pose2> way = testing::toy_tour(0.1, 0.4, 0.8);
  int ok = 0;
  for (std::size_t i = 0; i < 30; ++i) {
    Scan scan = toy_scan(two_rooms(), way[i], ToyLidar{}, random, static_cast<Stamp>(i) * 100'000'000);
    for (std::size_t b = 0; b < scan.size() / 5; ++b) scan.ranges[b] *= 0.6F;
    const LocalizationUpdate u = localizer.add(measured(std::move(scan)));
    if (i == 0) {
      EXPECT_EQ(u.status, TrackingStatus::kAmbiguous);
    }
    if (u.status != TrackingStatus::kOk) {
      EXPECT_TRUE(ok > 0 || !u.has_pose()) << i;
      continue;
    }
    ++ok;
    EXPECT_TRUE(is_right(*u.T_map_base, way[i]));
  }
  EXPECT_GT(ok, 5);
}

TEST(Localizer, TakesAPoseThatIsGiven) {
  const std::vector<testing::Wall> walls = {{{0, 0}, {5, 0}}, {{5, 0}, {5, 3}}, {{5, 3}, {0, 3}}, {{0, 3}, {0, 0}}};
  Localizer localizer(LocalizationMap::from_grid(toy_map(walls, {1, 1})));
  Random random(8);
  const Pose2 truth{1.5, 1.2, 0.4};
  localizer.initialize({1.7, 1.0, 0.5}, Eigen::Vector3d(0.09, 0.09, 0.02).asDiagonal());
  const LocalizationUpdate update = localizer.add(measured(toy_scan(walls, truth, ToyLidar{}, random, 0)));
  ASSERT_TRUE(update.T_map_base);
  EXPECT_TRUE(is_right(*update.T_map_base, truth)) << update.T_map_base->x << " " << update.T_map_base->y;
  EXPECT_THROW(localizer.initialize({std::nan(""), 0, 0}, Eigen::Matrix3d::Identity()), std::invalid_argument);
}

TEST(Localizer, SameScansSameAnswers) {
  const LocalizationMap map = LocalizationMap::from_grid(toy_map(two_rooms(), {0, 0}));
  std::vector<std::vector<double>> runs(2);
  for (auto& run : runs) {
    Localizer localizer(map);
    Random random(6);
    for (const Pose2& pose : testing::toy_tour(0.3, 0.4, 0.8)) {
      const LocalizationUpdate u = localizer.add(measured(toy_scan(two_rooms(), pose, ToyLidar{}, random, 0)));
      run.insert(run.end(), {u.T_map_base->x, u.T_map_base->y, u.T_map_base->theta, u.confidence});
    }
  }
  EXPECT_EQ(runs[0], runs[1]);
}

}  // namespace
}  // namespace phasescan::localizer_test
