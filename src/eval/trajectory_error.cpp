#include "eval/trajectory_error.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

namespace phasescan {
namespace {

/// Index of the pose nearest in time; `order` sorts `poses` by stamp. The earlier one of two equally near.
std::size_t nearest_in_time(std::span<const StampedPose> poses, const std::vector<std::size_t>& order, Stamp stamp) {
  const auto after =
      std::lower_bound(order.begin(), order.end(), stamp, [&](std::size_t i, Stamp s) { return poses[i].stamp < s; });
  if (after == order.begin()) return *after;
  if (after == order.end()) return *(after - 1);
  const Stamp gap_after = poses[*after].stamp - stamp, gap_before = stamp - poses[*(after - 1)].stamp;
  return gap_after < gap_before ? *after : *(after - 1);
}

std::vector<std::size_t> step_ends(const AssociatedPoses& poses, double delta, StepUnit unit) {
  std::vector<std::size_t> ends;
  if (unit == StepUnit::kFrames) {
    // A step beyond the end is one that nothing makes, however long.
    const auto count = static_cast<double>(poses.estimate.size());
    const auto step = static_cast<std::size_t>(std::clamp(std::round(delta), 1.0, std::max(count, 1.0)));
    for (std::size_t i = 0; i < poses.estimate.size(); i += step) ends.push_back(i);
    return ends;
  }
  double travelled = 0.0;
  for (std::size_t i = 0; i < poses.estimate.size(); ++i) {
    if (i > 0) travelled += translation_distance(poses.estimate[i - 1], poses.estimate[i]);
    if (travelled >= delta) {
      ends.push_back(i);
      travelled = 0.0;
    }
  }
  return ends;
}

}  // namespace

ErrorStats error_stats(std::span<const double> errors) {
  ErrorStats s;
  s.n = errors.size();
  if (errors.empty()) return s;
  const auto n = static_cast<double>(errors.size());
  std::vector<double> sorted(errors.begin(), errors.end());
  std::sort(sorted.begin(), sorted.end());
  for (const double e : errors) {
    s.mean += e;
    s.sse += e * e;
  }
  s.mean /= n;
  s.rmse = std::sqrt(s.sse / n);
  double variance = 0.0;
  for (const double e : errors) variance += (e - s.mean) * (e - s.mean);
  s.std = std::sqrt(variance / n);
  const std::size_t middle = sorted.size() / 2;
  s.median = sorted.size() % 2 ? sorted[middle] : 0.5 * (sorted[middle - 1] + sorted[middle]);
  s.min = sorted.front();
  s.max = sorted.back();
  return s;
}

AssociatedPoses associate(std::span<const StampedPose> estimate, std::span<const StampedPose> reference,
                          double max_gap_s) {
  AssociatedPoses out;
  if (estimate.empty() || reference.empty()) return out;
  const bool estimate_longer = estimate.size() > reference.size();
  const auto longer = estimate_longer ? estimate : reference;
  const auto shorter = estimate_longer ? reference : estimate;
  std::vector<std::size_t> order(longer.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return longer[a].stamp < longer[b].stamp; });
  const auto max_gap = static_cast<Stamp>(max_gap_s * 1e9);
  for (const StampedPose& pose : shorter) {
    const StampedPose& other = longer[nearest_in_time(longer, order, pose.stamp)];
    if (std::abs(other.stamp - pose.stamp) > max_gap) continue;
    out.estimate.push_back(estimate_longer ? other.pose : pose.pose);
    out.reference.push_back(estimate_longer ? pose.pose : other.pose);
  }
  return out;
}

Pose2 align_se2(const AssociatedPoses& poses) {
  const std::size_t n = poses.estimate.size();
  if (n == 0) return {};
  Eigen::Vector2d mean_e = Eigen::Vector2d::Zero(), mean_r = Eigen::Vector2d::Zero();
  for (std::size_t i = 0; i < n; ++i) {
    mean_e += poses.estimate[i].translation();
    mean_r += poses.reference[i].translation();
  }
  mean_e /= static_cast<double>(n);
  mean_r /= static_cast<double>(n);
  double dot = 0.0, cross = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    const Eigen::Vector2d e = poses.estimate[i].translation() - mean_e, r = poses.reference[i].translation() - mean_r;
    dot += e.dot(r);
    cross += e.x() * r.y() - e.y() * r.x();
  }
  const Pose2 turn{0.0, 0.0, dot == 0.0 && cross == 0.0 ? 0.0 : std::atan2(cross, dot)};
  const Eigen::Vector2d shift = mean_r - turn * mean_e;
  return {shift.x(), shift.y(), turn.theta};
}

std::vector<double> absolute_trajectory_errors(const AssociatedPoses& poses, bool align) {
  const Pose2 T_reference_estimate = align ? align_se2(poses) : Pose2{};
  std::vector<double> errors;
  errors.reserve(poses.estimate.size());
  for (std::size_t i = 0; i < poses.estimate.size(); ++i) {
    errors.push_back(translation_distance(T_reference_estimate * poses.estimate[i], poses.reference[i]));
  }
  return errors;
}

std::vector<double> absolute_rotation_errors(const AssociatedPoses& poses, bool align) {
  const double turn = align ? align_se2(poses).theta : 0.0;
  std::vector<double> errors;
  errors.reserve(poses.estimate.size());
  for (std::size_t i = 0; i < poses.estimate.size(); ++i)
    errors.push_back(angle_distance(poses.estimate[i].theta + turn, poses.reference[i].theta));
  return errors;
}

RelativeErrors relative_pose_errors(const AssociatedPoses& poses, double delta, StepUnit unit) {
  if (!(delta > 0.0)) throw std::invalid_argument("eval.delta: " + std::to_string(delta) + " is not above 0");
  const std::vector<std::size_t> ends = step_ends(poses, delta, unit);
  RelativeErrors errors;
  for (std::size_t k = 1; k < ends.size(); ++k) {
    const std::size_t i = ends[k - 1], j = ends[k];
    const Pose2 reference_step = poses.reference[i].inverse() * poses.reference[j];
    const Pose2 estimate_step = poses.estimate[i].inverse() * poses.estimate[j];
    const Pose2 error = reference_step.inverse() * estimate_step;
    errors.translation.push_back(std::hypot(error.x, error.y));
    errors.rotation.push_back(std::abs(error.theta));
  }
  return errors;
}

}  // namespace phasescan
