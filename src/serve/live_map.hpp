/// The map as it grows, for who watches: each keyframe is drawn when it comes, and all are drawn anew where the graph
/// has moved them. A known map is shown as it is, with the way on it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "map/occupancy_grid.hpp"
#include "phasescan/live/live.hpp"
#include "slam/backend_snapshot.hpp"

namespace phasescan::serve {

/// Packed cells of a tile, empty for one where nothing is known any more.
///
/// A byte holds a level in its upper four bits and how often it comes, less one, in the lower four; cells row by row
/// from the lower left. Levels: 0 unknown, 1..4 free (p <= 0.196), 5..9 between, 10..15 occupied (p >= 0.65).
using PackedTile = std::string;
using TileIndex = std::pair<int, int>;

constexpr int kTileCells = 64;

/// @cost about 0.2 ms
PackedTile pack_tile(const OccupancyGrid& grid, TileIndex at);

/// All tiles of a map that stands, in cells of the viewer: each shows what the map has at its centre.
std::map<TileIndex, PackedTile> pack_map(const TrinaryMap& map, double resolution_m);

/// A keyframe of the graph, or one that is on its way there.
struct PathNode {
  Pose2 T_map_base;  ///< NaN for one of a piece that is not drawn: where it lies nobody knows
  std::int64_t scan = 0;
};

class LiveMap {
 public:
  explicit LiveMap(const SlamOptions& options);

  /// @return  whether map, path or loops changed
  bool add(const live::LiveUpdate& update);

  const OccupancyGrid& grid() const { return grid_; }
  /// Nodes of the graph, and keyframes that are not there yet.
  const std::vector<PathNode>& path() const { return path_; }
  /// Pairs of indices into `path`.
  const std::vector<std::pair<std::int32_t, std::int32_t>>& loops() const { return loops_; }
  /// Tiles whose picture changed since the last call.
  std::map<TileIndex, PackedTile> take_changed_tiles();
  /// How often all was drawn anew.
  std::uint64_t redrawn() const { return redrawn_; }

 private:
  struct Fresh {
    std::shared_ptr<const RangeMeasurement> measurement;
    PathNode node;
    KeyframeId keyframe = 0;
    Pose2 T_odom_base;
    Twist2 twist;
  };
  void restart();
  void clear_grid();
  void take_snapshot(const BackendSnapshot& snapshot);
  void draw_node(const BackendSnapshot& snapshot, std::size_t node);
  void draw_fresh(const Fresh& fresh);
  bool stands(const BackendSnapshot& snapshot) const;
  void drop_placed(const BackendSnapshot& snapshot);
  void touch(const Scan& scan, const Pose2& T_map_laser);
  bool add_on_known_map(const live::LiveUpdate& update);

  SlamOptions options_;
  OccupancyGrid grid_;
  std::map<std::int64_t, Pose2> drawn_;  // by scan: where
  std::vector<Fresh> fresh_;             // keyframes that the graph does not have yet
  std::vector<PathNode> path_;
  std::vector<std::pair<std::int32_t, std::int32_t>> loops_;
  std::uint64_t version_ = 0, redrawn_ = 0;
  std::set<TileIndex> touched_;            // by rays, since tiles were taken last
  std::map<TileIndex, PackedTile> seen_;   // as they were taken last
  std::map<TileIndex, PackedTile> known_;  // of a known map, since tiles were taken last
};

}  // namespace phasescan::serve
