// The slow search beside the fast one: what it finds holds, and it misses nothing.
#include "localize/search_everywhere.hpp"

#include <gtest/gtest.h>

#include "support/toy_map.hpp"

namespace phasescan::search_everywhere_test {
namespace {

TEST(SearchEverywhere, FindsTheTruthAndNothingLikelierThanItsBest) {
  const auto walls = testing::two_rooms();
  const LocalizationMap map = LocalizationMap::from_grid(testing::toy_map(walls, {0, 0}));
  const LocalizationMap::Data& data = map.data();
  Random random(11);
  QueryWorkspace work;
  GlobalSearchWorkspace fast;
  for (const Pose2& truth : {Pose2{0.4, -0.6, 2.0}, Pose2{5.2, 0.3, -1.1}}) {
    const RangeMeasurement measurement{testing::toy_scan(walls, truth, testing::ToyLidar{}, random, 0), "", {}, {}};
    const QueryScan scan = prepare_query(measurement, {}, 8.0, true, work);
    const auto [all, finished] = search_everywhere(data, scan, 6.0);
    EXPECT_TRUE(finished);
    EXPECT_FALSE(search_everywhere(data, scan, 6.0, 1000).finished);
    ASSERT_FALSE(all.empty());
    const Pose2 best = data.T_map_grid * all.front().T_grid_base;
    EXPECT_LT(translation_distance(best, truth), 0.05);
    EXPECT_LT(angle_distance(best.theta, truth.theta), deg_to_rad(1.5));
    for (std::size_t i = 1; i < all.size(); ++i) {
      EXPECT_LE(all[i].fit.log_likelihood, all[i - 1].fit.log_likelihood);
      EXPECT_GE(all[i].fit.log_likelihood, all.front().fit.log_likelihood - 6.0);
    }
    for (const FoundPose& pose : search_map(data, scan, {}, fast))
      EXPECT_LT(pose.fit.log_likelihood, all.front().fit.log_likelihood + 1.0) << "missed by the slow search";
  }
}

}  // namespace
}  // namespace phasescan::search_everywhere_test
