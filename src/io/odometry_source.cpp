#include "io/odometry_source.hpp"

#include <cmath>
namespace phasescan {
namespace {

constexpr double kSameM = 1e-6, kSameRad = 1e-6;
constexpr std::size_t kFirstScans = 50;

bool left_by_mapping(const std::map<std::string, std::string>& facts) {
  for (const auto& [name, value] : facts) {
    if (name.find("NEFF") != std::string::npos || name.find("SM_UPDATE") != std::string::npos) return true;
  }
  return false;
}

}  // namespace

OdometrySource source_of_same_poses(const std::map<std::string, std::string>& facts) {
  if (left_by_mapping(facts)) {
    return {
        false,
        "odometry and corrected pose are the same in every scan and a mapping program has left its marks: counted as no odometry"};
  }
  return {
      true,
      "odometry and corrected pose are the same in every scan, with no mark of a mapping program: taken as odometry"};
}

OdometrySource find_odometry_source(const std::string& path, const LogOptions& options) {
  const auto reader = open_log(path, options);
  std::size_t scans = 0, with_both = 0, same = 0;
  while (const auto entry = reader->next()) {
    ++scans;
    if (entry->odometry && entry->corrected) {
      ++with_both;
      const Pose2 off = (*entry->odometry * entry->T_base_laser).inverse() * *entry->corrected;
      same += std::hypot(off.x, off.y) < kSameM && std::abs(off.theta) < kSameRad;
    }
    if (scans >= kFirstScans && (with_both == 0 || same < with_both)) break;
  }
  if (with_both == 0 || same < with_both) return {true, "the log's odometry is used"};
  return source_of_same_poses(reader->facts());
}

}  // namespace phasescan
