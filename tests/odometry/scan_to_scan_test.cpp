#include "phasescan/odometry/scan_to_scan.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>

#include "support/toy_world.hpp"

namespace phasescan {
namespace {

using testing::toy_scan;
using testing::Wall;

TEST(ScanToScan, TheLeastKnownDirectionLiesAlongTheLongRoomWhateverTheHeadings) {
  // Walls along x are seen much more than those across it: what is least known is x, a little turned by the slanted
  // end.
  std::vector<Wall> walls;
  const auto add = [&](double x1, double y1, double x2, double y2) { walls.push_back({{x1, y1}, {x2, y2}}); };
  add(-5, -1, 6, -1), add(6, -1, 5.6, 1), add(5.6, 1, 1, 1), add(1, 1, 1, 1.3), add(1, 1.3, -5, 1.3),
      add(-5, 1.3, -5, -1);
  for (const bool flipped : {false, true}) {
    for (const double heading : {0.0, 0.9, -2.0}) {
      for (const double turn : {0.0, 1.3}) {
        const LaserMount mount{{0.1, -0.05, 0.6}, flipped};
        const Pose2 T_odom_before{0.2, 0.1, heading}, T_odom_now{0.4, 0.05, wrap_angle(heading + turn)};
        Random random(3);
        ScanToScan net;
        net.remember(toy_scan(walls, T_odom_before * mount.T_base_laser, {}, random, 0, {}, flipped), mount,
                     T_odom_before, {});
        const auto found =
            net.find(toy_scan(walls, T_odom_now * mount.T_base_laser, {}, random, 1, {}, flipped), mount, {});
        ASSERT_TRUE(found) << heading << " " << turn << " " << flipped;
        EXPECT_LT(translation_distance(found->T_odom_base, T_odom_now), 0.05)
            << heading << " " << turn << " " << flipped;
        const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen(found->covariance.topLeftCorner<2, 2>());
        const Eigen::Vector2d least_known = eigen.eigenvectors().col(1);
        EXPECT_GT(std::abs(least_known.x()), 0.95) << heading << " " << turn << " " << flipped << "\n"
                                                   << found->covariance;
      }
    }
  }
}

}  // namespace
}  // namespace phasescan
