#include "odometry/motion_prior.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/random.hpp"
#include "scan/surface.hpp"
#include "support/state_bytes.hpp"

namespace phasescan::motion_prior_test {
namespace {

std::vector<float> rough_corridor(double x, Random& noise, double relief_m = 0.012) {
  // The relief is a function of the place, not of the beam.
  std::vector<float> ranges;
  for (int k = 0; k < 180; ++k) {
    const double angle = -0.5 * kPi + k * kPi / 180;
    const double across = std::abs(std::sin(angle));
    double range = across > 1e-6 ? 0.9 / across : 100.0;
    const double place = x + range * std::cos(angle);
    const double relief = relief_m * std::sin(97.0 * place) * std::sin(41.0 * place + (angle > 0 ? 1.0 : 0.0));
    if (range < 6.0) range += relief / across;
    ranges.push_back(range < 6.0 ? static_cast<float>(range + noise.normal(0.0, 0.002)) : 0.0F);
  }
  return ranges;
}

SurfacePoints surface_of(const std::vector<float>& ranges) {
  SurfaceWorkspace work;
  SurfacePoints surface;
  find_surface(make_scan(ranges, {-0.5 * kPi, kPi / 180, 0.0, 6.0}), {}, work, surface);
  return surface;
}

TEST(MotionPrior, TheReliefOfBareWallsTellsRestFromMotion) {
  Random noise(1);
  ReliefCorrelation relief;
  EXPECT_FALSE(relief.add(surface_of(rough_corridor(0.0, noise))).has_value());
  EXPECT_GT(relief.add(surface_of(rough_corridor(0.0, noise))).value(), 0.7);
  EXPECT_LT(relief.add(surface_of(rough_corridor(0.06, noise))).value(), 0.4);
  EXPECT_GT(relief.add(surface_of(rough_corridor(0.06, noise))).value(), 0.7);
  EXPECT_FALSE(relief.add(SurfacePoints{}).has_value());
}

TEST(MotionPrior, AssumesRestOrTheUsualMotionOnceBothAreKnown) {
  Random noise(2);
  MotionPrior prior;
  double x = 0.0;
  const auto go = [&](double step, bool seen) {
    x += step;
    prior = testing::from_bytes<MotionPrior>(testing::to_bytes(prior));  // its state is all there is between scans
    prior.observe(surface_of(rough_corridor(x, noise)));
    const auto assumed = prior.prior_for(0.0);
    prior.learn({step, 0.0, 0.0}, seen);
    return assumed;
  };
  for (int i = 0; i < 30; ++i) EXPECT_FALSE(go(0.0, true).has_value()) << i;  // nothing is usual yet
  for (int i = 0; i < 30; ++i) EXPECT_FALSE(go(0.06, true).has_value()) << i;
  // Rest and the end of it, unseen.
  go(0.0, false), go(0.0, false);
  const auto rest = go(0.0, false);
  ASSERT_TRUE(rest.has_value());
  EXPECT_EQ(rest->x, 0.0);
  const auto start = go(0.06, false);
  ASSERT_TRUE(start.has_value());
  EXPECT_NEAR(start->x, 0.06, 0.005);
  EXPECT_FALSE(go(0.06, false).has_value());  // and so it goes on
  // A speed that is not seen does not run away.
  Pose2 step{0.2, 0.0, 0.0};
  for (int i = 0; i < 200; ++i) step = prior.expect(step);
  EXPECT_NEAR(step.x, 0.06, 0.01);
  go(0.06, true);
  EXPECT_EQ(prior.expect({0.2, 0.0, 0.0}).x, 0.2);
}

/// Steps of a robot that learned from so many scans at rest and as many in motion, along walls with that relief.
struct Learner {
  double relief_m;
  MotionPrior prior;
  Random noise{2};
  double x = 0.0;

  bool assumes(double step, bool seen) {
    x += step;
    prior.observe(surface_of(rough_corridor(x, noise, relief_m)));
    const bool assumed = prior.prior_for(0.0).has_value();
    prior.learn({step, 0.0, 0.0}, seen);
    return assumed;
  }
  void learn(int scans) {
    for (int k = 0; k < scans; ++k) assumes(0.0, true);
    for (int k = 0; k < scans; ++k) assumes(0.06, true);
  }
};

TEST(MotionPrior, OneScanLikeTheLastIsNoRest) {
  Learner robot{0.012, {}};
  robot.learn(30);
  EXPECT_FALSE(robot.assumes(0.0, false));
  EXPECT_TRUE(robot.assumes(0.0, false));
}

TEST(MotionPrior, FewScansAreNoHabit) {
  Learner robot{0.012, {}};
  robot.learn(10);
  for (int k = 0; k < 5; ++k) EXPECT_FALSE(robot.assumes(0.0, false)) << k;
}

TEST(MotionPrior, WhereRestAndMotionLookTheSameRestIsNotTold) {
  // Walls without relief: what is left is the noise of each scan.
  Learner robot{0.0, {}};
  robot.learn(30);
  for (int k = 0; k < 20; ++k) EXPECT_FALSE(robot.assumes(0.0, false)) << k;
}

}  // namespace
}  // namespace phasescan::motion_prior_test
