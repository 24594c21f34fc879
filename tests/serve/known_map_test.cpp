// A map that was there before the run: shown as it is, with the way, the places where the robot may be, and what is
// known of it.
#include <gtest/gtest.h>

#include "serve/page_client.hpp"
#include "serve/status_board.hpp"
#include "serve/viewer.hpp"
#include "support/toy_map.hpp"

namespace phasescan::serve {
namespace {

class KnownMap final : public MapSnapshot {
 public:
  explicit KnownMap(TrinaryMap map) : map_(std::move(map)) {}
  std::uint64_t version() const override { return 1; }
  const Pose2& T_map_odom() const override { return none_; }
  std::vector<MapKeyframe> keyframes() const override { return {}; }
  TrinaryMap draw() const override { return map_; }

 private:
  TrinaryMap map_;
  Pose2 none_;
};

live::LiveUpdate located(const std::shared_ptr<const MapSnapshot>& map, TrackingStatus status, const Pose2& pose) {
  live::LiveUpdate update;
  update.map = map;
  update.measurement = std::make_shared<const RangeMeasurement>();
  update.update.status = status;
  update.update.T_map_odom = pose;
  LocalizationUpdate& at = update.located.emplace();
  at.status = status;
  at.T_map_base = pose;
  at.hypotheses.push_back({pose, Eigen::Matrix3d::Identity(), 0.9});
  return update;
}

/// Level of the cell in which a point lies; 0 where no tile covers it.
int level_at(const Page& page, double cell_m, const Eigen::Vector2d& point) {
  const int i = static_cast<int>(std::floor(point.x() / cell_m)), k = static_cast<int>(std::floor(point.y() / cell_m));
  const TileIndex at{static_cast<int>(std::floor(i / 64.0)), static_cast<int>(std::floor(k / 64.0))};
  const auto tile = page.tiles.find(at);
  if (tile == page.tiles.end() || tile->second.empty()) return 0;
  return tile->second[static_cast<std::size_t>((k - 64 * at.second) * 64 + i - 64 * at.first)];
}

class KnownMapViewer : public ::testing::TestWithParam<double> {
 protected:
  Obedient control;
};

/// With any heading of its origin: every cell of the map is where it belongs.
TEST_P(KnownMapViewer, IsShownAsItIs) {
  const TrinaryMap map = testing::toy_map(testing::two_rooms(), {0, 0}, 0.05, GetParam());
  const auto known = std::make_shared<const KnownMap>(map);
  SlamOptions options;
  options.map.resolution_m = map.resolution_m;
  Viewer viewer(options, control, [] { return std::string("{}"); });
  const auto early = std::make_shared<Page>(), late = std::make_shared<Page>();
  viewer.on_open(early, "");
  viewer.on_drained(early);
  viewer.take(located(known, TrackingStatus::kOk, {1.0, 0.0, 0.0}));
  viewer.on_open(late, "");
  viewer.on_drained(late);
  EXPECT_EQ(early->tiles, late->tiles);
  std::size_t wrong = 0, walls = 0;
  // The viewer's cells lie across those of a turned map: one shows what the map has at its own centre.
  for (int k = -200; k < 200; ++k)
    for (int i = -300; i < 300; ++i) {
      const Eigen::Vector2d point((i + 0.5) * map.resolution_m, (k + 0.5) * map.resolution_m);
      const Eigen::Vector2d cell = map.origin.inverse() * point / map.resolution_m;
      const int column = static_cast<int>(std::floor(cell.x())), row = static_cast<int>(std::floor(cell.y()));
      const bool inside = column >= 0 && row >= 0 && column < map.width && row < map.height;
      const CellState state = inside ? map.at(column, row) : CellState::kUnknown;
      const int level = level_at(*early, map.resolution_m, point);
      walls += level >= 10;
      wrong += state != (level >= 10 ? CellState::kOccupied : level > 0 ? CellState::kFree : CellState::kUnknown);
    }
  EXPECT_GT(walls, 300U);
  EXPECT_EQ(wrong, 0U);
}
INSTANTIATE_TEST_SUITE_P(Headings, KnownMapViewer, ::testing::Values(0.0, 0.6, -2.0));

/// A page that is open on a toy map.
class KnownMapPage : public ::testing::Test {
 protected:
  KnownMapPage() {
    viewer.on_open(page, "");
    viewer.on_drained(page);
  }

  Obedient control;
  Viewer viewer{SlamOptions{}, control, [] { return std::string("{}"); }};
  const std::shared_ptr<Page> page = std::make_shared<Page>();
  const std::shared_ptr<const KnownMap> known =
      std::make_shared<const KnownMap>(testing::toy_map(testing::two_rooms(), {0, 0}));
};

TEST_F(KnownMapPage, TheWayIsDrawnWhereThePoseIsOneToGoBy) {
  for (int i = 0; i < 100; ++i) viewer.take(located(known, TrackingStatus::kAmbiguous, {0.1 * i, 0.0, 0.0}));
  EXPECT_TRUE(page->path.empty());
  for (int i = 0; i < 100; ++i) viewer.take(located(known, TrackingStatus::kOk, {0.1 * i, 1.0, 0.0}));
  EXPECT_GT(page->path.size(), 30U);
  EXPECT_LT(page->path.size(), 60U);
  // A run of days.
  for (int i = 0; i < 20000; ++i) viewer.take(located(known, TrackingStatus::kOk, {0.3 * (i % 50), 1.0, 0.0}));
  EXPECT_LE(page->path.size(), 4000U);
  EXPECT_GT(page->path.size(), 2000U);
}

TEST_F(KnownMapPage, PlacesWhereTheRobotMayBeAreShownUntilOneIsLeft) {
  live::LiveUpdate update = located(known, TrackingStatus::kAmbiguous, {1.0, 0.0, 0.0});
  update.located->hypotheses.push_back({{4.0, 1.0, 2.0}, Eigen::Matrix3d::Identity(), 0.4});
  viewer.take(update);
  ASSERT_EQ(page->hypotheses.size(), 2U);
  EXPECT_NEAR(page->hypotheses[1].x, 4.0, 1e-6);
  EXPECT_NEAR(page->hypotheses[1].theta, 2.0, 1e-6);
  const auto late = std::make_shared<Page>();
  viewer.on_open(late, "");
  EXPECT_EQ(late->hypotheses.size(), 2U);
  StatusBoard board("test");
  board.take(update);
  const auto json = nlohmann::json::parse(to_json(board.status(), {}));
  EXPECT_EQ(json["known_map"], true);
  EXPECT_EQ(json["hypotheses"], 2);
  EXPECT_EQ(json["state"], "ambiguous");
  viewer.take(located(known, TrackingStatus::kOk, {1.0, 0.0, 0.0}));
  EXPECT_TRUE(page->hypotheses.empty());
  EXPECT_TRUE(late->hypotheses.empty());
}

}  // namespace
}  // namespace phasescan::serve
