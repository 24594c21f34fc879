// Bounded memory: the map stays one when the tracker slips, and stops growing where everything was seen.
#include <gtest/gtest.h>

#include <cmath>

#include "slam/backend.hpp"
#include "support/toy_world.hpp"

namespace phasescan::bounded_test {
namespace {

using testing::toy_scan;
using testing::toy_tour;
using testing::two_rooms;

struct Drive {
  std::vector<Keyframe> keyframes;
  std::vector<Pose2> truth;
};

/// Keyframes of some laps through two rooms. The tracker slips by `slip` where a share of the drive is done, and does
/// not notice.
Drive drive_that_slips(int laps, double share, const Pose2& slip) {
  const auto walls = two_rooms();
  const auto tour = toy_tour(0.5, 0.4, 0.5, laps);
  Random random(6);
  SurfaceWorkspace work;
  SurfacePoints surface;
  Drive out;
  const auto slips_at = static_cast<std::size_t>(share * static_cast<double>(tour.size()));
  for (std::size_t i = 0; i < tour.size(); ++i) {
    find_surface(toy_scan(walls, tour[i], {}, random, 0), {}, work, surface);
    auto points = std::make_shared<MapPoints>();
    to_map_points(surface, {}, 30.0, *points);
    Keyframe keyframe;
    keyframe.points = std::make_shared<const KeyframePoints>(*points);
    keyframe.T_odom_base = i < slips_at ? tour[i] : tour[slips_at] * slip * tour[slips_at].inverse() * tour[i];
    keyframe.information = Eigen::Vector3d(1e4, 1e4, 1e5).asDiagonal();
    keyframe.scan = static_cast<std::int64_t>(i);
    for (std::size_t k = 0; k < points->size(); ++k) keyframe.centre += Eigen::Vector2d(points->x[k], points->y[k]);
    keyframe.centre /= static_cast<double>(points->size());
    out.keyframes.push_back(std::move(keyframe));
    out.truth.push_back(tour[i]);
  }
  return out;
}

struct Outcome {
  double last_m = 0.0;         ///< how far the last keyframe is off
  std::size_t far_off = 0;     ///< keyframes more than 0.2 m off
  std::size_t nodes = 0;       ///< at the end
  std::size_t nodes_half = 0;  ///< when half of the keyframes had come
};

Outcome map_of(const Drive& drive) {
  SlamOptions options;
  options.slam.bounded_memory = true;
  Backend backend(options);
  Outcome out;
  for (std::size_t from = 0; from < drive.keyframes.size(); from += 10) {
    const std::size_t to = std::min(drive.keyframes.size(), from + 10);
    backend.add_batch({drive.keyframes.begin() + static_cast<std::ptrdiff_t>(from),
                       drive.keyframes.begin() + static_cast<std::ptrdiff_t>(to)});
    if (from <= drive.keyframes.size() / 2) out.nodes_half = backend.keyframes().size();
  }
  backend.finish();
  out.nodes = backend.keyframes().size();
  EXPECT_EQ(backend.submitted(), drive.keyframes.size());
  for (std::size_t i = 0; i < backend.submitted(); ++i) {
    out.last_m = translation_distance(backend.submitted_pose(i), drive.truth[i]);
    out.far_off += out.last_m > 0.2;
  }
  return out;
}

TEST(Bounded, ATrackerThatSlippedFindsItsPlaceAndMakesNoSecondMap) {
  const Outcome straight = map_of(drive_that_slips(6, 2.0, {}));
  EXPECT_LT(straight.last_m, 0.05);
  EXPECT_EQ(straight.far_off, 0U);
  for (const Pose2& slip : {Pose2{1.5, 0.0, 0.0}, Pose2{-0.4, 0.3, 0.1}}) {
    const Outcome slipped = map_of(drive_that_slips(6, 0.6, slip));
    EXPECT_LT(slipped.last_m, 0.05);
    EXPECT_LT(slipped.far_off, 25U);
    EXPECT_LE(slipped.nodes, straight.nodes + 6U);
  }
}

TEST(Bounded, NothingIsAddedWhereEverythingWasSeen) {
  const Outcome out = map_of(drive_that_slips(8, 2.0, {}));
  EXPECT_LE(out.nodes, out.nodes_half + 2U);
  // Two rooms of 60 square metres: some keyframes to each patch of a few.
  EXPECT_LT(out.nodes, 60U);
}

}  // namespace
}  // namespace phasescan::bounded_test
