// Glass and black surfaces in simulated rooms, seen from known poses.
#include "map/glass.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "sim/lidar.hpp"

namespace phasescan::glass_test {
namespace {

using Eigen::Vector2d;
using sim::Material;

/// What stands at x = 4 between y = 1 and y = 3, in the wall between two rooms.
enum class Piece { kMatt, kGlass, kBlack, kDoor, kDoorToNothing };

sim::Shape rooms(Piece piece) {
  sim::Shape shape;
  shape.add_line({{4, 0}, {0, 0}, {0, 5}, {4, 5}});
  if (piece != Piece::kDoorToNothing) shape.add_line({{4, 0}, {8, 0}, {8, 5}, {4, 5}});
  shape.add_line({{4, 0}, {4, 1}});
  shape.add_line({{4, 3}, {4, 5}});
  shape.add_box({6.5, 4.7}, 1.0, 0.5);
  shape.add_box({0.3, 2.0}, 0.5, 1.2);  // a cupboard is seen head on as well, and beams pass it by
  shape.add_disc({2.0, 4.4}, 0.15);
  if (piece == Piece::kMatt) shape.add_line({{4, 1}, {4, 3}});
  if (piece == Piece::kGlass) shape.add_line({{4, 1}, {4, 3}}, Material::kGlass);
  if (piece == Piece::kBlack) shape.add_line({{4, 1}, {4, 3}}, Material::kBlack);
  return shape;
}

struct Seen {
  std::vector<PlacedScan> scans;
  std::vector<Pose2> way;
  OccupancyGrid grid;
};

/// A round in the left room, with an RPLidar A1.
Seen drive(const sim::Shape& shape) {
  const sim::RayCaster caster(shape);
  const sim::LidarOptions lidar;
  Random random(11);
  Seen seen;
  for (const auto& [from, to] : {std::pair<Vector2d, Vector2d>{{1.2, 0.6}, {3.0, 0.7}},
                                 {{3.0, 0.7}, {2.8, 3.8}},
                                 {{2.8, 3.8}, {1.3, 3.8}},
                                 {{1.3, 3.8}, {1.2, 0.6}}}) {
    const double length = (to - from).norm(), heading = std::atan2(to.y() - from.y(), to.x() - from.x());
    for (double s = 0.0; s < length; s += 0.2) {
      const Vector2d at = from + (to - from) * s / length;
      seen.way.push_back({at.x(), at.y(), heading});
      PlacedScan placed;
      placed.T_map_laser = seen.way.back();
      placed.scan = sim::simulate_scan({&caster, nullptr}, lidar, placed.T_map_laser, random);
      seen.grid.add_scan(placed.scan, placed.T_map_laser);
      seen.scans.push_back(std::move(placed));
    }
  }
  return seen;
}

std::vector<GlassPane> panes_of(const Seen& seen, const GlassOptions& options = {}) {
  return find_glass(
      seen.scans.size(), [&](std::size_t k) { return seen.scans[k]; }, seen.grid, options);
}

void expect_at_the_wall(const GlassPane& pane) {
  EXPECT_NEAR(pane.a.x(), 4.0, 0.06);
  EXPECT_NEAR(pane.b.x(), 4.0, 0.06);
  EXPECT_NEAR(std::min(pane.a.y(), pane.b.y()), 1.0, 0.3);
  EXPECT_NEAR(std::max(pane.a.y(), pane.b.y()), 3.0, 0.3);
  EXPECT_TRUE(pane.sure);
  EXPECT_GE(pane.views, 4u);
}

TEST(Glass, AGlassWallIsFoundAtItsPlace) {
  const std::vector<GlassPane> panes = panes_of(drive(rooms(Piece::kGlass)));
  ASSERT_EQ(panes.size(), 1u);
  expect_at_the_wall(panes[0]);
  EXPECT_EQ(panes[0].kind, GlassKind::kGlass);
  EXPECT_GT(panes[0].through, panes[0].vanished);
}

TEST(Glass, ABlackWallIsFoundAtItsPlace) {
  const std::vector<GlassPane> panes = panes_of(drive(rooms(Piece::kBlack)));
  ASSERT_EQ(panes.size(), 1u);
  expect_at_the_wall(panes[0]);
  EXPECT_EQ(panes[0].kind, GlassKind::kBlack);
  EXPECT_EQ(panes[0].through, 0u);
}

TEST(Glass, MattWallsAndDoorsAreNeverClaimed) {
  for (const Piece piece : {Piece::kMatt, Piece::kDoor, Piece::kDoorToNothing})
    EXPECT_TRUE(panes_of(drive(rooms(piece))).empty()) << static_cast<int>(piece);
}

TEST(Glass, ADoorOpenedLaterIsNotGlass) {
  // Closed on the first round, open on the second: hits of one time, beams going through at another.
  Seen seen = drive(rooms(Piece::kMatt));
  Seen open = drive(rooms(Piece::kDoor));
  for (PlacedScan& placed : open.scans) seen.scans.push_back(std::move(placed));
  EXPECT_TRUE(panes_of(seen).empty());
}

TEST(Glass, GlassThatIsOpenedLaterIsNotClaimedWhereItIsOpen) {
  Seen seen = drive(rooms(Piece::kGlass));
  for (int round = 0; round < 2; ++round) {
    Seen open = drive(rooms(Piece::kDoor));
    for (PlacedScan& placed : open.scans) seen.scans.push_back(std::move(placed));
  }
  EXPECT_TRUE(panes_of(seen).empty());
}

TEST(Glass, OneViewIsNotSure) {
  Seen seen = drive(rooms(Piece::kGlass));
  seen.scans.resize(12);
  for (const GlassPane& pane : panes_of(seen)) EXPECT_FALSE(pane.sure && pane.length() > 1.0);
  GlassOptions strict;
  strict.min_views = 1000;
  for (const GlassPane& pane : panes_of(drive(rooms(Piece::kGlass)), strict)) EXPECT_FALSE(pane.sure);
}

TEST(Glass, HostileScansAreTaken) {
  Seen seen = drive(rooms(Piece::kGlass));
  seen.scans[3].scan = Scan{};
  seen.scans[4].scan = make_scan(std::vector<float>(1, 2.0F), {0.0, 0.0, 0.0, 0.0});
  seen.scans[5].scan = make_scan(std::vector<float>(360, 0.0F), {0.0, deg_to_rad(1.0), 0.0, 0.0});
  EXPECT_EQ(panes_of(seen).size(), 1u);
  EXPECT_TRUE(find_glass(0, nullptr, seen.grid).empty());
}

TEST(Glass, NothingIsClaimedWhereTheRobotDrove) {
  GlassPane pane;
  pane.a = {4.0, 0.0};
  pane.b = {4.0, 3.0};
  const std::vector<Pose2> through = {{3.0, 1.0, 0.0}, {3.9, 1.0, 0.0}, {4.2, 1.0, 0.0}};
  const auto cut = cut_where_driven({pane}, through, 0.5, 0.4);
  ASSERT_EQ(cut.size(), 2u);
  EXPECT_NEAR(cut[0].b.y(), 0.5, 1e-9);
  EXPECT_NEAR(cut[1].a.y(), 1.5, 1e-9);
  EXPECT_NEAR(cut[1].b.y(), 3.0, 1e-9);
  const std::vector<Pose2> beside = {{3.0, 0.0, 0.0}, {3.0, 3.0, 0.0}};
  EXPECT_EQ(cut_where_driven({pane}, beside, 0.5, 0.4).size(), 1u);
  // Past the end of a pane is not through it; and a piece too short goes.
  const std::vector<Pose2> past = {{3.0, 4.0, 0.0}, {5.0, 4.0, 0.0}};
  EXPECT_EQ(cut_where_driven({pane}, past, 0.5, 0.4).size(), 1u);
  const std::vector<Pose2> near_the_end = {{3.9, 0.8, 0.0}, {4.1, 0.8, 0.0}};
  EXPECT_EQ(cut_where_driven({pane}, near_the_end, 0.5, 0.4).size(), 1u);
  // Even with 0 asked for, where the robot stood is free.
  EXPECT_EQ(cut_where_driven({pane}, through, 0.0, 0.4).size(), 2u);
}

TEST(Glass, WhereTheRobotStoodInAPaneItIsOpen) {
  GlassPane pane;
  pane.a = {4.0, 0.0};
  pane.b = {4.0, 3.0};
  const std::vector<Pose2> into = {{3.0, 1.0, 0.0}, {3.95, 1.0, 0.0}};
  EXPECT_EQ(cut_where_driven({pane}, into, 0.5, 0.4).size(), 2u);
}

/// Scans at one place after the other.
Seen stand(const sim::Shape& shape, const std::vector<Vector2d>& places) {
  const sim::RayCaster caster(shape);
  Random random(12);
  Seen seen;
  for (const Vector2d& at : places) {
    PlacedScan placed;
    placed.T_map_laser = {at.x(), at.y(), 0.0};
    placed.scan = sim::simulate_scan({&caster, nullptr}, sim::LidarOptions(), placed.T_map_laser, random);
    seen.grid.add_scan(placed.scan, placed.T_map_laser);
    seen.scans.push_back(std::move(placed));
  }
  return seen;
}

TEST(Glass, FromAlmostOnePlaceNoPaneIsSure) {
  // A thing in front of the wall would look the same from there.
  std::vector<Vector2d> places;
  for (int k = 0; k < 14; ++k) places.push_back({3.5, 1.83 + 0.025 * k});
  const std::vector<GlassPane> panes = panes_of(stand(rooms(Piece::kGlass), places));
  ASSERT_FALSE(panes.empty());
  for (const GlassPane& pane : panes) EXPECT_FALSE(pane.sure);
}

TEST(Glass, APaneThatWasFacedInItsMiddleGoesOnToItsFrame) {
  std::vector<Vector2d> places;
  for (int k = 0; k < 17; ++k) places.push_back({2.6, 1.6 + 0.05 * k});
  double low = 9.0, high = 0.0;
  for (const GlassPane& pane : panes_of(stand(rooms(Piece::kGlass), places))) {
    low = std::min({low, pane.a.y(), pane.b.y()});
    high = std::max({high, pane.a.y(), pane.b.y()});
  }
  EXPECT_NEAR(low, 1.0, 0.12);
  EXPECT_NEAR(high, 3.0, 0.12);
}

TEST(Glass, WhatAnswersHeadOnAndLetsNothingThroughIsBlack) {
  // Glass before nothing within reach: beams vanish behind it, as they do in what swallows them.
  sim::Shape shape = rooms(Piece::kDoorToNothing);
  shape.add_line({{4, 1}, {4, 3}}, Material::kGlass);
  const std::vector<GlassPane> panes = panes_of(drive(shape));
  ASSERT_EQ(panes.size(), 1u);
  EXPECT_EQ(panes[0].kind, GlassKind::kBlack);
}

TEST(Glass, APaneSeenTwiceFromPosesThatDriftedIsOneWhereMoreScansShowIt) {
  const Seen seen = drive(rooms(Piece::kGlass));
  for (const bool more_at_first : {true, false}) {
    Seen both;
    const std::size_t half = seen.scans.size();
    for (std::size_t k = 0; k < 2 * half; ++k) {
      // Of one of the two rounds every third scan is left out.
      const bool first = k < half;
      if (first != more_at_first && k % 3 == 0) continue;
      PlacedScan placed = seen.scans[k % half];
      if (!first) placed.T_map_laser.x += 0.12;
      both.scans.push_back(placed);
      both.grid.add_scan(placed.scan, placed.T_map_laser);
    }
    const std::vector<GlassPane> panes = panes_of(both);
    ASSERT_EQ(panes.size(), 1u) << more_at_first;
    EXPECT_NEAR(0.5 * (panes[0].a.x() + panes[0].b.x()), more_at_first ? 4.0 : 4.12, 0.04);
  }
}

TEST(Glass, CellsOfAPane) {
  TrinaryMap map;
  map.width = 10;
  map.height = 8;
  map.resolution_m = 0.1;
  map.origin = {1.0, 2.0, 0.0};
  map.cells.assign(80, CellState::kFree);
  GlassPane pane;
  pane.a = {1.25, 2.05};
  pane.b = {1.25, 2.35};
  EXPECT_EQ(cells_of(map, pane), (std::vector<std::size_t>{2, 12, 22, 32}));
  pane.a = {-5.0, 2.05};
  EXPECT_FALSE(cells_of(map, pane).empty());
}

}  // namespace
}  // namespace phasescan::glass_test
