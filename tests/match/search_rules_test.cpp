// Rules of the global search that an easy room hardly shows: which rotations are listed, which poses of the sweep are
// looked at more closely, what happens where nothing convinces.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "match/global_search.hpp"
#include "match/hypothesis_list.hpp"
#include "support/rooms.hpp"
#include "support/toy_world.hpp"

namespace phasescan::search_rules_test {
namespace {

PreparedScan prepared_for(const GlobalSearch& search, const Scan& scan) {
  PreparedScan out;
  PrepareWorkspace work;
  prepare_scan(scan, {}, search.prepare_options(true), work, out);
  return out;
}

/// The sweep as it is: every rotation, poses not refined, as many candidates and finalists as there are.
GlobalOptions bare_sweep() {
  GlobalOptions options;
  options.rotations = RotationSearch::kSweep;
  options.refinement = options.twins = false;
  options.candidates = options.finalists = 100;
  return options;
}

SearchOutcome search(const GlobalOptions& options, const Scan& reference, const Scan& scan,
                     const std::optional<Pose2>& guess = {}) {
  GlobalSearch global(options);
  SearchOutcome out;
  global.run(prepared_for(global, reference), prepared_for(global, scan), guess, nullptr, out);
  return out;
}

TEST(Rotations, AGuessIsTriedAtEveryHeadingAroundIt) {
  const GlobalOptions options;
  RotationHypotheses rotations(options);
  std::vector<RotationHypothesis> found;
  rotations.list({}, {}, Pose2{0.0, 0.0, 0.4}, nullptr, found);
  ASSERT_EQ(found.size(), 17u) << "6 deg apart, up to 48 deg to either side";
  for (std::size_t k = 0; k < found.size(); ++k) {
    EXPECT_NEAR(found[k].theta, 0.4 + deg_to_rad(6.0 * (static_cast<double>(k) - 8.0)), 1e-9);
    EXPECT_EQ(found[k].source, RotationSource::kGuess);
  }
}

TEST(Rotations, WhereNormalsHaveNothingToSayEveryHeadingIsTried) {
  // Hits so far from each other that no line goes through any of them.
  std::vector<float> ranges;
  for (int k = 0; k < 360; ++k) ranges.push_back(k % 30 == 0 ? (k % 60 == 0 ? 1.0F : 4.0F) : 0.0F);
  const GlobalOptions options;
  const GlobalSearch global(options);
  const PreparedScan lone = prepared_for(global, make_scan(ranges, {0.0, kTwoPi / 360, 0.1, 6.0}));
  ASSERT_EQ(lone.size(), 12u);
  RotationHypotheses rotations(options);
  std::vector<RotationHypothesis> found;
  rotations.list(lone, lone, std::nullopt, nullptr, found);
  EXPECT_EQ(found.size(), 60u);
}

/// The largest sum of the sweep, hit by hit: what lies outside of the table counts as unknown.
int largest_sum(const PreparedScan& reference, const PreparedScan& scan) {
  const ScoreTable& table = reference.table;
  int best = 0;
  for (int turn = 0; turn < 60; ++turn) {
    const double c = std::cos(kTwoPi * turn / 60), s = std::sin(kTwoPi * turn / 60);
    for (int row = -16; row < 16; ++row) {
      for (int column = -16; column < 16; ++column) {
        int sum = 0;
        for (std::size_t i = 0; i < scan.sparse.count; ++i) {
          const double x = static_cast<double>(scan.sparse.x[i]), y = static_cast<double>(scan.sparse.y[i]);
          const int u = static_cast<int>(std::floor(table.position(static_cast<float>(c * x - s * y)))) + column,
                    v = static_cast<int>(std::floor(table.position(static_cast<float>(s * x + c * y)))) + row;
          const bool inside = u >= 0 && v >= 0 && u < ScoreTable::kStride && v < ScoreTable::kStride;
          sum += inside ? table.data()[v * ScoreTable::kStride + u] : table.values().unknown;
        }
        best = std::max(best, sum);
      }
    }
  }
  return best;
}

TEST(Sweep, TheBestCandidateHasTheLargestSumAndWhatLiesOutsideOfTheTableIsUnknown) {
  // The reference sees walls 1 m off, and its table ends 4.4 m from it; half of the scan's hits are farther off.
  const GlobalSearch global(bare_sweep());
  std::vector<float> near_ranges, far_ranges;
  for (int k = 0; k < 360; ++k) {
    const double wall = 1.0 / std::max({std::abs(std::cos(deg_to_rad(k))), std::abs(std::sin(deg_to_rad(k)))});
    near_ranges.push_back(k < 180 ? static_cast<float>(wall) : 0.0F);
    far_ranges.push_back(static_cast<float>(k < 180 ? wall : 5.2 * wall));
  }
  const ScanGeometry geometry{0.0, deg_to_rad(1.0), 0.1, 10.0};
  const Scan near = make_scan(near_ranges, geometry), far = make_scan(far_ranges, geometry);
  const SearchOutcome out = search(bare_sweep(), near, far);
  int best = 0;
  for (const Hypothesis& h : out.hypotheses) best = std::max(best, h.coarse);
  // A hit on the edge of two cells may fall to either side.
  EXPECT_NEAR(best, largest_sum(prepared_for(global, near), prepared_for(global, far)), 8);
}

TEST(Sweep, CandidatesAreDistinctSoThatOnePlaceDoesNotFillTheList) {
  const Scan reference = test::cast_room({}, 360, 0.01), scan = test::cast_room({0.3, 0.2, 0.5}, 360, 0.01, 0.0, 2);
  GlobalOptions options = bare_sweep();
  options.candidates = 10;
  options.coarse_share = 0.0;
  const SearchOutcome out = search(options, reference, scan);
  ASSERT_EQ(out.hypotheses.size(), 10u);
  const GlobalSearch global(options);
  const double cells = 2.0 * static_cast<double>(prepared_for(global, reference).table.cell());
  for (std::size_t k = 0; k < 10; ++k) {
    for (std::size_t j = 0; j < k; ++j) {
      EXPECT_FALSE(same_pose(out.hypotheses[k].T_ref_scan, out.hypotheses[j].T_ref_scan, cells, deg_to_rad(7.0)))
          << j << " and " << k;
    }
  }
}

TEST(Sweep, CandidatesFarWorseThanTheBestAreDropped) {
  const Scan reference = test::cast_room({}, 360, 0.01), scan = test::cast_room({0.3, 0.2, 0.5}, 360, 0.01, 0.0, 2);
  GlobalOptions options = bare_sweep();
  for (const double share : {0.7, 0.9, 1.0}) {
    options.coarse_share = share;
    const SearchOutcome out = search(options, reference, scan);
    int least = 1 << 30, most = 0;
    for (const Hypothesis& h : out.hypotheses) least = std::min(least, h.coarse), most = std::max(most, h.coarse);
    EXPECT_GE(least, share * most);
    EXPECT_LT(out.hypotheses.size(), 40u) << "nothing was dropped";
  }
}

TEST(Search, WhatAGuessLedToStandsBesideWhatIsFoundEverywhere) {
  // Two places of a long hall, 4.2 m apart, seen 3.5 m far: where the scans overlap little, a right guess convinces no
  // more than others do. The sweep around the reference does not reach so far.
  std::vector<testing::Wall> hall = testing::corridor_with_niches(30.0, 0.4);
  testing::ToyLidar lidar;
  lidar.range_max = 3.5;
  lidar.noise = 0.01;
  Random random(3);
  const Pose2 truth{4.2, 0.1, 0.1}, T_hall_ref{10.0, 0.0, 0.0};
  const Scan reference = testing::toy_scan(hall, T_hall_ref, lidar, random, {}),
             scan = testing::toy_scan(hall, T_hall_ref * truth, lidar, random, {});
  GlobalOptions options;
  options.finalists = 100;
  const SearchOutcome out = search(options, reference, scan, Pose2{4.1, 0.0, 0.0});
  EXPECT_TRUE(std::any_of(out.hypotheses.begin(), out.hypotheses.end(),
                          [&](const Hypothesis& h) { return translation_distance(h.T_ref_scan, truth) < 0.2; }));
  EXPECT_TRUE(std::any_of(out.hypotheses.begin(), out.hypotheses.end(), [&](const Hypothesis& h) {
    return h.source != RotationSource::kGuess;
  })) << "nothing else was looked for";
}

/// Two scans of a corridor of two bare walls, 2 m apart.
struct CorridorPair {
  Scan reference, scan;
  Pose2 truth;
};
CorridorPair corridor_pair(Random& random, double noise, int beams = 360) {
  const std::vector<testing::Wall> walls = {{{-50, -1.0}, {50, -1.0}}, {{-50, 1.0}, {50, 1.0}}};
  testing::ToyLidar lidar;
  lidar.beams = beams;
  lidar.range_max = 6.0;
  lidar.noise = noise;
  const Pose2 T_world_ref{0.0, random.uniform(-0.3, 0.3), random.uniform(-0.5, 0.5)};
  CorridorPair pair;
  pair.truth = {random.uniform(-0.3, 0.3), random.uniform(-0.2, 0.2), random.uniform(-0.5, 0.5)};
  pair.reference = testing::toy_scan(walls, T_world_ref, lidar, random, {});
  pair.scan = testing::toy_scan(walls, T_world_ref * pair.truth, lidar, random, {});
  return pair;
}

TEST(Search, AlongACorridorTheTwinThatTurnedLessComesFirst) {
  // Noise alone decides between it and the other way round, by more than between twins of a room.
  Random random(5);
  const auto thinned = [&](Scan scan) {
    std::vector<float> ranges;
    for (std::size_t k = 0; k < scan.size(); ++k) ranges.push_back(random.chance(0.4) ? 0.0F : raw_range(scan, k));
    return make_scan(ranges, scan.geometry);
  };
  int turned_less = 0;
  for (int k = 0; k < 60; ++k) {
    const CorridorPair pair = corridor_pair(random, 0.03, 360);
    const SearchOutcome out = search({}, thinned(pair.reference), thinned(pair.scan));
    turned_less += angle_distance(out.hypotheses.front().T_ref_scan.theta, pair.truth.theta) < 0.3;
  }
  EXPECT_GE(turned_less, 57) << "of 60";
}

TEST(Search, AlongACorridorAllHitsSayHowWellThePoseIsHeld) {
  // The few that are picked for all else could say so by chance.
  Random random(6);
  const GlobalSearch global({});
  for (int k = 0; k < 10; ++k) {
    const CorridorPair pair = corridor_pair(random, 0.01);
    const PreparedScan reference = prepared_for(global, pair.reference), scan = prepared_for(global, pair.scan);
    const SearchOutcome out = search({}, pair.reference, pair.scan);
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen(out.refined.information.topLeftCorner<2, 2>());
    const Eigen::Vector2d weakest = eigen.eigenvectors().col(0) * reference.scale_m;
    const auto score = [&](double step) {
      Pose2 pose = out.hypotheses.front().T_ref_scan;
      pose.x += step * weakest.x(), pose.y += step * weakest.y();
      return weigh_evidence(reference, scan, reference.all, scan.all, pose, 0.0015 * reference.scale_m).score({});
    };
    const double drop = score(0.0) - std::max({score(-0.05), score(-0.02), score(0.02), score(0.05)});
    EXPECT_NEAR(out.profile, drop, 1e-6);
  }
}

TEST(Search, WithoutFreeSpaceAHitSeenThroughCountsForNothing) {
  // The scan has hits all over the room: what the reference looked through.
  const Scan reference = test::cast_room({}, 360, 0.01);
  std::vector<float> ranges;
  for (std::size_t k = 0; k < reference.size(); ++k)
    ranges.push_back(k % 3 == 0 ? 0.5F * raw_range(reference, k) : raw_range(reference, k));
  const Scan scan = make_scan(ranges, reference.geometry);
  for (const bool free_space : {true, false}) {
    GlobalOptions options;
    options.free_space = free_space;
    const SearchOutcome out = search(options, reference, scan);
    const PoseEvidence& e = out.evidence;
    ASSERT_GT(e.violation, 10.0);
    const double without = (e.matched - e.empty - 0.5 * e.stray) / e.hits;
    EXPECT_NEAR(out.hypotheses.front().score,
                without - (free_space ? 2.0 * e.violation + 0.6 * e.occluded : 0.0) / e.hits, 1e-9);
  }
}

}  // namespace
}  // namespace phasescan::search_rules_test
