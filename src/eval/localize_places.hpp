/// Maps that were made by SLAM or by others, and scans on them with their true poses.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "phasescan/map/trinary_map.hpp"
#include "phasescan/odometry/odometry.hpp"
#include "sim/lidar.hpp"
#include "sim/world.hpp"

namespace phasescan {

/// A scan and where it was taken.
struct LocalizeCase {
  RangeMeasurement measurement;
  Pose2 T_map_base;
  bool mapped = true;  ///< false: taken in a room that the map has not
};

/// A world, driven through and mapped.
struct MappedWorld {
  sim::World world;
  TrinaryMap map;
  Pose2 T_map_world;
  double error_m = 0.0;  ///< 95 % of the mapping drive's poses are off by less
};
/// @param name  KIND:SEED
MappedWorld map_world(const std::string& name, const sim::LidarOptions& lidar, std::uint64_t seed);

/// Makes a share of the rooms unknown to the map, the walls around them too. @return their numbers
std::vector<std::size_t> wipe_rooms(double share, std::uint64_t seed, MappedWorld& mapped);

/// Whether the drive has seen that a robot can stand there: rooms that it never looked into are not on the map.
bool stands_on_map(const TrinaryMap& map, const Pose2& T_map_base);

/// A map and scans on it.
struct LocalizePlaces {
  std::string name;
  TrinaryMap map;
  std::vector<LocalizeCase> cases;
};

/// Where cases come from: worlds that a simulated drive makes a map of, side by side on one map.
struct SimulatedPlacesSpec {
  std::vector<std::string> worlds;  ///< KIND:SEED
  std::string sensor = "rplidar-a1-real";
  std::size_t poses = 200;
  double moved = 0.0;     ///< share of the furniture and doors that are elsewhere than when the map was made
  int people = 0;         ///< most that stand about
  double unmapped = 0.0;  ///< share of the scans from rooms that were wiped from the map
  double clearance_m = 0.3;
  std::uint64_t seed = 1;
};
/// @param progress  called after each world
LocalizePlaces simulated_places(const SimulatedPlacesSpec& spec, const std::function<void()>& progress);

/// The protocol of [CBGL24]: rays cast on the map itself, in its largest connected free area.
struct CastPlacesSpec {
  std::size_t poses = 100, draws = 20;
  int rays = 360;
  double range_m = 10.0, sigma_m = 0.05, clearance_m = 0.3;
  std::uint64_t seed = 1;
};
LocalizePlaces cast_places(const std::string& name, const TrinaryMap& map, const CastPlacesSpec& spec);

}  // namespace phasescan
