#include "sim/truth.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "sim/world_kinds.hpp"

namespace phasescan::sim::truth_test {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

Shape rectangle(double width, double height) {
  Shape shape;
  shape.add_line({{0.0, 0.0}, {width, 0.0}, {width, height}, {0.0, height}, {0.0, 0.0}});
  return shape;
}

LidarOptions plain_lidar() {
  LidarOptions lidar;
  lidar.range_max_m = 20.0;
  lidar.dropout = lidar.mixed_pixels = lidar.resolution_m = 0.0;
  lidar.grazing_deg = 90.0;
  return lidar;
}

/// Maximum-likelihood pose between two scans of a rectangular room: pose and all four wall lines are unknown, which
/// point lies on which wall is known. Lines as (direction of the normal, distance) in the reference frame. Gauss-Newton
/// from the truth.
Pose2 best_estimate(const Scan& reference, const Scan& scan, const LidarOptions& lidar, const Pose2& T_world_ref,
                    const Pose2& truth, double width, double height) {
  const Vector2d normals[4] = {{0.0, 1.0}, {-1.0, 0.0}, {0.0, -1.0}, {1.0, 0.0}};
  const double offsets[4] = {0.0, -width, -height, 0.0};
  Eigen::Matrix<double, 11, 1> x;
  x.head<3>() << truth.x, truth.y, truth.theta;
  for (int w = 0; w < 4; ++w) {
    x[3 + 2 * w] = std::atan2(normals[w].y(), normals[w].x()) - T_world_ref.theta;
    x[4 + 2 * w] = offsets[w] - normals[w].dot(T_world_ref.translation());
  }
  const auto start = x;
  for (int iteration = 0; iteration < 4; ++iteration) {
    Eigen::Matrix<double, 11, 11> h = Eigen::Matrix<double, 11, 11>::Zero();
    Eigen::Matrix<double, 11, 1> g = Eigen::Matrix<double, 11, 1>::Zero();
    for (const bool is_scan : {false, true}) {
      const Scan& s = is_scan ? scan : reference;
      const Pose2 true_pose = is_scan ? truth : Pose2{};
      for (std::size_t i = 0; i < s.size(); ++i) {
        if (!s.is_hit(i)) continue;
        const Vector2d q = static_cast<double>(s.ranges[i]) * Vector2d(std::cos(s.angle(i)), std::sin(s.angle(i)));
        // The wall that the true ray meets first.
        const Vector2d direction = true_pose.rotation() * q.normalized();
        double nearest = 1e9, cosine = 0.0;
        int wall = 0;
        for (int w = 0; w < 4; ++w) {
          const Vector2d n(std::cos(start[3 + 2 * w]), std::sin(start[3 + 2 * w]));
          const double t = (start[4 + 2 * w] - n.dot(true_pose.translation())) / n.dot(direction);
          if (t > 0.0 && t < nearest) nearest = t, wall = w, cosine = std::abs(n.dot(direction));
        }
        const double alpha = x[3 + 2 * wall];
        const Vector2d n(std::cos(alpha), std::sin(alpha)), turned(-std::sin(alpha), std::cos(alpha));
        const Pose2 pose = is_scan ? Pose2{x[0], x[1], x[2]} : Pose2{};
        const Vector2d p = pose * q, arm = p - pose.translation();
        Eigen::Matrix<double, 11, 1> j = Eigen::Matrix<double, 11, 1>::Zero();
        if (is_scan) j.head<3>() << n.x(), n.y(), n.dot(Vector2d(-arm.y(), arm.x()));
        j[3 + 2 * wall] = turned.dot(p);
        j[4 + 2 * wall] = -1.0;
        const double weight = 1.0 / std::pow(lidar.sigma(nearest) * cosine, 2);
        h += weight * j * j.transpose();
        g += weight * j * (n.dot(p) - x[4 + 2 * wall]);
      }
    }
    x -= h.ldlt().solve(g);
  }
  return {x[0], x[1], x[2]};
}

TEST(Information, IsWhatTheBestEstimatorReaches) {
  const double width = 4.0, height = 3.0;
  const RayCaster caster(rectangle(width, height));
  const Surroundings around{&caster, nullptr};
  const LidarOptions lidar = plain_lidar();
  const Pose2 ref{1.6, 1.2, 0.3}, scan{1.9, 1.6, 0.8};
  const Pose2 truth = ref.inverse() * scan;
  const Matrix3d information = pair_information(around, around, lidar, ref, scan);
  Random random(17);
  constexpr int kTrials = 500;
  double sum = 0.0;
  Matrix3d covariance = Matrix3d::Zero();
  for (int k = 0; k < kTrials; ++k) {
    const Scan a = simulate_scan(around, lidar, ref, random), b = simulate_scan(around, lidar, scan, random);
    const Pose2 estimate = best_estimate(a, b, lidar, ref, truth, width, height);
    const Vector3d e(estimate.x - truth.x, estimate.y - truth.y, wrap_angle(estimate.theta - truth.theta));
    sum += e.dot(information * e) / 3.0;
    covariance += e * e.transpose() / kTrials;
  }
  // 500 trials of 3 numbers: 3.7 % standard error. Straight walls help the estimator a little where the two scans'
  // points lie differently dense along a wall, so it may do better than a bound that lets the surface be any shape.
  EXPECT_GT(sum / kTrials, 0.8);
  EXPECT_LT(sum / kTrials, 1.12);
  const Matrix3d bound = information.inverse();
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(std::sqrt(covariance(i, i) / bound(i, i)), 1.0, 0.15) << i;
}

TEST(Information, RoundingCountsLikeNoise) {
  const RayCaster caster(rectangle(4.0, 3.0));
  const Surroundings around{&caster, nullptr};
  const Pose2 ref{1.6, 1.2, 0.3}, scan{1.9, 1.6, 0.8};
  LidarOptions rounded = plain_lidar(), noisy = plain_lidar();
  rounded.sigma_m = 0.001, rounded.sigma_relative = noisy.sigma_relative = 0.0, rounded.resolution_m = 0.03;
  noisy.sigma_m = std::hypot(0.001, 0.03 / std::sqrt(12.0)), noisy.resolution_m = 0.0;
  const Matrix3d a = pair_information(around, around, rounded, ref, scan),
                 b = pair_information(around, around, noisy, ref, scan);
  EXPECT_LT((a - b).norm(), 1e-9 * b.norm());
}

TEST(Information, IsBlindAlongACorridor) {
  const World world = make_world(WorldKind::kBareCorridor, 2);
  const RayCaster caster(world.shape);
  const Surroundings around{&caster, nullptr};
  const Matrix3d information = pair_information(around, around, LidarOptions{}, {0.0, 0.0, 0.0}, {0.5, 0.1, 0.3});
  EXPECT_NEAR(information(0, 0), 0.0, 1e-6 * information(1, 1));
  EXPECT_GT(information(1, 1), 1e5);
}

TEST(Information, DoesNotChangeWithTheFrameOfTheWorld) {
  const Pose2 T_new_old{5.0, -3.0, 2.0}, ref{1.6, 1.2, 0.3}, scan{1.9, 1.6, 0.8};
  Shape moved;
  moved.append(rectangle(4.0, 3.0), T_new_old);
  const RayCaster a(rectangle(4.0, 3.0)), b(moved);
  const Matrix3d first = pair_information({&a, nullptr}, {&a, nullptr}, plain_lidar(), ref, scan);
  const Matrix3d second =
      pair_information({&b, nullptr}, {&b, nullptr}, plain_lidar(), T_new_old * ref, T_new_old * scan);
  EXPECT_LT((first - second).norm(), 1e-3 * first.norm());
}

TEST(Overlap, IsAllInAnEmptyRoomNoneInTwoAndHalfBehindAWall) {
  const RayCaster room(rectangle(4.0, 3.0));
  const Surroundings around{&room, nullptr};
  EXPECT_GT(pair_overlap(around, around, plain_lidar(), {1.0, 1.0, 0.0}, {2.0, 2.0, 1.0}).mean(), 0.99);

  Shape closet;
  closet.append(rectangle(1.3, 0.9), {1.0, 1.1, 0.0});
  const RayCaster other(closet);
  EXPECT_LT(pair_overlap(around, {&other, nullptr}, plain_lidar(), {1.0, 1.0, 0.0}, {1.5, 1.5, 0.0}).mean(), 0.1);

  // A view of 180 degrees, turned by 90: half of each is seen by the other.
  Shape circle;
  Polygon outline;
  for (int i = 0; i <= 360; ++i) outline.push_back({2.0 * std::cos(deg_to_rad(i)), 2.0 * std::sin(deg_to_rad(i))});
  circle.add_line(outline);
  const RayCaster round(circle);
  LidarOptions half = plain_lidar();
  half.fov_deg = 180.0;
  half.angle_min_deg = 90.0;
  half.beams = 181;
  const Overlap overlap = pair_overlap({&round, nullptr}, {&round, nullptr}, half, {}, {0.0, 0.0, deg_to_rad(90.0)});
  EXPECT_NEAR(overlap.of_scan, 0.5, 0.01);
  EXPECT_NEAR(overlap.of_reference, 0.5, 0.01);
}

}  // namespace
}  // namespace phasescan::sim::truth_test
