#include "slam/visit_maps.hpp"

#include <algorithm>

namespace phasescan {
namespace {

constexpr std::size_t kCachedMaps = 4;  // a keyframe is compared with loops.clusters_per_node visits, 2 unless asked
constexpr double kMarginM = 5.0;        // beyond the reach of scans: two scans of one map stand that far apart at most
constexpr double kViewWeight = 0.5;  // of the distance between what two keyframes look at, against that of their poses

void reset(LocalMap& map, const Pose2& pose, const OdometryOptions& options) {
  map.reset(pose, options.map_range_m + kMarginM, options.cell_m);
}

}  // namespace

const LocalMap& VisitMaps::around(int anchor, const GraphSession& session) {
  if (optimisations_ != session.optimisations()) entries_.clear();
  optimisations_ = session.optimisations();
  for (const Entry& entry : entries_) {
    if (entry.anchor == anchor) return *entry.map;
  }
  if (entries_.size() < kCachedMaps) {
    entries_.push_back({anchor, std::make_unique<LocalMap>()});
    next_ = entries_.size() - 1;
  } else {
    next_ = (next_ + 1) % kCachedMaps;
    entries_[next_].anchor = anchor;
  }
  LocalMap& map = *entries_[next_].map;
  const auto& poses = session.poses();
  const auto& keyframes = session.keyframes();
  reset(map, poses[static_cast<std::size_t>(anchor)], options_);
  // Where tracking broke the visit ends: how the two sides lie to each other is a guess.
  int from = anchor, to = anchor;
  while (from > std::max(0, anchor - kVisitNodes) && !keyframes[static_cast<std::size_t>(from)].new_segment) --from;
  while (to < std::min(session.last_node(), anchor + kVisitNodes) &&
         !keyframes[static_cast<std::size_t>(to) + 1].new_segment)
    ++to;
  for (int k = from; k <= to; ++k) {
    keyframes[static_cast<std::size_t>(k)].points->unpack(points_);
    map.add(points_, poses[static_cast<std::size_t>(k)]);
  }
  map.finish();
  return map;
}

void build_surroundings(const GraphSession& session, int node, double radius_m, std::size_t max_keyframes,
                        const OdometryOptions& options, LocalMap& map) {
  const auto& poses = session.poses();
  const auto& keyframes = session.keyframes();
  const Pose2& here = poses[static_cast<std::size_t>(node)];
  const Eigen::Vector2d centre = here * keyframes[static_cast<std::size_t>(node)].centre;
  std::vector<std::pair<double, int>> near;
  for (std::size_t k = 0; k < keyframes.size(); ++k) {
    const double distance = translation_distance(here, poses[k]);
    if (distance > radius_m) continue;
    near.emplace_back(distance + kViewWeight * (poses[k] * keyframes[k].centre - centre).norm(), static_cast<int>(k));
  }
  if (near.size() > max_keyframes) {
    std::nth_element(near.begin(), near.begin() + static_cast<std::ptrdiff_t>(max_keyframes), near.end());
    near.resize(max_keyframes);
  }
  std::sort(near.begin(), near.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  reset(map, here, options);
  MapPoints points;
  for (const auto& [far, k] : near) {
    keyframes[static_cast<std::size_t>(k)].points->unpack(points);
    map.add(points, poses[static_cast<std::size_t>(k)]);
  }
  map.finish();
}

}  // namespace phasescan
