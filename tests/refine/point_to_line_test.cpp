#include "refine/point_to_line.hpp"

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "support/prepared.hpp"
#include "support/rooms.hpp"

namespace phasescan::point_to_line_test {
namespace {

using test::prepared;

Pose2 plus(const Pose2& pose, const Eigen::Vector3d& step) {
  return {pose.x + step.x(), pose.y + step.y(), pose.theta + step.z()};
}

TEST(PointToLine, OneStepTakesBackASmallOffsetInEitherDirection) {
  const Pose2 truth{0.3, -0.2, 0.4};
  const PreparedScan reference = prepared(test::cast_room({}, 720)), scan = prepared(test::cast_room(truth, 720));
  const PartnerGate gate{0.2, 0.05, 0.75};
  for (const Eigen::Vector3d& offset : {Eigen::Vector3d(0.01, 0, 0), Eigen::Vector3d(0, -0.01, 0),
                                        Eigen::Vector3d(0, 0, 0.004), Eigen::Vector3d(0.006, 0.005, -0.003)}) {
    const Pose2 at = plus(truth, offset);
    const NormalEquations forward = point_to_line_equations(reference.model(), scan.all, at, gate);
    const NormalEquations backward =
        about_inverse(point_to_line_equations(scan.model(), reference.all, at.inverse(), gate), at);
    for (const NormalEquations& equations : {forward, backward}) {
      const Eigen::Vector3d step = -(equations.H.inverse() * equations.g);
      EXPECT_LT((step + offset).norm(), 0.35 * offset.norm()) << step.transpose() << " for " << offset.transpose();
    }
  }
}

TEST(PointToLine, TheGradientIsTheSlopeOfTheResiduals) {
  // J^T w e against differences of sum w e^2 / 2 with the weights held: a kernel so wide that they do not change.
  const Pose2 truth{0.2, 0.1, -0.3};
  const PreparedScan reference = prepared(test::cast_room({}, 720)), scan = prepared(test::cast_room(truth, 720));
  const PartnerGate gate{0.25, 5.0, 0.9};
  const Pose2 at = plus(truth, {0.01, -0.008, 0.003});
  const NormalEquations here = point_to_line_equations(reference.model(), scan.all, at, gate);
  for (int k = 0; k < 3; ++k) {
    const double h = k == 2 ? 5e-4 : 1e-3;
    Eigen::Vector3d step = Eigen::Vector3d::Zero();
    step[k] = h;
    const NormalEquations ahead = point_to_line_equations(reference.model(), scan.all, plus(at, step), gate);
    const NormalEquations behind = point_to_line_equations(reference.model(), scan.all, plus(at, -step), gate);
    const double slope = (ahead.cost - behind.cost) / (4.0 * h);
    EXPECT_NEAR(slope, here.g[k], 0.1 * here.g.norm() + 1e-6) << "component " << k;
  }
}

TEST(PointToLine, AHitWithoutALineOfItsOwnCountsOnTheOthersAndPaddingDoesNot) {
  const PreparedScan reference = prepared(test::cast_room({}, 720));
  // One hit on a wall, alone; around the sensor, where the padding of the batch stands, there is a wall as well.
  SurfaceBatch lone;
  const int on_wall = 100;
  lone.fill(reference.surface, std::vector<int>{on_wall});
  lone.nx[0] = lone.ny[0] = 0.0F;
  const SurfacePoint& wall = reference.surface[on_wall];
  const Pose2 beside{-0.01 * static_cast<double>(wall.nx), -0.01 * static_cast<double>(wall.ny), 0.0};
  const NormalEquations equations = point_to_line_equations(reference.model(), lone, beside, {0.1, 0.0, 0.75});
  EXPECT_EQ(equations.partners, 1);
  // It is pushed back along the wall's normal.
  EXPECT_LT(equations.g.head<2>().dot(Eigen::Vector2d(static_cast<double>(wall.nx), static_cast<double>(wall.ny))),
            0.0);
  const Pose2 sensor_on_wall{static_cast<double>(wall.x), static_cast<double>(wall.y), 0.0};
  lone.x[0] = 1e3F;
  EXPECT_EQ(point_to_line_equations(reference.model(), lone, sensor_on_wall, {0.1, 0.0, 0.75}).partners, 0);
}

TEST(PointToLine, EquationsAboutTheInverseUseItsDerivative) {
  const Pose2 pose{0.7, -0.4, 1.1};
  NormalEquations unit;
  unit.H = Eigen::Matrix3d::Identity();
  Eigen::Matrix3d numeric;
  for (int k = 0; k < 3; ++k) {
    Eigen::Vector3d step = Eigen::Vector3d::Zero();
    step[k] = 1e-6;
    const Pose2 a = plus(pose, step).inverse(), b = plus(pose, -step).inverse();
    numeric.col(k) << (a.x - b.x) / 2e-6, (a.y - b.y) / 2e-6, wrap_angle(a.theta - b.theta) / 2e-6;
  }
  EXPECT_LT((about_inverse(unit, pose).H - numeric.transpose() * numeric).norm(), 1e-6);
}

TEST(PointToLine, IsBelowACentimetreUnderTheNoiseOfACheapSensor) {
  const Pose2 truth{0.3, 0.25, 0.2};
  double sum = 0.0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const PreparedScan reference = prepared(test::cast_room({}, 360, 0.02, 0.02, seed));
    const PreparedScan scan = prepared(test::cast_room(truth, 360, 0.02, 0.02, seed + 100));
    const PointToLineResult result =
        refine_point_to_line(reference.model(), scan.model(), plus(truth, {0.08, -0.06, 0.05}), {});
    EXPECT_LT(translation_distance(result.T_ref_scan, truth), 0.02);
    sum += translation_distance(result.T_ref_scan, truth);
  }
  EXPECT_LT(sum / 20, 0.01);
}

TEST(PointToLine, ACorridorLeavesItsLengthOpen) {
  // Two parallel walls, noisy: what noise of the normals adds along them is taken out again.
  Random random(3);
  std::vector<float> ranges;
  for (int k = 0; k < 360; ++k) {
    const double r = 1.0 / std::max(std::abs(std::sin(kTwoPi * k / 360)), 1e-3) + random.normal(0.0, 0.02);
    ranges.push_back(static_cast<float>(r));
  }
  const PreparedScan corridor = prepared(make_scan(ranges, {0.0, kTwoPi / 360, 0.1, 6.0}));
  const PointToLineResult result = refine_point_to_line(corridor.model(), corridor.model(), {}, {});
  EXPECT_GT(result.information(1, 1), 50.0 * std::max(result.information(0, 0), 0.0));
}

}  // namespace
}  // namespace phasescan::point_to_line_test
