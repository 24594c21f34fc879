// Which hits are partners, when a refinement ends, and what it claims to know.
#include <gtest/gtest.h>

#include "support/prepared.hpp"
#include "support/rooms.hpp"

namespace phasescan::refinement_rules_test {
namespace {

using test::prepared;

/// A hit of `surface` alone, moved by `along` and `out` of its wall [m].
SurfaceBatch lone_hit(const SurfacePoints& surface, int index, float along, float out) {
  SurfaceBatch hit;
  hit.fill(surface, std::vector<int>{index});
  const SurfacePoint& p = surface[static_cast<std::size_t>(index)];
  hit.x[0] += -p.ny * along + p.nx * out;
  hit.y[0] += p.nx * along + p.ny * out;
  return hit;
}

/// A wall 1 m ahead, from y = -1 to 1, without noise.
PreparedScan wall() {
  std::vector<float> ranges;
  for (int k = -45; k <= 45; ++k) ranges.push_back(static_cast<float>(1.0 / std::cos(deg_to_rad(k))));
  return prepared(make_scan(ranges, {deg_to_rad(-45.0), deg_to_rad(1.0), 0.1, 6.0}));
}

TEST(Partners, FaceTheSameWay) {
  const PreparedScan scan = wall();
  const int middle = static_cast<int>(scan.size()) / 2;
  SurfaceBatch hit = lone_hit(scan.surface, middle, 0.0F, -0.02F);
  const PartnerGate gate{0.1, 0.0, 0.75};
  EXPECT_EQ(point_to_line_equations(scan.model(), hit, {}, gate).partners, 1);
  hit.nx[0] = -hit.nx[0];
  hit.ny[0] = -hit.ny[0];
  EXPECT_EQ(point_to_line_equations(scan.model(), hit, {}, gate).partners, 0) << "the other side of a thin wall";
}

TEST(Partners, StandNoFartherBeyondTheEndOfALineThanItsHitsAreApart) {
  const PreparedScan scan = wall();
  const PartnerGate last{0.2, 0.0, 0.75};
  const int end = static_cast<int>(scan.size()) - 1;
  const float length = scan.surface[static_cast<std::size_t>(end)].length;
  ASSERT_LT(length, 0.06F);
  const auto partners = [&](float beyond) {
    return point_to_line_equations(scan.model(), lone_hit(scan.surface, end, -beyond, 0.0F), {}, last).partners +
           point_to_line_equations(scan.model(), lone_hit(scan.surface, end, beyond, 0.0F), {}, last).partners;
  };
  EXPECT_EQ(partners(0.5F * length), 2);
  EXPECT_EQ(partners(0.15F), 1) << "to one side the wall goes on";
}

TEST(Partners, ThePaddingOfABatchIsNone) {
  // The padding stands at the sensor: here on the wall.
  const PreparedScan scan = wall();
  const SurfaceBatch hit = lone_hit(scan.surface, static_cast<int>(scan.size()) / 2, 0.0F, 0.0F);
  EXPECT_EQ(point_to_line_equations(scan.model(), hit, {}, {0.1, 0.0, 0.75}).partners, 1);
  EXPECT_EQ(point_to_line_equations(scan.model(), hit, {1.0, 0.02, 0.0}, {0.1, 0.0, 0.75}).partners, 0);
}

struct Pair {
  PreparedScan reference = prepared(test::cast_room({}, 720, 0.01)),
               scan = prepared(test::cast_room({0.3, -0.2, 0.4}, 720, 0.01, 0.0, 2));
  Pose2 truth{0.3, -0.2, 0.4};
};

TEST(Refinement, TheGateClosesAndThenStepsBecomeSmall) {
  const Pair pair;
  PointToLineOptions options;
  options.max_iterations = 30;
  const PointToLineResult found =
      refine_point_to_line(pair.reference.model(), pair.scan.model(), {0.35, -0.15, 0.42}, options);
  EXPECT_TRUE(found.converged);
  EXPECT_LT(found.iterations, 30);
}

TEST(Refinement, ItHasNotConvergedWhileThePoseTurns) {
  const Pair pair;
  PointToLineOptions options;
  options.gate_start_m = options.gate_end_m = 0.2;
  options.stop_m = 10.0;
  options.max_iterations = 30;
  const PointToLineResult found =
      refine_point_to_line(pair.reference.model(), pair.scan.model(), {0.3, -0.2, 0.46}, options);
  EXPECT_GT(found.iterations, 2);
  EXPECT_NEAR(found.T_ref_scan.theta, pair.truth.theta, 0.003);
}

TEST(Refinement, PartnersAreLookedForAgainWhereThePoseMoved) {
  // With those of the first pose the answer would stay near it.
  const Pair pair;
  PointToLineOptions options;
  options.gate_start_m = options.gate_end_m = 0.3;
  options.max_iterations = 40;
  const Pose2 near = refine_point_to_line(pair.reference.model(), pair.scan.model(), pair.truth, options).T_ref_scan;
  for (const Pose2& guess : {Pose2{0.42, -0.2, 0.4}, Pose2{0.3, -0.08, 0.4}, Pose2{0.3, -0.2, 0.5}}) {
    const Pose2 found = refine_point_to_line(pair.reference.model(), pair.scan.model(), guess, options).T_ref_scan;
    EXPECT_LT(translation_distance(found, near), 1e-3);
    EXPECT_LT(angle_distance(found.theta, near.theta), 5e-4);
  }
}

TEST(Refinement, BothWaysOneScanKnowsAsMuchAsOneWay) {
  // A scan and itself: either way the same hits find the same lines. What both ways say is not two observations.
  const Pair pair;
  PointToLineWorkspace work;
  const PointToLineOptions options;
  const SurfaceModel model = pair.reference.model();
  const Eigen::Matrix3d one = refine_point_to_line(model, model, {}, options, model.all, nullptr, work).information,
                        both = refine_point_to_line(model, model, {}, options, model.all, &model.all, work).information;
  EXPECT_LT((both - one).norm(), 0.01 * one.norm());
}

TEST(Refinement, NoiseOfTheNormalsIsNoInformationAlongBareWalls) {
  // Two walls, 1 m to either side, and nothing else: along them there is nothing to know.
  double along = 0.0, across = 0.0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Random random(seed);
    const auto corridor = [&] {
      std::vector<float> ranges;
      for (int k = 0; k < 360; ++k) {
        const double s = std::abs(std::sin(kTwoPi * k / 360));
        ranges.push_back(s > 0.2 ? static_cast<float>(1.0 / s + random.normal(0.0, 0.02)) : 0.0F);
      }
      return prepared(make_scan(ranges, {0.0, kTwoPi / 360, 0.1, 6.0}));
    };
    const PreparedScan reference = corridor(), scan = corridor();
    const Eigen::Matrix3d information = refine_point_to_line(reference.model(), scan.model(), {}, {}).information;
    along += information(0, 0);
    across += information(1, 1);
  }
  EXPECT_LT(along, 3e-3 * across);
}

/// Of 360 hits in a room, at the pose that the refinement finds; with its partners as with none known.
Eigen::Matrix3d residual_covariance(const PreparedScan& reference, const PreparedScan& scan, const Pose2& guess) {
  const PointToLineOptions options;
  PointToLineWorkspace known, none;
  const PointToLineResult found =
      refine_point_to_line(reference.model(), scan.model(), guess, options, scan.all, &reference.all, known);
  EXPECT_TRUE(found.converged);
  std::vector<NormalEquations> work;
  const auto with = [&](PointToLineWorkspace& partners) {
    return covariance_of_residuals(reference.model(), scan.model(), found.T_ref_scan, {options.gate_end_m, 0.0, 0.75},
                                   scan.all, &reference.all, partners, work);
  };
  const Eigen::Matrix3d anew = with(none);
  EXPECT_LT((with(known) - anew).norm(), 0.1 * anew.norm());
  return anew;
}

TEST(ResidualCovariance, FollowsTheErrorsOfTheScans) {
  const auto with_noise = [](double sigma) {
    Eigen::Matrix3d mean = Eigen::Matrix3d::Zero();
    for (int seed = 0; seed < 20; ++seed)
      mean += residual_covariance(prepared(test::cast_room({}, 360, sigma, 0.0, 2 * seed + 1)),
                                  prepared(test::cast_room({0.2, 0.1, 0.3}, 360, sigma, 0.0, 2 * seed + 2)),
                                  {0.2, 0.1, 0.3}) /
              20.0;
    return mean;
  };
  const double exact = with_noise(0.0).trace(), small = with_noise(0.004).trace(), large = with_noise(0.016).trace();
  EXPECT_LT(exact, 0.3 * small);
  EXPECT_GT(large, 3.0 * small);
  EXPECT_LT(large, 30.0 * small);
}

TEST(ResidualCovariance, CoversTheErrorsOfBentScans) {
  // Beams of a whole quarter look past their direction by 1 deg: the noise of the ranges says nothing of it.
  Pose2 truth{0.2, 0.1, 0.3};
  const PreparedScan reference = prepared(test::cast_room({}, 360, 0.002, 0.0, 1));
  Scan bent = test::cast_room(truth, 360, 0.002, 0.0, 2);
  const Eigen::Matrix3d straight = residual_covariance(reference, prepared(bent), truth);
  std::rotate(bent.ranges.begin(), bent.ranges.begin() + 1, bent.ranges.begin() + 90);
  const PreparedScan scan = prepared(bent);
  const Eigen::Matrix3d covariance = residual_covariance(reference, scan, truth);
  EXPECT_GT(covariance(2, 2), 3.0 * straight(2, 2));
  const Pose2 found = refine_point_to_line(reference.model(), scan.model(), truth, {}).T_ref_scan;
  EXPECT_LT(std::abs(found.theta - truth.theta), 4.0 * std::sqrt(covariance(2, 2)));
  EXPECT_GT(std::abs(found.theta - truth.theta), 0.2 * std::sqrt(covariance(2, 2)));
}

TEST(ResidualCovariance, OfHitsThatHoldNothingIsZero) {
  const PreparedScan scan = wall();
  PointToLineWorkspace partners;
  std::vector<NormalEquations> work;
  EXPECT_EQ(
      covariance_of_residuals(scan.model(), scan.model(), {}, {0.1, 0.0, 0.75}, scan.all, nullptr, partners, work),
      Eigen::Matrix3d::Zero())
      << "along the wall";
}

}  // namespace
}  // namespace phasescan::refinement_rules_test
