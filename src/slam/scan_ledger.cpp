#include "slam/scan_ledger.hpp"

#include <algorithm>

#include "core/motion.hpp"

namespace phasescan {

void ScanRecord::set(const Pose2& T_keyframe_stamp) {
  x = static_cast<float>(T_keyframe_stamp.x);
  y = static_cast<float>(T_keyframe_stamp.y);
  theta = static_cast<float>(T_keyframe_stamp.theta);
}

PackedCovariance PackedCovariance::of(const Eigen::Matrix3d& m) {
  const Eigen::Matrix3f f = m.cast<float>();
  return {{f(0, 0), f(0, 1), f(0, 2), f(1, 1), f(1, 2), f(2, 2)}};
}

Eigen::Matrix3d PackedCovariance::matrix() const {
  Eigen::Matrix3f m;
  m << value[0], value[1], value[2], value[1], value[3], value[4], value[2], value[4], value[5];
  return m.cast<double>();
}

std::vector<Pose2> poses_of_scans(const ScanLedger& ledger, std::span<const Pose2> keyframes,
                                  std::span<const Pose2> odometry) {
  const std::vector<ScanRecord>& records = ledger.records;
  std::vector<Pose2> out;
  out.reserve(records.size());
  std::size_t begin = 0;
  while (begin < records.size()) {
    const std::int32_t keyframe = records[begin].keyframe;
    std::size_t end = begin;
    while (end < records.size() && records[end].keyframe == keyframe) ++end;
    const auto k = static_cast<std::size_t>(keyframe);
    const bool known = keyframe >= 0 && k < keyframes.size();
    // What the map corrected between this keyframe and the next happened on the way there, not at its end.
    Twist2 correction;
    if (known && k + 1 < keyframes.size() &&
        !std::binary_search(ledger.breaks.begin(), ledger.breaks.end(), keyframe + 1)) {
      const Pose2 on_map = keyframes[k].inverse() * keyframes[k + 1];
      correction = log_pose((odometry[k].inverse() * odometry[k + 1]).inverse() * on_map);
    }
    for (std::size_t i = begin; i < end; ++i) {
      const Pose2 T_keyframe_stamp = records[i].T_keyframe_stamp();
      const double share = static_cast<double>(i - begin) / static_cast<double>(end - begin);
      const Pose2 part = exp_twist(correction, share);
      out.push_back(known ? keyframes[k] * T_keyframe_stamp * part : T_keyframe_stamp);
    }
    begin = end;
  }
  return out;
}

}  // namespace phasescan
