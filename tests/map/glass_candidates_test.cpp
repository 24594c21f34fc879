// What of a single scan may be glass or black: pieces of a wall seen from the origin, beams one degree apart.
#include "map/glass_candidates.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace phasescan::glass_candidates_test {
namespace {

/// A wall x = `at` between y = low and y = high.
struct Facet {
  double at, low, high;
};

/// Candidates that so many equal scans of the pieces show. Beams between them come back from nowhere.
std::vector<GlassCandidate> candidates(const std::vector<Facet>& pieces, int scans) {
  std::vector<float> ranges;
  for (int k = -180; k < 180; ++k) {
    float range = 0.0F;
    for (const Facet& piece : pieces) {
      const double y = piece.at * std::tan(deg_to_rad(k));
      if (std::abs(k) < 90 && y >= piece.low && y <= piece.high)
        range = static_cast<float>(piece.at / std::cos(deg_to_rad(k)));
    }
    ranges.push_back(range);
  }
  PlacedScan view;
  view.scan = make_scan(ranges, {-kPi, deg_to_rad(1.0), 0.1, 12.0});
  GlassCandidates found{GlassOptions()};
  double step_rad = 0.0;
  for (int k = 0; k < scans; ++k) {
    const std::vector<ViewRay> rays = view_rays(view, &step_rad);
    found.add(rays, step_rad);
  }
  return found.take();
}

TEST(GlassCandidates, APieceSeenHeadOnOnlyInThreeScansIsOne) {
  const std::vector<Facet> narrow = {{2.0, -0.4, 0.4}};
  EXPECT_EQ(candidates(narrow, 3).size(), 1u);
  EXPECT_TRUE(candidates(narrow, 2).empty()) << "two scans are chance";
}

TEST(GlassCandidates, APieceBetweenNearerThingsIsNone) {
  EXPECT_TRUE(candidates({{2.0, -0.4, 0.4}, {1.4, -2.0, -0.3}, {1.4, 0.3, 2.0}}, 3).empty());
}

TEST(GlassCandidates, WhatAnswersUnderAWideAngleIsASurfaceLikeOthers) {
  EXPECT_TRUE(candidates({{2.0, -2.0, 2.0}}, 3).empty());
}

TEST(GlassCandidates, AGapIsOneWhereItsWallGoesOnInOneLine) {
  const std::vector<GlassCandidate> gap = candidates({{2.0, -2.0, -0.3}, {2.0, 0.3, 2.0}}, 3);
  ASSERT_EQ(gap.size(), 1u);
  EXPECT_TRUE(gap[0].gap);
  EXPECT_TRUE(candidates({{2.0, -2.0, -0.3}, {2.3, 0.3, 2.0}}, 3).empty()) << "two walls, one behind the other";
}

}  // namespace
}  // namespace phasescan::glass_candidates_test
