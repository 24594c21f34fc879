#include <algorithm>

#include "phasescan/slam/result.hpp"

namespace phasescan {

const char* to_string(Verdict verdict) {
  switch (verdict) {
    case Verdict::kGood:
      return "good";
    case Verdict::kDoubtful:
      return "doubtful";
    case Verdict::kFailed:
      break;
  }
  return "failed";
}

std::size_t SlamResult::scans_left_out() const {
  return static_cast<std::size_t>(
      std::count_if(scans.begin(), scans.end(), [](const ScanResult& s) { return !s.on_map || s.left_out; }));
}

std::size_t SlamResult::scans_off_the_map() const {
  return static_cast<std::size_t>(
      std::count_if(scans.begin(), scans.end(), [](const ScanResult& s) { return !s.on_map; }));
}

std::vector<Pose2> SlamResult::trajectory() const {
  std::vector<Pose2> poses;
  poses.reserve(scans.size());
  for (const ScanResult& scan : scans) poses.push_back(scan.T_map_base);
  return poses;
}

std::vector<Pose2> SlamResult::odometry_trajectory() const {
  std::vector<Pose2> poses;
  poses.reserve(scans.size());
  for (const ScanResult& scan : scans) poses.push_back(scan.T_odom_base);
  return poses;
}

}  // namespace phasescan
