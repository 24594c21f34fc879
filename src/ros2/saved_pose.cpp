#include "ros2/saved_pose.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <sstream>

#include "io/file.hpp"
#include "phasescan/io/error.hpp"

namespace phasescan::ros2 {

void write_saved_pose(const std::string& file, const SavedPose& pose) {
  std::string text = fmt::format("{} {:.17g} {:.17g} {:.17g}", pose.stamp, pose.T_map_base.x, pose.T_map_base.y,
                                 pose.T_map_base.theta);
  for (int i = 0; i < 9; ++i) text += fmt::format(" {:.17g}", pose.covariance(i / 3, i % 3));
  write_file(file, text + "\n");
}

std::optional<SavedPose> read_saved_pose(const std::string& file) {
  if (!std::filesystem::exists(file)) return std::nullopt;
  std::istringstream words(read_file(file, 4096));
  SavedPose pose;
  words >> pose.stamp >> pose.T_map_base.x >> pose.T_map_base.y >> pose.T_map_base.theta;
  for (int i = 0; i < 9; ++i) words >> pose.covariance(i / 3, i % 3);
  if (!words || !pose.T_map_base.is_finite() || !pose.covariance.allFinite())
    throw InputError(file, 1, "is no saved pose; expected a stamp, x y theta and 9 numbers of a covariance");
  return pose;
}

}  // namespace phasescan::ros2
