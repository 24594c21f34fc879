/// Benchmarks and sensors as YAML files: configs/bench-*.yaml, configs/sensors/*.yaml.
#pragma once

#include <string>
#include <vector>

#include "sim/pairs.hpp"

namespace phasescan::sim {

/// Reads a benchmark from YAML text: `seed` and `rows`, each row the fields of PairRow.
/// @param name  what to call the text in errors
/// @throws InputError with the line: not YAML, an unknown key, a value of the wrong kind or out of bounds.
PairsSpec parse_pairs_spec(const std::string& text, const std::string& name);

/// The benchmark in a file, or the built-in one of that name ("bench-sim.yaml" or "bench-sim") where no such file is
/// there.
/// @throws InputError, SystemError (not readable)
PairsSpec read_pairs_spec(const std::string& path_or_name);

/// Reads a sensor from YAML text: the fields of LidarOptions; `like: NAME` starts from another sensor instead of the
/// defaults. @throws InputError as above.
LidarOptions parse_lidar(const std::string& text, const std::string& name);

/// The sensor in a file, or the built-in one of that name where no such file is there. @throws InputError, SystemError
LidarOptions read_lidar(const std::string& path_or_name);

/// Names of what is built in.
std::vector<std::string> pairs_spec_names();
std::vector<std::string> lidar_names();

}  // namespace phasescan::sim
