#include "slam/loop_consistency.hpp"

#include <algorithm>
#include <cmath>

namespace phasescan {
namespace {

constexpr int kNeighbourNodes = 30;       // loops of nodes no farther apart are compared with each other
constexpr std::size_t kMostWaiting = 64;  // two clusters a node over 30 nodes

bool within(const Pose2& error, double metres, double degrees) {
  return std::hypot(error.x, error.y) < metres && std::abs(error.theta) < deg_to_rad(degrees);
}

}  // namespace

std::vector<Loop> LoopConsistency::add(const Loop& loop, std::span<const Pose2> poses, SmallLoops small) {
  const auto pose = [&](int node) { return poses[static_cast<std::size_t>(node)]; };
  const Pose2 error = asked_correction(loop, poses);
  if (small == SmallLoops::kAccepted && within(error, options_.small_error_m, options_.small_error_deg)) return {loop};
  std::vector<Loop>& waiting = state_.waiting;
  auto kept = waiting.begin();
  while (kept != waiting.end() &&
         (kept->to < loop.to - kNeighbourNodes || static_cast<std::size_t>(waiting.end() - kept) >= kMostWaiting)) {
    ++kept;
    ++state_.rejected;
  }
  waiting.erase(waiting.begin(), kept);
  std::vector<Loop> agreed = {loop};
  for (const Loop& other : waiting) {
    // Where `loop.to` would be if the other loop were right.
    const Pose2 by_other = pose(other.from) * other.T_from_to * (pose(other.to).inverse() * pose(loop.to));
    const Pose2 by_this = pose(loop.from) * loop.T_from_to;
    if (other.to != loop.to && within(by_this.inverse() * by_other, options_.agree_m, options_.agree_deg))
      agreed.push_back(other);
  }
  if (agreed.size() < static_cast<std::size_t>(options_.votes)) {
    waiting.push_back(loop);
    return {};
  }
  std::erase_if(waiting, [&agreed](const Loop& other) {
    return std::any_of(agreed.begin(), agreed.end(),
                       [&other](const Loop& a) { return a.from == other.from && a.to == other.to; });
  });
  return agreed;
}

void LoopConsistency::close() {
  state_.rejected += state_.waiting.size();
  state_.waiting.clear();
}

}  // namespace phasescan
