// A run on a map that is known: found with no guess, told where it is, lost and found again; what is said of it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "live/ros_view.hpp"
#include "phasescan/live/live.hpp"
#include "support/toy_map.hpp"

namespace phasescan::live {
namespace {

using namespace phasescan::testing;

/// A room without any feature: it looks the same after half a turn.
std::vector<Wall> bare_room() {
  std::vector<Wall> walls;
  add_box(walls, -2.5, -1.5, 2.5, 1.5);
  return walls;
}

struct Place {
  std::vector<Wall> walls;
  TrinaryMap map;
  std::unique_ptr<LiveEngine> engine;
  Random random{7};
  Stamp stamp = stamp_from_seconds(50.0);
  int begun = 0;

  explicit Place(std::vector<Wall> seen) : walls(std::move(seen)), map(toy_map(walls, {0, 0})) {
    engine = localize_engine(
        [this, known = LocalizationMap::from_grid(map)] {
          ++begun;
          return Localizer(known);
        },
        map);
  }
  LiveUpdate see(const Pose2& pose) { return see(pose, walls); }
  LiveUpdate see(const Pose2& pose, const std::vector<Wall>& what) {
    stamp += stamp_from_seconds(0.2);
    return engine->add(
        std::make_shared<const RangeMeasurement>(RangeMeasurement{toy_scan(what, pose, {}, random, stamp)}));
  }
};

std::vector<std::string> topics_of(const LiveUpdate& update) {
  RosView view;
  std::vector<std::string> topics;
  for (const RosMessage& message : view.of(update)) topics.push_back(message.topic);
  return topics;
}

bool has_topic(const LiveUpdate& update, const std::string& topic) {
  const auto topics = topics_of(update);
  return std::find(topics.begin(), topics.end(), topic) != topics.end();
}

/// Bytes of /tf: with map -> odom they are more.
std::size_t frames_size(const LiveUpdate& update) {
  RosView view;
  for (const RosMessage& message : view.of(update))
    if (message.topic == "/tf") return message.bytes.size();
  return 0;
}

TEST(LocalizeEngine, FindsItselfAndFollows) {
  Place place(two_rooms());
  const std::vector<Pose2> tour = toy_tour(0.2, 0.4, 1.0);
  std::size_t ok = 0;
  for (const Pose2& pose : tour) {
    const LiveUpdate update = place.see(pose);
    ASSERT_TRUE(update.located);
    ASSERT_TRUE(update.map);
    EXPECT_EQ(update.map->draw().cells, place.map.cells);
    if (update.update.status != TrackingStatus::kOk) continue;
    ++ok;
    EXPECT_TRUE(update.on_map);
    EXPECT_LT(translation_distance(update.update.T_map_base(), pose), 0.1);
    EXPECT_LT((*update.update.map_covariance)(0, 0), 0.01);
    EXPECT_GT(update.confidence, 0.9);
  }
  EXPECT_GT(ok, 9 * tour.size() / 10);
}

TEST(LocalizeEngine, LostWhereNothingFitsAndFoundAgain) {
  Place place(two_rooms());
  LiveUpdate update;
  for (int i = 0; i < 20; ++i) update = place.see({0.05 * i, 0.0, 0.0});
  ASSERT_EQ(update.update.status, TrackingStatus::kOk);
  EXPECT_TRUE(has_topic(update, "/pose"));
  const std::size_t with_map = frames_size(update);
  // Carried away, to a room that is on no map.
  std::vector<Wall> elsewhere;
  for (int i = 0; i < 14; ++i) {
    const auto corner = [](int k) {
      const double radius = k % 2 == 0 ? 0.9 : 1.6, angle = kTwoPi * k / 14.0;
      return Eigen::Vector2d(20.0 + radius * std::cos(angle), radius * std::sin(angle));
    };
    elsewhere.push_back({corner(i), corner(i + 1)});
  }
  bool ok = false, lost = false;
  for (int i = 0; i < 30; ++i) {
    update = place.see({20.0, 0.02 * i, 0.3}, elsewhere);
    ok |= update.update.status == TrackingStatus::kOk;
    EXPECT_FALSE(lost && update.has_pose()) << "a guess elsewhere";
    lost |= update.update.status == TrackingStatus::kLost;
  }
  EXPECT_FALSE(ok);
  EXPECT_TRUE(lost);
  EXPECT_EQ(update.update.status, TrackingStatus::kLost);
  EXPECT_GT((*update.update.map_covariance)(0, 0), 1e3);
  EXPECT_FALSE(has_topic(update, "/pose")) << "a pose that is not to go by is not published";
  EXPECT_LT(frames_size(update), with_map) << "nor is map -> odom";
  for (int i = 0; i < 30; ++i) update = place.see({5.0 + 0.02 * i, 0.5, 1.0});
  EXPECT_EQ(update.update.status, TrackingStatus::kOk);
  EXPECT_LT(translation_distance(update.update.T_map_base(), {5.58, 0.5, 1.0}), 0.1);
}

TEST(LocalizeEngine, PlacesThatLookAlikeAreNamedUntilAPersonSays) {
  Place place(bare_room());
  LiveUpdate update;
  for (int i = 0; i < 10; ++i) update = place.see({1.0, 0.3, 0.2});
  EXPECT_EQ(update.update.status, TrackingStatus::kAmbiguous);
  EXPECT_GE(update.located->hypotheses.size(), 2U);
  EXPECT_FALSE(update.has_pose());
  for (const Pose2 told : {Pose2(1.1, 0.2, 0.25), Pose2(-1.1, -0.2, 0.2 + kPi)}) {
    place.engine->set_pose(told);
    update = place.see({1.0, 0.3, 0.2});
    EXPECT_LT(translation_distance(update.update.T_map_base(), told), 0.3) << "the one that was meant";
  }
  place.engine->relocalise();
  EXPECT_GE(place.see({1.0, 0.3, 0.2}).located->hypotheses.size(), 2U) << "anywhere again";
  EXPECT_THROW(place.engine->set_pose(Pose2(std::nan(""), 0, 0)), std::invalid_argument);
}

TEST(LocalizeEngine, ARestartForgets) {
  Place place(two_rooms());
  for (int i = 0; i < 10; ++i) place.see({0.05 * i, 0.0, 0.0});
  EXPECT_EQ(place.begun, 1);
  place.engine->restart();
  EXPECT_EQ(place.begun, 2);
  EXPECT_EQ(place.see({0.0, 0.0, 0.0}).update.scan, 0);
}

}  // namespace
}  // namespace phasescan::live
