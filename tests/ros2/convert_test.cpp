// Poses, covariances, maps and qualities of service.
#include "ros2/convert.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "ros2/node_support.hpp"
#include "ros2/qos.hpp"

namespace phasescan::ros2::convert_test {
namespace {

TEST(Convert, PosesThereAndBack) {
  for (const double theta : {-3.1, -1.0, 0.0, 0.5, 3.14159, kPi}) {
    const Pose2 pose{1.5, -2.25, theta};
    const Pose2 back = to_pose2(to_pose(pose));
    EXPECT_EQ(back.x, pose.x);
    EXPECT_NEAR(angle_distance(back.theta, theta), 0.0, 1e-12);
  }
  EXPECT_EQ(to_pose2({{1, 2, 3}, {0, 0, 0, 0}}).theta, 0.0);
  // A quaternion of another length, rolled by half a turn: where its x axis points counts.
  EXPECT_NEAR(to_pose2({{}, {3.0 * std::cos(0.3), 3.0 * std::sin(0.3), 0, 0}}).theta, 0.6, 1e-12);
  EXPECT_THROW(to_pose2({{std::nan(""), 0, 0}, {}}), std::invalid_argument);
}

TEST(Convert, CovariancesStandWhereAmclPutsThem) {
  Eigen::Matrix3d covariance;
  covariance << 1, 2, 3, 2, 5, 6, 3, 6, 9;
  const Covariance6 out = to_covariance6(covariance);
  EXPECT_EQ(out[0], 1.0);
  EXPECT_EQ(out[1], 2.0);
  EXPECT_EQ(out[6], 2.0);
  EXPECT_EQ(out[7], 5.0);
  EXPECT_EQ(out[35], 9.0);
  EXPECT_EQ(out[14] + out[21] + out[28], 0.0);
  EXPECT_EQ(to_covariance3(out), covariance);
  for (Covariance6 bad : {Covariance6{}, to_covariance6(-covariance), [] {
                            Covariance6 c{};
                            c[0] = std::nan("");
                            return c;
                          }()}) {
    EXPECT_NEAR(to_covariance3(bad)(0, 0), 0.25, 1e-12);
  }
}

TEST(Convert, MapsThereAndBack) {
  TrinaryMap map;
  map.width = 3;
  map.height = 2;
  map.resolution_m = 0.05;
  map.origin = {-1.5, 2.5, 0.25};
  map.cells = {CellState::kFree, CellState::kOccupied, CellState::kUnknown,
               CellState::kFree, CellState::kFree,     CellState::kOccupied};
  const OccupancyGrid grid = to_grid(map, at(1.0), "map");
  EXPECT_EQ(grid.data, (std::vector<std::int8_t>{0, 100, -1, 0, 0, 100}));
  EXPECT_EQ(grid.info.width, 3U);
  const TrinaryMap back = to_map(decode<OccupancyGrid>(encode(grid)));
  EXPECT_EQ(back.cells, map.cells);
  EXPECT_EQ(back.resolution_m, 0.05);
  EXPECT_NEAR(back.origin.theta, 0.25, 1e-12);
}

TEST(Convert, CellsAreReadAsMapServerHasThem) {
  OccupancyGrid grid;
  grid.info.resolution = 0.1F;
  grid.data = {-1, 0, 19, 20, 64, 65, 100};
  grid.info.width = 7;
  grid.info.height = 1;
  const CellState u = CellState::kUnknown, f = CellState::kFree, o = CellState::kOccupied;
  EXPECT_EQ(to_map(grid).cells, (std::vector<CellState>{u, f, f, u, u, o, o}));
}

TEST(Convert, GridsThatContradictThemselvesAreRefused) {
  OccupancyGrid grid = to_grid({2, 1, 0.05, {}, {CellState::kFree, CellState::kFree}}, 0, "map");
  const auto refused = [](OccupancyGrid bad) { EXPECT_THROW(to_map(bad), std::invalid_argument); };
  OccupancyGrid bad = grid;
  bad.info.width = 3;
  refused(bad);
  bad = grid;
  bad.info.resolution = 0.0F;
  refused(bad);
  bad = grid;
  bad.info.width = bad.info.height = 0xffffffffU;
  refused(bad);
  bad = grid;
  bad.info.origin.position.x = std::nan("");
  refused(bad);
  refused({});
}

TEST(Qos, EveryReaderGetsWhatItsWriterOffers) {
  // As nav2 and drivers have them: who reads, and who writes.
  const Qos sensor{false, false, 5}, latched{true, true, 1}, plain{true, false, 10};
  EXPECT_TRUE(compatible(sensor, endpoint(Role::kSlam, Direction::kIn, "scan").qos));
  EXPECT_TRUE(compatible(plain, endpoint(Role::kSlam, Direction::kIn, "scan").qos));
  EXPECT_TRUE(compatible(endpoint(Role::kSlam, Direction::kOut, "map").qos, latched));
  EXPECT_TRUE(compatible(endpoint(Role::kSlam, Direction::kOut, "map").qos,
                         endpoint(Role::kLocalization, Direction::kIn, "map").qos));
  EXPECT_TRUE(compatible(endpoint(Role::kLocalization, Direction::kOut, "amcl_pose").qos, latched));
  EXPECT_TRUE(compatible(endpoint(Role::kLocalization, Direction::kOut, "particle_cloud").qos, sensor));
  EXPECT_FALSE(compatible(endpoint(Role::kLocalization, Direction::kOut, "particle_cloud").qos, plain));
  EXPECT_FALSE(compatible(plain, latched));
  EXPECT_FALSE(compatible(endpoint(Role::kLocalization, Direction::kIn, "map").qos, Qos{}) &&
               compatible(Qos{}, endpoint(Role::kLocalization, Direction::kIn, "map").qos));
  EXPECT_THROW(endpoint(Role::kSlam, Direction::kOut, "amcl_pose"), std::invalid_argument);
}

}  // namespace
}  // namespace phasescan::ros2::convert_test
