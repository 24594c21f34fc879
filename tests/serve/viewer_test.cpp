// What a client of /ws puts together from what it is sent is the map, the way and the loops, however late or slow it
// is.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "serve/frames.hpp"
#include "serve/live_map.hpp"
#include "serve/page_client.hpp"
#include "serve/status_board.hpp"
#include "serve/viewer.hpp"
#include "support/toy_world.hpp"

namespace phasescan::serve::viewer_test {
namespace {

using namespace phasescan::testing;
using ::testing::HasSubstr;

/// A tour through two rooms that closes loops, all its updates.
const std::vector<live::LiveUpdate>& tour_updates() {
  static const std::vector<live::LiveUpdate> updates = [] {
    const auto walls = two_rooms();
    auto tour = toy_tour(0.2, 0.4, 1.0);
    Random random(5);
    Slam slam;
    const auto engine = live::slam_engine(slam, [] { return Slam(); });
    std::vector<live::LiveUpdate> all;
    for (std::size_t i = 0; i < tour.size(); ++i) {
      const Scan scan = toy_scan(walls, tour[i], {}, random, stamp_from_seconds(100.0 + 0.2 * static_cast<double>(i)));
      all.push_back(engine->add(std::make_shared<const RangeMeasurement>(RangeMeasurement{scan})));
    }
    return all;
  }();
  return updates;
}

class ViewerTest : public ::testing::Test {
 protected:
  Obedient control;
  Viewer viewer{SlamOptions{}, control, [] { return std::string("{\"state\": \"ok\"}"); }};
  std::shared_ptr<Page> open() {
    auto page = std::make_shared<Page>();
    viewer.on_open(page, "");
    viewer.on_drained(page);
    return page;
  }
};

TEST_F(ViewerTest, ChangesAddUpToTheWholeMap) {
  LiveMap map{SlamOptions{}};
  const auto early = open();
  for (const live::LiveUpdate& update : tour_updates()) {
    viewer.take(update);
    map.add(update);
  }
  const auto late = open();
  std::map<TileIndex, std::vector<int>> whole;
  const OccupancyGrid::Bounds known = map.grid().bounds();
  for (int k = known.min_k; k <= known.max_k; ++k)
    for (int i = known.min_i; i <= known.max_i; ++i) {
      if (!map.grid().known(i, k)) continue;
      const double p = 1.0 / (1.0 + std::exp(-map.grid().log_odds(i, k)));
      const int ti = static_cast<int>(std::floor(i / 64.0)), tk = static_cast<int>(std::floor(k / 64.0));
      std::vector<int>& levels = whole[{ti, tk}];
      levels.resize(4096);
      levels[static_cast<std::size_t>((k - 64 * tk) * 64 + i - 64 * ti)] = p <= 0.196 ? 1 : p >= 0.65 ? 3 : 2;
    }
  const auto classes = [](std::map<TileIndex, std::vector<int>> tiles) {
    std::erase_if(tiles, [](const auto& tile) { return tile.second.empty(); });
    for (auto& [at, levels] : tiles)
      for (int& level : levels) level = level == 0 ? 0 : level <= 4 ? 1 : level <= 9 ? 2 : 3;
    return tiles;
  };
  EXPECT_GT(whole.size(), 3U);
  EXPECT_EQ(classes(early->tiles), whole);
  EXPECT_EQ(classes(late->tiles), whole);
  EXPECT_EQ(early->path, late->path);
  EXPECT_EQ(early->path.size(), map.path().size());
  EXPECT_EQ(early->loops, late->loops);
  EXPECT_GT(early->loops.size(), 0U) << "the tour closes loops";
  EXPECT_LT(late->bytes, early->bytes / 3) << "only what changed is sent, and to a newcomer only what is";
}

TEST_F(ViewerTest, TheLiveMapIsTheOneThatTheGraphHas) {
  LiveMap map{SlamOptions{}};
  for (const live::LiveUpdate& update : tour_updates()) map.add(update);
  const TrinaryMap drawn = tour_updates().back().map->draw();
  const TrinaryMap live = make_trinary(map.grid());
  // Keyframes that the graph does not have yet, and those that moved by less than half a cell, make a difference.
  std::size_t walls = 0, found = 0;
  for (int k = 0; k < drawn.height; ++k)
    for (int i = 0; i < drawn.width; ++i) {
      if (drawn.at(i, k) != CellState::kOccupied) continue;
      ++walls;
      const int ci = i + static_cast<int>(std::lround((drawn.origin.x - live.origin.x) / drawn.resolution_m));
      const int ck = k + static_cast<int>(std::lround((drawn.origin.y - live.origin.y) / drawn.resolution_m));
      if (ci >= 0 && ck >= 0 && ci < live.width && ck < live.height)
        found += live.at(ci, ck) == CellState::kOccupied ? 1 : 0;
    }
  EXPECT_GT(walls, 500U);
  EXPECT_GT(found, 9 * walls / 10);
}

TEST_F(ViewerTest, ScansArriveAsTheyWereMeasured) {
  const auto page = open();
  const live::LiveUpdate& update = tour_updates()[20];
  viewer.take(update);
  const Pose2 pose = update.update.T_map_base();
  EXPECT_NEAR(page->pose.x, pose.x, 1e-5);
  EXPECT_NEAR(page->pose.theta, pose.theta, 1e-6);
  EXPECT_EQ(page->status, static_cast<int>(update.update.status));
  const Scan& scan = update.measurement->scan;
  ASSERT_EQ(page->hits.size(), scan.hit_count());
  std::size_t hit = 0;
  for (std::size_t i = 0; i < scan.size(); ++i) {
    if (!scan.is_hit(i)) continue;
    EXPECT_NEAR(page->hits[hit].first, static_cast<double>(scan.ranges[i]) * std::cos(scan.angle(i)), 0.003);
    EXPECT_NEAR(page->hits[hit++].second, static_cast<double>(scan.ranges[i]) * std::sin(scan.angle(i)), 0.003);
  }
}

TEST_F(ViewerTest, WhatTheRobotMovesDuringATurnBendsNoScan) {
  const auto page = open();
  live::LiveUpdate update = tour_updates()[20];
  auto moving = std::make_shared<RangeMeasurement>(*update.measurement);
  moving->scan.time_increment = 0.1 / static_cast<double>(moving->scan.size());
  update.measurement = moving;
  update.update.twist = {0.4, 0.0, 1.5};
  viewer.take(update);
  const Scan& scan = moving->scan;
  ASSERT_EQ(page->hits.size(), scan.hit_count());
  std::size_t hit = 0;
  double most = 0.0;
  for (std::size_t i = 0; i < scan.size(); ++i) {
    if (!scan.is_hit(i)) continue;
    const double range = static_cast<double>(scan.ranges[i]);
    const Eigen::Vector2d raw(range * std::cos(scan.angle(i)), range * std::sin(scan.angle(i)));
    const Eigen::Vector2d seen = exp_twist(update.update.twist, static_cast<double>(i) * scan.time_increment) * raw;
    EXPECT_NEAR(page->hits[hit].first, seen.x(), 0.003);
    EXPECT_NEAR(page->hits[hit++].second, seen.y(), 0.003);
    most = std::max(most, (seen - raw).norm());
  }
  EXPECT_GT(most, 0.2);
}

TEST_F(ViewerTest, ABusyClientGetsTheMapLaterAndOldScansNever) {
  const auto quick = open();
  const auto busy = open();
  busy->busy = true;
  for (const live::LiveUpdate& update : tour_updates()) viewer.take(update);
  viewer.on_tick();
  EXPECT_EQ(busy->scans, 0);
  EXPECT_TRUE(busy->tiles.empty());
  busy->busy = false;
  viewer.on_drained(busy);
  EXPECT_EQ(busy->tiles, quick->tiles);
  EXPECT_EQ(busy->path, quick->path);
}

TEST_F(ViewerTest, WhatIsNotOnTheMapIsNotDrawnOnIt) {
  const auto page = open();
  std::size_t changed = 0;
  for (live::LiveUpdate update : tour_updates()) {
    const bool keyframe = update.update.keyframe.has_value();
    update.on_map = false;
    update.map.reset();
    viewer.take(update);
    changed += keyframe ? 1 : 0;
  }
  EXPECT_GT(changed, 10U);
  EXPECT_TRUE(page->tiles.empty());
  EXPECT_TRUE(page->path.empty());
  EXPECT_EQ(page->scans, static_cast<int>(tour_updates().size())) << "scans are shown all the same";
}

TEST_F(ViewerTest, AMapThatBeginsAnewIsTakenAway) {
  const auto page = open();
  for (const live::LiveUpdate& update : tour_updates()) viewer.take(update);
  live::LiveUpdate again = tour_updates().front();
  again.restarted = true;
  viewer.take(again);
  const auto fresh = open();
  const auto known = [](const Page& p) {
    std::set<TileIndex> tiles;
    for (const auto& [at, levels] : p.tiles)
      if (!levels.empty()) tiles.insert(at);
    return tiles;
  };
  EXPECT_EQ(known(*page), known(*fresh));
  EXPECT_EQ(page->path.size(), fresh->path.size());
  EXPECT_LT(page->path.size(), 2U);
  EXPECT_TRUE(page->loops.empty());
}

TEST_F(ViewerTest, CommandsAreCheckedAndAnswered) {
  const auto page = open();
  const auto ask = [&](const std::string& text) {
    page->texts.clear();
    viewer.on_message(page, text, false);
    EXPECT_EQ(page->texts.size(), 1U);
    return page->texts.empty() ? nlohmann::json{} : page->texts.back();
  };
  EXPECT_EQ(ask(R"({"id": 7, "do": "set_pose", "x": 1.5, "y": 2, "theta": 7})")["id"], 7);
  EXPECT_EQ(control.done_.back(), "set_pose 1.500000");
  EXPECT_EQ(ask(R"({"id": 8, "do": "save", "name": "flat-2"})")["ok"], true);
  EXPECT_EQ(control.done_.back(), "save flat-2");
  const std::size_t before = control.done_.size();
  for (const char* text :
       {"", "x", "[]", "7", "{}", R"({"do": 7})", R"({"do": "format"})", R"({"do": "set_pose", "x": 1, "y": 2})",
        R"({"do": "set_pose", "x": 1e999, "y": 2, "theta": 0})", R"({"do": "set_pose", "x": "1", "y": 2, "theta": 0})",
        R"({"do": "save", "name": "../x"})", R"({"do": "record", "name": "a/b"})", R"({"do": "speed", "value": -1})",
        R"({"do": "seek", "value": 1.5})", R"({"do": "seek"})"})
    EXPECT_EQ(ask(text)["ok"], false) << text;
  viewer.on_message(page, "\x01\x02", true);
  EXPECT_EQ(page->texts.back()["ok"], false) << "binary";
  EXPECT_EQ(control.done_.size(), before) << "none of them was done";
}

TEST_F(ViewerTest, ThePictureIsOfTheMap) {
  for (const live::LiveUpdate& update : tour_updates()) viewer.take(update);
  const std::string png = viewer.png();
  EXPECT_EQ(png.substr(1, 3), "PNG");
  EXPECT_EQ(png, viewer.png());
}

TEST(StatusBoard, SaysWhatAMonitorAsks) {
  StatusBoard board("test");
  auto json = nlohmann::json::parse(to_json(board.status(), {}));
  EXPECT_EQ(json["state"], "waiting");
  for (const live::LiveUpdate& update : tour_updates()) board.take(update);
  board.tell("\xFF is no UTF-8");
  json = nlohmann::json::parse(to_json(board.status(), {true, false, false, "drive", ReplayState{1.0, 2.0, 0.5}}));
  EXPECT_EQ(json["state"], "ok");
  EXPECT_EQ(json["scans"], tour_updates().size());
  EXPECT_EQ(json["covariance"].size(), 9U);
  EXPECT_GT(json["loops"], 0);
  EXPECT_GT(json["path_m"], 5.0);
  EXPECT_EQ(json["can"]["set_pose"], true);
  EXPECT_EQ(json["recording"], "drive");
  EXPECT_EQ(json["replay"]["speed"], 0.5);
  EXPECT_THAT(json["messages"].back()["text"].get<std::string>(), HasSubstr("is no UTF-8"));
}

/// Round after round through rooms that are known: what clients are shown is of the place, not of the time.
TEST(LiveMapOfALongRun, HoldsNoMoreAfterTenRoundsThanAfterFour) {
  SlamOptions options;
  options.slam.bounded_memory = true;
  const auto begin = [&options] { return Slam(options, Schedule::kLatest); };
  Slam slam = begin();
  const auto engine = live::slam_engine(slam, begin);
  const auto walls = two_rooms();
  const auto tour = toy_tour(0.2, 0.4, 1.0);
  Random random(5);
  LiveMap map{options};
  std::size_t early = 0, late = 0;
  int scans = 0;
  for (int round = 0; round < 10; ++round) {
    for (std::size_t i = 0; i < tour.size(); i += 2) {
      const Scan scan = toy_scan(walls, tour[i], {}, random, stamp_from_seconds(100.0 + 0.4 * ++scans));
      map.add(engine->add(std::make_shared<const RangeMeasurement>(RangeMeasurement{scan})));
      std::size_t& most = round < 4 ? early : late;
      most = std::max(most, map.path().size() + map.loops().size());
    }
  }
  EXPECT_LE(late, early + 5);
}

}  // namespace
}  // namespace phasescan::serve::viewer_test
