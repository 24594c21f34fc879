#include "slam/finished_map.hpp"

#include <algorithm>
#include <utility>

#include "core/motion.hpp"

namespace phasescan {
namespace {

/// Keyframes that the map is drawn from: all, or those of the largest piece (slam.largest_piece).
std::vector<char> drawn_keyframes(const MapPieces& pieces, bool largest_alone) {
  std::vector<char> drawn(pieces.of_node.size(), 1);
  for (std::size_t i = 0; i < drawn.size() && largest_alone; ++i) drawn[i] = static_cast<char>(pieces.in_largest(i));
  return drawn;
}

}  // namespace

std::vector<char> scans_on_map(const Backend& backend, const ScanLedger& ledger, const std::vector<char>& drawn) {
  std::vector<char> on(ledger.records.size(), 1);
  for (std::size_t i = 0; i < on.size(); ++i) {
    const std::int32_t keyframe = ledger.records[i].keyframe;
    if (keyframe < 0 || static_cast<std::size_t>(keyframe) >= backend.submitted()) continue;
    on[i] = drawn[static_cast<std::size_t>(backend.node_of(static_cast<std::size_t>(keyframe)))];
  }
  return on;
}

namespace {

/// Panes, but for what lies where the robot drove on this map.
std::vector<GlassPane> panes_off_the_way(std::vector<GlassPane> panes, const std::vector<Pose2>& poses,
                                         const std::vector<char>& on_map, const GlassOptions& options) {
  for (auto begin = on_map.begin(); begin != on_map.end();) {
    const auto end = std::find(begin, on_map.end(), 0);
    const std::span<const Pose2> way(poses.begin() + (begin - on_map.begin()), poses.begin() + (end - on_map.begin()));
    panes = cut_where_driven(std::move(panes), way, options.keep_open_m, options.min_length_m);
    begin = std::find(end, on_map.end(), 1);
  }
  return panes;
}

}  // namespace

void draw_result(const Backend& backend, const std::vector<Pose2>& poses, bool refined, const Pose2& T_drawn_map,
                 const std::vector<char>& on_map, const SlamOptions& options, SlamResult& result) {
  std::vector<std::size_t> drawn;
  for (std::size_t i = 0; i < result.drawn.size(); ++i) {
    if (result.drawn[i]) drawn.push_back(i);
  }
  const auto placed = [&](std::size_t k) {
    const Keyframe& keyframe = backend.keyframes()[drawn[k]];
    const Pose2 T_map_stamp = refined ? poses[static_cast<std::size_t>(keyframe.scan)]
                                      : T_drawn_map * backend.poses()[drawn[k]] * keyframe.T_mid_stamp;
    return place_keyframe(keyframe, T_map_stamp, options.odometry.deskew);
  };
  // Drives follow each other: with map.update each has a grid of its own, which then takes the place of what was known.
  OccupancyGrid grid(options.map), drive(options.map);
  for (std::size_t k = 0; k < drawn.size(); ++k) {
    const std::int32_t session = backend.keyframes()[drawn[k]].session;
    if (k > 0 && options.map.update && session != backend.keyframes()[drawn[k - 1]].session) {
      grid.update_with(drive);
      drive.clear();
    }
    const PlacedScan scan = placed(k);
    (options.map.update ? drive : grid).add_scan(scan.scan, scan.T_map_laser, scan.twist);
  }
  if (options.map.update) grid.update_with(drive);
  result.map = make_trinary(grid);
  if (!options.glass.enabled) return;
  result.glass = panes_off_the_way(find_glass(drawn.size(), placed, grid, options.glass), poses, on_map, options.glass);
  for (const GlassPane& pane : result.glass) {
    if (!pane.sure || !options.glass.block) continue;
    for (const std::size_t cell : cells_of(result.map, pane)) result.map.cells[cell] = CellState::kOccupied;
  }
}

PlacedScan place_keyframe(const Keyframe& keyframe, const Pose2& T_map_stamp, bool deskew) {
  PlacedScan placed;
  placed.scan = keyframe.scan_data();
  placed.T_map_laser = T_map_stamp * keyframe.T_base_laser;
  placed.twist = deskew ? twist_of_frame(keyframe.T_base_laser, keyframe.twist) : Twist2{};
  return placed;
}

MapEdge map_edge(const PoseEdge& edge) {
  return {edge.from, edge.to, edge.T_from_to, edge.information, edge.robust, edge.enabled};
}

std::vector<MapKeyframe> map_keyframes(const Backend& backend) {
  const MapPieces pieces = backend.pieces();
  std::vector<MapKeyframe> keyframes;
  keyframes.reserve(backend.keyframes().size());
  for (std::size_t i = 0; i < backend.keyframes().size(); ++i)
    keyframes.push_back({backend.poses()[i], backend.keyframes()[i].scan, pieces.of_node[i]});
  return keyframes;
}

SlamResult make_result(const Backend& backend, const ScanLedger& ledger, const std::vector<Pose2>& poses, bool refined,
                       const SlamOptions& options) {
  SlamResult result;
  const MapPieces pieces = backend.pieces();
  result.pieces = pieces.count;
  result.drawn = drawn_keyframes(pieces, options.slam.largest_piece);
  result.keyframes = map_keyframes(backend);
  for (const PoseEdge& edge : backend.graph().edges()) result.edges.push_back(map_edge(edge));
  result.loops = backend.loop_counts();
  const std::vector<char> on_map = scans_on_map(backend, ledger, result.drawn);
  draw_result(backend, poses, refined, {}, on_map, options, result);
  const std::vector<Pose2> keyframe_odometry = backend.submitted_poses(true);
  const std::vector<Pose2> odometry = poses_of_scans(ledger, keyframe_odometry, keyframe_odometry);
  result.scans.reserve(poses.size());
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const ScanRecord& record = ledger.records[i];
    ScanResult scan;
    scan.stamp = record.stamp;
    scan.status = record.status;
    scan.repeated = record.repeated;
    scan.left_out = record.left_out;
    scan.on_map = on_map[i] != 0;
    scan.keyframe = record.keyframe;
    scan.T_map_base = poses[i];
    scan.T_odom_base = odometry[i];
    if (i < ledger.covariances.size()) scan.covariance = ledger.covariances[i].matrix();
    result.scans.push_back(std::move(scan));
  }
  return result;
}

}  // namespace phasescan
