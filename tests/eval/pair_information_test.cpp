// What two scans say of their own information, against what the simulator knows of it.
#include "eval/pair_information.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>

#include "eval/pair_outcome.hpp"
#include "eval/statistics.hpp"
#include "phasescan/match/scan_matcher.hpp"
#include "sim/pairs_spec.hpp"
#include "sim/truth.hpp"
#include "support/rooms.hpp"

namespace phasescan::pair_information_test {
namespace {

/// Largest standard deviation of the position [m].
double weak_sigma(const Eigen::Matrix3d& information) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(information.inverse().topLeftCorner<2, 2>().eval());
  return std::sqrt(axes.eigenvalues()(1));
}

TEST(SurfaceInformation, AgreesWithTheSimulatorWithinAFactor) {
  const sim::PairGenerator generator(sim::read_pairs_spec("bench-sim"), 77);
  std::vector<double> ratios;
  for (std::uint64_t k = 0; k < 60; ++k) {
    const sim::SimulatedPair made = generator.make(k);
    const sim::RayCaster caster(made.world.shape);
    const double exact = weak_sigma(sim::pair_information({&caster, &made.loose_ref}, {&caster, &made.loose_scan},
                                                          made.lidar, made.T_world_ref, made.T_world_scan));
    const double read_off = weak_sigma(surface_information(made.pair.reference, made.pair.scan, *made.pair.truth));
    ratios.push_back(read_off / exact);
  }
  EXPECT_GT(quantile(ratios, 0.0), 0.5);
  EXPECT_GT(quantile(ratios, 0.5), 0.8);
  EXPECT_LT(quantile(ratios, 0.5), 2.0);
  EXPECT_LT(quantile(ratios, 0.95), 3.0);
}

TEST(SurfaceInformation, SwappingTheScansKeepsTheInformation) {
  const Pose2 truth{0.4, -0.2, 0.6};
  const Scan a = test::cast_room({}, 360, 0.01), b = test::cast_room(truth, 360, 0.01, 0.0, 2);
  EXPECT_NEAR(weak_sigma(surface_information(a, b, truth)), weak_sigma(surface_information(b, a, truth.inverse())),
              1e-4);
}

Scan corridor_scan(std::uint64_t seed) {
  Random random(seed);
  std::vector<float> ranges;
  for (int k = 0; k < 360; ++k) {
    const double s = std::abs(std::sin(deg_to_rad(k)));
    ranges.push_back(static_cast<float>(s > 0.17 ? 1.0 / s + random.normal(0.0, 0.01) : 0.0));
  }
  return make_scan(ranges, {0.0, deg_to_rad(1.0), 0.1, 6.0});
}

TEST(SurfaceInformation, ABareCorridorIsWeakAndARoomIsNot) {
  const Scan a = corridor_scan(1), b = corridor_scan(2);
  ScanPair pair;
  pair.reference = a;
  pair.scan = b;
  pair.truth = Pose2{};
  MatchResult slid;
  slid.T_ref_scan = {0.7, 0.02, 0.001};
  const PairOutcome outcome = judge(pair, slid, 0, 1.0, surface_information(a, b, {}), InformationSource::kSurfaces);
  EXPECT_TRUE(is_weak(outcome)) << outcome.weak_sigma_m;
  EXPECT_NEAR(outcome.error_across_m, 0.02, 0.01);
  EXPECT_TRUE(std::isnan(outcome.efficiency)) << "no bound without a simulator";

  pair.reference = test::cast_room({}, 360, 0.01);
  pair.scan = test::cast_room({0.3, 0.1, 0.4}, 360, 0.01, 0.0, 2);
  pair.truth = Pose2{0.3, 0.1, 0.4};
  EXPECT_FALSE(is_weak(judge(pair, slid, 0, 1.0, surface_information(pair.reference, pair.scan, *pair.truth),
                             InformationSource::kSurfaces)));
}

TEST(SurfaceInformation, ScansWithoutHitsHoldNothing) {
  const Scan room = test::cast_room({}, 360), empty = make_scan({}, {});
  EXPECT_EQ(surface_information(room, empty, {}).norm(), 0.0);
  EXPECT_EQ(surface_information(empty, room, {}).norm(), 0.0);
}

}  // namespace
}  // namespace phasescan::pair_information_test
