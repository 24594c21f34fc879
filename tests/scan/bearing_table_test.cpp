// What a scan says of every direction: hit, empty up to the sensor's reach, or nothing.
#include "scan/bearing_table.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "phasescan/core/pose2.hpp"

namespace phasescan::bearing_table_test {
namespace {

constexpr int kBeams = 360;

BearingTable table_of(const std::vector<float>& ranges) {
  const Scan scan = make_scan(ranges, {0.0, kTwoPi / kBeams, 0.2, 10.0});
  SurfaceWorkspace work;
  SurfacePoints surface;
  find_surface(scan, {}, work, surface);
  std::vector<float> turns;
  for (const SurfacePoint& p : surface.points)
    turns.push_back(static_cast<float>(wrap_positive(std::atan2(p.y, p.x)) / kTwoPi));
  BearingWorkspace bearings;
  BearingTable table;
  fill_bearing_table(scan, surface, turns.data(), work, 0.0, 0.05, bearings, table);
  return table;
}

float empty_at(const BearingTable& table, int degree) {
  return table.empty_to[static_cast<std::size_t>(degree) * table.size() / kBeams];
}

/// A round wall 3 m off, but for beams 100 to 139, which give `value`.
std::vector<float> round_wall(float value) {
  std::vector<float> ranges(kBeams, 3.0F);
  for (int k = 100; k < 140; ++k) ranges[static_cast<std::size_t>(k)] = value;
  return ranges;
}

TEST(BearingTable, ABeamWithoutReturnIsFreeShortOfTheStatedRange) {
  const BearingTable table = table_of(round_wall(std::numeric_limits<float>::infinity()));
  EXPECT_GT(empty_at(table, 125), 5.0F);
  EXPECT_LT(empty_at(table, 125), 10.0F) << "a sensor loses surfaces before the range it states";
  EXPECT_EQ(empty_at(table, 50), 0.0F) << "there is a hit";
}

TEST(BearingTable, ABeamThatEndsTooNearSaysNothingOfWhatIsBehind) {
  EXPECT_EQ(empty_at(table_of(round_wall(0.1F)), 125), 0.0F);
}

TEST(BearingTable, AFewMissingBeamsAreLostBeamsNotEmptiness) {
  std::vector<float> ranges(kBeams, 3.0F);
  ranges[125] = std::numeric_limits<float>::infinity();
  EXPECT_EQ(empty_at(table_of(ranges), 125), 0.0F);
}

}  // namespace
}  // namespace phasescan::bearing_table_test
