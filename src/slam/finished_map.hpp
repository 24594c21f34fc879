/// From poses and kept scans to what a run leaves: the drawn map, its glass, the graph, a pose per scan.
#pragma once

#include <span>
#include <vector>

#include "map/glass.hpp"
#include "map/occupancy_grid.hpp"
#include "phasescan/slam/options.hpp"
#include "phasescan/slam/slam.hpp"
#include "slam/backend.hpp"
#include "slam/keyframe.hpp"
#include "slam/scan_ledger.hpp"

namespace phasescan {

/// A keyframe's scan where it stands on the map, as it is drawn.
/// @param T_map_stamp  of the base at the scan's first beam
PlacedScan place_keyframe(const Keyframe& keyframe, const Pose2& T_map_stamp, bool deskew);

/// A node or an edge of the graph as outputs and observers see it.
MapEdge map_edge(const PoseEdge& edge);
std::vector<MapKeyframe> map_keyframes(const Backend& backend);

/// The finished run. @param poses  T_map_base of each scan at its stamp
/// @param refined  whether these are better than the keyframes' own poses, and keyframes are drawn by them
/// @cost draws every keyframe once; glass looks at each of them twice more
SlamResult make_result(const Backend& backend, const ScanLedger& ledger, const std::vector<Pose2>& poses, bool refined,
                       const SlamOptions& options);

/// Of each scan: 0 where it stands at a keyframe that is not drawn.
std::vector<char> scans_on_map(const Backend& backend, const ScanLedger& ledger, const std::vector<char>& drawn);

/// Draws the map of the keyframes that `result.drawn` names, and looks for glass in it.
/// @param poses        of all scans, in the frame that is drawn
/// @param T_drawn_map  takes the back end's poses into that frame
void draw_result(const Backend& backend, const std::vector<Pose2>& poses, bool refined, const Pose2& T_drawn_map,
                 const std::vector<char>& on_map, const SlamOptions& options, SlamResult& result);

}  // namespace phasescan
