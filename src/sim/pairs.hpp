/// Simulated pairs of scans with known truth: rows of a benchmark, each pair made from its own seed.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/pairs.hpp"
#include "sim/lidar.hpp"
#include "sim/world_kinds.hpp"

namespace phasescan::sim {

/// How far apart the two poses are: the sets of [Jiang19] Sec. 5.2, `global`, and `none` (two different places).
enum class PairClass { kSmall, kMiddle, kLarge, kGlobal, kNone };

/// Distance [m] and turn [rad] a class allows, inclusive.
struct PairBounds {
  double distance_min, distance_max;
  double turn_min, turn_max;
};
PairBounds pair_bounds(PairClass cls);

/// One row of a benchmark.
struct PairRow {
  std::string dataset = "sim";
  std::vector<WorldKind> worlds{WorldKind::kRoom};  ///< one is drawn for each pair, and a building of that kind
  std::shared_ptr<const World> fixed;               ///< if set, all pairs are of this world instead
  std::vector<PairClass> classes{PairClass::kSmall, PairClass::kMiddle, PairClass::kLarge,
                                 PairClass::kGlobal};  ///< taken in turn
  std::string sensor = "rplidar-a1";
  int weight = 1;  ///< share of the file's pairs

  double fov_deg = 0.0;       ///< the sensor's own at 0
  double clearance_m = 0.25;  ///< of both poses to everything
  double overlap_min = 0.0;   ///< share of surface that both scans see (see Overlap)
  double overlap_max = 1.0;
  bool turned_frame = false;  ///< both scans look much the same way (within 30 deg); the class's turn is that of the
                              ///< sensor's frame, so that angle_min differs between them: for a narrow view
  bool through_door = false;  ///< the way from one pose to the other leads through a doorway
  int moved_min = 0;          ///< objects that stand elsewhere in the second scan
  int moved_max = 0;
  int people_max = 0;         ///< people, elsewhere in each scan
  double dead_min_deg = 0.0;  ///< width of a sector of the sensor that sees nothing
  double dead_max_deg = 0.0;
  double moved_share = 0.0;  ///< share of each scan's beams that end on something that moved
};

/// @throws std::invalid_argument naming the row and the field that is out of bounds.
void check_pair_row(const PairRow& row);

/// A benchmark: what a configs/bench-*.yaml says.
struct PairsSpec {
  std::uint64_t seed = 1;
  std::vector<PairRow> rows;
};

/// A pair with what only the simulator knows of it.
struct SimulatedPair {
  ScanPair pair;
  Pose2 T_world_ref;
  Pose2 T_world_scan;
  World world;      ///< of the reference; class none: the scan's is another
  Shape loose_ref;  ///< what stood in the reference's world beside that
  Shape loose_scan;
  LidarOptions lidar;
};

/// Makes pairs in any order; pair k is the same whatever else was made.
class PairGenerator {
 public:
  /// @throws std::invalid_argument for a spec without rows, or a row whose values are out of bounds; InputError for a
  /// sensor that is neither a file nor built in.
  PairGenerator(PairsSpec spec, std::uint64_t seed);

  /// Pair k of the file. Rows take turns by weight, a row's classes take turns within it.
  /// @throws std::invalid_argument naming the row if no such pair could be placed in any of many worlds.
  SimulatedPair make(std::uint64_t k) const;

  const PairsSpec& spec() const { return spec_; }

 private:
  PairsSpec spec_;
  std::uint64_t seed_;
  std::vector<std::size_t> turns_;         ///< row of pair k % turns_.size()
  std::vector<std::size_t> index_in_row_;  ///< how many of that row came before it in one round
  std::vector<LidarOptions> lidars_;       ///< by row
};

}  // namespace phasescan::sim

namespace phasescan {
template <>
std::span<const std::string_view> enum_names<sim::PairClass>();
}  // namespace phasescan
