#include "io/ros_tf.hpp"

#include <algorithm>
#include <cmath>

namespace phasescan::ros {
namespace {

constexpr std::size_t kMostFrames = 4096;
constexpr int kDeepest = 64;

}  // namespace

std::string plain_frame(std::string_view name) {
  if (!name.empty() && name.front() == '/') name.remove_prefix(1);
  return std::string(name);
}

Pose2 planar(const Pose3& pose) {
  const Eigen::Vector3d ahead = pose.rotation * Eigen::Vector3d::UnitX();
  return {pose.translation.x(), pose.translation.y(), std::atan2(ahead.y(), ahead.x())};
}

void TransformTree::add(const Transform& transform) {
  const std::string child = plain_frame(transform.child_frame_id);
  if (parents_.size() >= kMostFrames && !parents_.contains(child)) return;
  parents_[child] = {plain_frame(transform.header.frame_id), transform.pose};
}

std::optional<Pose3> TransformTree::find(const std::string& a, const std::string& b) const {
  // The way up from b with T_ancestor_b for each step, then up from a until the two ways meet.
  const auto step_up = [this](std::string& frame, Pose3& T_frame_start) {
    const auto edge = parents_.find(frame);
    if (edge == parents_.end()) return false;
    const Pose3& up = edge->second.pose;
    T_frame_start.translation = up.rotation * T_frame_start.translation + up.translation;
    T_frame_start.rotation = up.rotation * T_frame_start.rotation;
    frame = edge->second.parent;
    return true;
  };
  std::map<std::string, Pose3> from_b;
  std::string frame = b;
  Pose3 T_frame_b;
  for (int depth = 0; depth < kDeepest; ++depth) {
    from_b.emplace(frame, T_frame_b);
    if (!step_up(frame, T_frame_b)) break;
  }
  frame = a;
  Pose3 T_frame_a;
  for (int depth = 0; depth < kDeepest; ++depth) {
    if (const auto met = from_b.find(frame); met != from_b.end()) {
      const Eigen::Quaterniond back = T_frame_a.rotation.conjugate();
      return Pose3{back * (met->second.translation - T_frame_a.translation), back * met->second.rotation};
    }
    if (!step_up(frame, T_frame_a)) break;
  }
  return std::nullopt;
}

std::optional<Mounting> TransformTree::mounting(const std::string& base, const std::string& laser) const {
  for (const std::string& candidate : {base, std::string("base_link"), std::string("base_footprint")}) {
    if (candidate.empty()) continue;
    const std::optional<Pose3> pose = find(candidate, laser);
    if (!pose) continue;
    const Eigen::Vector3d up = pose->rotation * Eigen::Vector3d::UnitZ();
    return Mounting{planar(*pose), up.z() < 0.0, std::acos(std::clamp(std::abs(up.z()), 0.0, 1.0))};
  }
  return std::nullopt;
}

}  // namespace phasescan::ros
