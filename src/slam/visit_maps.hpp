/// Local maps made of keyframes of the graph: what a keyframe is compared with.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "odometry/local_map.hpp"
#include "phasescan/odometry/options.hpp"
#include "slam/graph_session.hpp"

namespace phasescan {

/// Nodes on either side of a visit's anchor that make its map.
inline constexpr int kVisitNodes = 6;

/// Local maps of visits: runs of keyframes around an anchor, as one drive saw them. A cache: what a map holds follows
/// from the nodes and their poses.
class VisitMaps {
 public:
  explicit VisitMaps(const OdometryOptions& options) : options_(options) {}
  /// The map around `anchor`; valid until the next call. @param anchor  with kVisitNodes nodes after it, or no more to
  /// come
  const LocalMap& around(int anchor, const GraphSession& session);

 private:
  OdometryOptions options_;
  struct Entry {
    int anchor = 0;
    std::unique_ptr<LocalMap> map;
  };
  std::vector<Entry> entries_;
  MapPoints points_;  // of one keyframe
  std::size_t next_ = 0;
  std::uint64_t optimisations_ = 0;
};

/// Builds the map of the surroundings of a node from up to `max_keyframes` keyframes of any time that look at the same
/// place, all within `radius_m`. @cost O(nodes) and one local map
void build_surroundings(const GraphSession& session, int node, double radius_m, std::size_t max_keyframes,
                        const OdometryOptions& options, LocalMap& map);

}  // namespace phasescan
