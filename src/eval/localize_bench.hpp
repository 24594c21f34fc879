/// Localisation measured: scans with their true poses on maps that were made by SLAM or by others, and what became of
/// them.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "eval/statistics.hpp"
#include "phasescan/localize/localizer.hpp"
#include "sim/lidar.hpp"
#include "sim/world.hpp"

namespace phasescan {

/// A scan and where it was taken.
struct LocalizeCase {
  RangeMeasurement measurement;
  Pose2 T_map_base;
};

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

/// One case answered.
struct LocalizeRow {
  LocalizationUpdate update;
  double error_m = 0.0, error_rad = 0.0;
  double ms = 0.0;
  bool named = false;  ///< the truth is among the hypotheses
  bool right() const;  ///< within 0.1 m and 3 deg
};
std::vector<LocalizeRow> answer_all(const LocalizationMap& map, const std::vector<LocalizeCase>& cases,
                                    const LocalizeOptions& options, const std::function<void(std::size_t)>& progress);

/// What came of them.
struct LocalizeScore {
  std::size_t n = 0, right = 0, within_half_m = 0, ok = 0, right_ok = 0, wrong_ok = 0, ambiguous = 0,
              ambiguous_named = 0, lost = 0;
  double median_m = 0.0, median_deg = 0.0, ms_p50 = 0.0, ms_p99 = 0.0;
  double calibration_error = 0.0;
};
LocalizeScore score_of(const std::vector<LocalizeRow>& rows);

}  // namespace phasescan
