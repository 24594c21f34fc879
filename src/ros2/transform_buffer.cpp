#include "ros2/transform_buffer.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "io/ros_tf.hpp"

namespace phasescan::ros2 {
namespace {

constexpr std::size_t kMostFrames = 1024, kMostPoses = 4096;
constexpr int kDeepest = 64;
constexpr double kLeastNorm = 1e-3;

std::optional<Pose3> to_pose3(const Transform& transform) {
  Pose3 pose;
  pose.translation = {transform.translation.x, transform.translation.y, transform.translation.z};
  const Quaternion& q = transform.rotation;
  pose.rotation = Eigen::Quaterniond(q.w, q.x, q.y, q.z);
  const double norm = pose.rotation.norm();
  if (!pose.translation.allFinite() || !std::isfinite(norm) || norm < kLeastNorm) return std::nullopt;
  pose.rotation.coeffs() /= norm;
  return pose;
}

/// Up from a frame to the root: T_frame_start of each step.
struct Step {
  std::string_view frame;
  Pose3 T_frame_start;
};

}  // namespace

Pose3 operator*(const Pose3& T_a_b, const Pose3& T_b_c) {
  return {T_a_b.rotation * T_b_c.translation + T_a_b.translation, (T_a_b.rotation * T_b_c.rotation).normalized()};
}

Pose3 inverse(const Pose3& T_a_b) {
  const Eigen::Quaterniond back = T_a_b.rotation.conjugate();
  return {-(back * T_a_b.translation), back};
}

Pose3 interpolate(const Pose3& a, const Pose3& b, double share) {
  return {a.translation + share * (b.translation - a.translation), a.rotation.slerp(share, b.rotation).normalized()};
}

const char* text_of(TransformFound found) {
  switch (found) {
    case TransformFound::kFound:
      return "found";
    case TransformFound::kUnknownFrame:
      return "unknown frame";
    case TransformFound::kNotConnected:
      return "not connected";
    case TransformFound::kTooEarly:
      return "older than what is kept";
    case TransformFound::kTooLate:
      return "not there yet";
  }
  return "?";
}

std::size_t TransformBuffer::add(const TFMessage& message, bool is_static) {
  std::size_t left_out = 0;
  for (const TransformStamped& transform : message.transforms) left_out += !add_one(transform, is_static);
  return left_out;
}

bool TransformBuffer::add_one(const TransformStamped& transform, bool is_static) {
  const std::string child = ros::plain_frame(transform.child_frame_id);
  std::string parent = ros::plain_frame(transform.header.frame_id);
  const std::optional<Pose3> pose = to_pose3(transform.transform);
  if (!pose || child.empty() || parent.empty() || child == parent) return false;
  if (edges_.size() >= kMostFrames && !edges_.contains(child)) return false;
  Edge& edge = edges_[child];
  if (edge.is_static != is_static || edge.parent != parent) edge.poses.clear();
  edge.is_static = is_static;
  edge.parent = std::move(parent);
  if (is_static) {
    edge.poses.assign(1, {0, *pose});
    return true;
  }
  const Stamp stamp = transform.header.stamp;
  if (!edge.poses.empty() && edge.poses.back().first - stamp > kJump) edge.poses.clear();
  const auto at = std::lower_bound(edge.poses.begin(), edge.poses.end(), stamp,
                                   [](const auto& known, Stamp wanted) { return known.first < wanted; });
  if (at != edge.poses.end() && at->first == stamp) {
    at->second = *pose;
  } else {
    edge.poses.insert(at, {stamp, *pose});
  }
  while (edge.poses.size() > kMostPoses || edge.poses.back().first - edge.poses.front().first > kept_)
    edge.poses.pop_front();
  return true;
}

TransformFound TransformBuffer::at(const Edge& edge, std::optional<Stamp> stamp, Pose3& out) const {
  if (edge.poses.empty()) return TransformFound::kTooLate;
  if (edge.is_static || !stamp) {
    out = edge.poses.back().second;
    return TransformFound::kFound;
  }
  if (*stamp > edge.poses.back().first) return TransformFound::kTooLate;
  if (*stamp < edge.poses.front().first) return TransformFound::kTooEarly;
  const auto after = std::lower_bound(edge.poses.begin(), edge.poses.end(), *stamp,
                                      [](const auto& known, Stamp wanted) { return known.first < wanted; });
  if (after->first == *stamp) {
    out = after->second;
    return TransformFound::kFound;
  }
  const auto before = std::prev(after);
  const double share = static_cast<double>(*stamp - before->first) / static_cast<double>(after->first - before->first);
  out = interpolate(before->second, after->second, share);
  return TransformFound::kFound;
}

TransformLookup TransformBuffer::look_up(std::string_view target_name, std::string_view source_name,
                                         std::optional<Stamp> stamp) const {
  const std::string target = ros::plain_frame(target_name), source = ros::plain_frame(source_name);
  if (target == source) return {TransformFound::kFound, {}, ""};
  for (const std::string& frame : {target, source}) {
    if (!is_known(frame)) return {TransformFound::kUnknownFrame, {}, frame};
  }
  // The way up from the source, then up from the target until the two meet. A transform that does not reach the time
  // ends its way; it counts only where the ways do not meet below it.
  std::optional<TransformLookup> failed;
  const auto climb = [&](const std::string& start, auto&& meets) {
    Step step{start, {}};
    for (int depth = 0; depth < kDeepest; ++depth) {
      if (meets(step)) return true;
      const auto edge = edges_.find(step.frame);
      if (edge == edges_.end()) return false;
      Pose3 T_parent_frame;
      const TransformFound found = at(edge->second, stamp, T_parent_frame);
      if (found != TransformFound::kFound) {
        if (!failed) failed = TransformLookup{found, {}, edge->first};
        return false;
      }
      step = {edge->second.parent, T_parent_frame * step.T_frame_start};
    }
    return false;
  };
  std::vector<Step> from_source;
  climb(source, [&](const Step& step) {
    from_source.push_back(step);
    return false;
  });
  TransformLookup result{TransformFound::kNotConnected, {}, source};
  const bool met = climb(target, [&](const Step& step) {
    for (const Step& other : from_source) {
      if (other.frame != step.frame) continue;
      result = {TransformFound::kFound, inverse(step.T_frame_start) * other.T_frame_start, ""};
      return true;
    }
    return false;
  });
  if (met || !failed) return result;
  return stamp && look_up(target, source, std::nullopt).found != TransformFound::kFound ? result : *failed;
}

TransformLookup TransformBuffer::find(std::string_view target, std::string_view source, Stamp stamp) const {
  return look_up(target, source, stamp);
}
TransformLookup TransformBuffer::find_newest(std::string_view target, std::string_view source) const {
  return look_up(target, source, std::nullopt);
}

std::optional<Stamp> TransformBuffer::newest(std::string_view child) const {
  const auto edge = edges_.find(ros::plain_frame(child));
  if (edge == edges_.end() || edge->second.is_static || edge->second.poses.empty()) return std::nullopt;
  return edge->second.poses.back().first;
}

bool TransformBuffer::is_known(std::string_view frame) const {
  const std::string plain = ros::plain_frame(frame);
  return edges_.contains(plain) ||
         std::any_of(edges_.begin(), edges_.end(), [&](const auto& edge) { return edge.second.parent == plain; });
}

void TransformBuffer::forget_after(Stamp stamp) {
  for (auto& [child, edge] : edges_) {
    if (!edge.is_static) std::erase_if(edge.poses, [stamp](const auto& pose) { return pose.first > stamp; });
  }
}

}  // namespace phasescan::ros2
