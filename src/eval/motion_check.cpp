#include "eval/motion_check.hpp"

#include <cmath>

#include "phasescan/core/pose2.hpp"

namespace phasescan {
namespace {

constexpr std::size_t kPairsAtAStride = 40;
constexpr std::size_t kFewestHits = 20;
constexpr std::size_t kLongestPair = 20;     ///< scans from an anchor to its partner
const double kEnoughTurn = deg_to_rad(5.0);  ///< odometry that makes a pair worth a match
constexpr double kEnoughPath = 0.15;         ///< [m]
const double kFastTurn = deg_to_rad(20.0);
constexpr double kFastPath = 0.5;

}  // namespace

void MotionCheck::add(const LogEntry& entry) {
  const std::size_t index = index_++;
  if (!anchor_ && index < next_) return;
  if (entry.scan.hit_count() < kFewestHits) return;
  const Scan scan = entry.flipped ? mirrored_scan(entry.scan) : entry.scan;
  std::optional<Pose2> T_odom_laser;
  if (entry.odometry) T_odom_laser = *entry.odometry * entry.T_base_laser;
  if (anchor_) {
    const std::size_t apart = index - anchor_->index;
    bool worth = apart >= 1;
    if (T_odom_laser && anchor_->T_odom_laser) {
      const Pose2 step = anchor_->T_odom_laser->inverse() * *T_odom_laser;
      worth = std::abs(step.theta) > kEnoughTurn || std::hypot(step.x, step.y) > kEnoughPath;
    }
    if (!worth && apart < kLongestPair) return;
    if (worth) match_with_anchor(scan, T_odom_laser, apart == 1);
    anchor_.reset();
    // The first pairs lie close together, later ones ever farther apart: any length of log, the same work.
    if (++at_stride_ == kPairsAtAStride) {
      at_stride_ = 0;
      stride_ *= 2;
    }
    next_ = index + stride_;
    if (stride_ > 1) return;
  }
  anchor_ = Anchor{scan, T_odom_laser, index};
}

void MotionCheck::match_with_anchor(const Scan& scan, const std::optional<Pose2>& T_odom_laser, bool neighbour) {
  const MatchResult result = matcher_.match(anchor_->scan, scan);
  if (!result.usable) {
    ++counts_.unmatched;
    return;
  }
  ++counts_.matched;
  const Pose2& step = result.T_ref_scan;
  if (neighbour) {
    ++counts_.neighbours;
    if (std::abs(step.theta) > kFastTurn || std::hypot(step.x, step.y) > kFastPath) ++counts_.fast;
  }
  if (T_odom_laser && anchor_->T_odom_laser) compare(step, anchor_->T_odom_laser->inverse() * *T_odom_laser);
}

void MotionCheck::compare(const Pose2& matched, const Pose2& odometry) {
  ++counts_.compared;
  const double turn_slack = deg_to_rad(2.0) + 0.3 * std::abs(odometry.theta);
  const bool turn_same = std::abs(wrap_angle(matched.theta - odometry.theta)) < turn_slack;
  if (std::abs(odometry.theta) > kEnoughTurn) {
    if (turn_same) ++counts_.turns_same;
    if (std::abs(wrap_angle(matched.theta + odometry.theta)) < turn_slack) ++counts_.turns_opposite;
  }
  const double path = std::hypot(odometry.x, odometry.y);
  const double path_slack = 0.05 + 0.3 * path;
  const bool path_same = std::hypot(matched.x - odometry.x, matched.y - odometry.y) < path_slack;
  if (path > kEnoughPath && std::abs(odometry.theta) < kEnoughTurn) {
    if (path_same) ++counts_.moves_same;
    if (std::hypot(matched.x + odometry.x, matched.y + odometry.y) < path_slack) ++counts_.moves_backwards;
  }
  if (!turn_same || !path_same) ++counts_.disagree;
}

}  // namespace phasescan
