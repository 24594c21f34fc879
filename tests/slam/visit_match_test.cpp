// A keyframe matched with the map of a visit: guesses that are off, and corridors.
#include "slam/visit_match.hpp"

#include <gtest/gtest.h>

#include "support/toy_keyframes.hpp"

namespace phasescan::visit_match_test {
namespace {

LocalMap map_of(const MapPoints& points) {
  LocalMap map;
  map.reset({}, 20.0, 0.1);
  map.add(points, {});
  map.finish();
  return map;
}

void add_hit(MapPoints& points, double x, double y, double nx, double ny) {
  points.x.push_back(static_cast<float>(x));
  points.y.push_back(static_cast<float>(y));
  points.nx.push_back(static_cast<float>(nx));
  points.ny.push_back(static_cast<float>(ny));
  points.variance.push_back(1e-4F);
  points.normal_variance.push_back(1e-4F);
  points.free_standing.push_back(0);
  ++points.with_normal;
}

/// Two bare walls of 12 m, and a door frame on either side: `on_frames` of 200 hits lie on these.
MapPoints corridor(int on_frames) {
  MapPoints points;
  const int on_walls = 200 - on_frames;
  for (int k = 0; k < on_walls; ++k) {
    const double side = k % 2 == 0 ? 1.0 : -1.0;
    add_hit(points, -6.0 + 12.0 * k / on_walls, side, 0.0, -side);
  }
  for (int k = 0; k < on_frames; ++k) {
    const double side = k % 2 == 0 ? 1.0 : -1.0;
    add_hit(points, 2.0, side * (0.5 + 0.45 * k / on_frames), -1.0, 0.0);
  }
  return points;
}

MapPoints room(const Pose2& at) {
  Random random(3);
  MapPoints points;
  testing::toy_keyframes(testing::two_rooms(), {at}, random)[0].points->unpack(points);
  return points;
}

TEST(VisitMatch, AlongACorridorTheKeyframeIsMovedToWhereMoreOfItFits) {
  const MapPoints points = corridor(40);
  const LocalMap map = map_of(points);
  for (const double off : {-0.7, -0.5, 0.5, 0.8}) {
    const auto found = match_visit(map, points, {off, 0.02, 0.0}, 0.0, 0.55);
    ASSERT_TRUE(found) << off << ": its walls fit anywhere";
    EXPECT_NEAR(found->T_map_base.x, 0.0, 0.02) << off;
    EXPECT_GT(found->overlap, 0.95) << off;
  }
}

TEST(VisitMatch, WhatFitsPoorlyIsNoVisitEvenWhereItWouldFitFartherAlong) {
  const MapPoints points = corridor(120);
  const LocalMap map = map_of(points);
  const Pose2 guess{0.5, 0.02, 0.0};
  ASSERT_NEAR(register_points(map, points, guess).overlap, 0.4, 0.05);
  EXPECT_FALSE(match_visit(map, points, guess, 0.0, 0.55));
  EXPECT_TRUE(match_visit(map, points, guess, 0.0, 0.3));
}

TEST(VisitMatch, AroundAGuessThatMayBeFarOffPosesAreTried) {
  const LocalMap map = map_of(room({0.0, 0.0, 0.0}));
  const Pose2 truth{0.1, 0.05, 0.1};
  const MapPoints points = room(truth);
  const Pose2 guess{truth.x + 0.7, truth.y - 0.6, truth.theta + 0.1};
  EXPECT_FALSE(match_visit(map, points, guess, 0.0, 0.55)) << "said to be right where it is";
  const auto found = match_visit(map, points, guess, 1.0, 0.55);
  ASSERT_TRUE(found);
  EXPECT_LT(translation_distance(found->T_map_base, truth), 0.02);
  EXPECT_LT(angle_distance(found->T_map_base.theta, truth.theta), 0.01);
}

TEST(VisitMatch, AnEdgeHoldsThePositionWhereItsWeakestDirectionIsKnownToADecimetre) {
  const auto turned = [](double sigma_a, double sigma_b) {
    const double c = std::cos(0.7), s = std::sin(0.7);
    Eigen::Matrix2d R;
    R << c, -s, s, c;
    Eigen::Matrix3d information = 1e5 * Eigen::Matrix3d::Identity();
    information.topLeftCorner<2, 2>() =
        R * Eigen::Vector2d(1.0 / (sigma_a * sigma_a), 1.0 / (sigma_b * sigma_b)).asDiagonal() * R.transpose();
    return information;
  };
  EXPECT_TRUE(holds_position(turned(0.02, 0.03)));
  EXPECT_TRUE(holds_position(turned(0.09, 0.01)));
  EXPECT_FALSE(holds_position(turned(0.12, 0.01)));
  EXPECT_FALSE(holds_position(turned(0.01, 3.0))) << "a bare corridor";
}

}  // namespace
}  // namespace phasescan::visit_match_test
