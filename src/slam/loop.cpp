#include "slam/loop.hpp"

#include <cmath>

namespace phasescan {
namespace {

constexpr int kNeighbourNodes = 30;  // loops of keyframes no farther apart vote together
constexpr std::size_t kMaxWaiting = 64;

bool within(const Pose2& error, double metres, double degrees) {
  return std::hypot(error.x, error.y) < metres && std::abs(error.theta) < deg_to_rad(degrees);
}

}  // namespace

std::vector<Loop> LoopJudge::add(const Loop& loop, std::span<const Pose2> poses, double uncertainty_m) {
  const auto pose = [&](int node) { return poses[static_cast<std::size_t>(node)]; };
  const Pose2 error = pose(loop.to).inverse() * (pose(loop.from) * loop.T_from_to);
  if (within(error, options_.small_error_m + uncertainty_m, options_.small_error_deg)) return {loop};
  while (!waiting_.empty() && (waiting_.front().to < loop.to - kNeighbourNodes || waiting_.size() >= kMaxWaiting)) {
    waiting_.pop_front();
    ++dropped_;
  }
  std::vector<Loop> agreed = {loop};
  for (const Loop& other : waiting_) {
    // Where `loop.to` would be if the other loop were right.
    const Pose2 by_other = pose(other.from) * other.T_from_to * (pose(other.to).inverse() * pose(loop.to));
    const Pose2 by_this = pose(loop.from) * loop.T_from_to;
    if (other.to != loop.to && within(by_this.inverse() * by_other, options_.agree_m, options_.agree_deg))
      agreed.push_back(other);
  }
  if (agreed.size() < static_cast<std::size_t>(options_.votes)) {
    waiting_.push_back(loop);
    return {};
  }
  std::deque<Loop> rest;
  for (const Loop& other : waiting_) {
    bool taken = false;
    for (const Loop& a : agreed) taken = taken || (a.from == other.from && a.to == other.to);
    if (!taken) rest.push_back(other);
  }
  waiting_.swap(rest);
  return agreed;
}

}  // namespace phasescan
