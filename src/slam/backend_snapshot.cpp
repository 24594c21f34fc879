#include "slam/backend_snapshot.hpp"

#include <algorithm>
#include <cmath>

#include "core/motion.hpp"

namespace phasescan {
namespace {

constexpr double kLeverM = 5.0;  // what a turn moves: walls so far from the laser

}  // namespace

SnapshotNode node_of(const Keyframe& keyframe) {
  return {keyframe.stored,      keyframe.own_scan,     keyframe.scan,
          keyframe.T_mid_stamp, keyframe.T_base_laser, keyframe.twist};
}

void SnapshotNodes::push_back(SnapshotNode node) {
  // What is published stays as it is: the last block is replaced by one that holds the new node as well.
  std::vector<SnapshotNode> last;
  last.reserve(kBlock);
  if (size_ % kBlock != 0) {
    last = *blocks_.back();
    last.reserve(kBlock);
    blocks_.pop_back();
  }
  last.push_back(std::move(node));
  blocks_.push_back(std::make_shared<const std::vector<SnapshotNode>>(std::move(last)));
  ++size_;
}

bool SnapshotRenderer::is_drawn_as(const BackendSnapshot& snapshot) const {
  std::size_t next = 0;
  for (std::size_t node = 0; node < snapshot.poses.size() && next < drawn_.size(); ++node) {
    if (largest_piece_ && !snapshot.pieces.in_largest(node)) continue;
    const Drawn& drawn = drawn_[next++];
    if (drawn.node != node) return false;
    const Pose2& now = snapshot.poses[node];
    const double moved =
        translation_distance(drawn.T_map_base, now) + kLeverM * angle_distance(drawn.T_map_base.theta, now.theta);
    if (moved > tolerance_m_) return false;
  }
  return next == drawn_.size();
}

const OccupancyGrid& SnapshotRenderer::draw(const BackendSnapshot& snapshot) {
  if (!is_drawn_as(snapshot)) {
    grid_.clear();
    drawn_.clear();
  }
  for (std::size_t node = drawn_.empty() ? 0 : drawn_.back().node + 1; node < snapshot.poses.size(); ++node) {
    if (largest_piece_ && !snapshot.pieces.in_largest(node)) continue;
    const SnapshotNode& at = snapshot.nodes[node];
    const Pose2& T_map_base = snapshot.poses[node];
    grid_.add_scan(at.scan(), T_map_base * at.T_mid_stamp * at.T_base_laser,
                   deskew_ ? twist_of_frame(at.T_base_laser, at.twist) : Twist2{});
    drawn_.push_back({node, T_map_base});
  }
  return grid_;
}

}  // namespace phasescan
