/// What `/ws` sends and takes; docs/live.md has it for those who write a client. Binary, little endian.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "phasescan/live/live.hpp"
#include "serve/live_map.hpp"

namespace phasescan::serve {

enum class FrameKind : std::uint8_t { kScan = 1, kTiles = 2, kPath = 3, kLoops = 4, kHypotheses = 5 };

/// Pose, covariance, status and the hits of a scan, as seen from that pose. @param deskew  without what the robot moved
/// during the turn
std::string scan_frame(const live::LiveUpdate& update, bool deskew);
/// Appends a tile to a frame that `begin_tiles` began.
std::string begin_tiles(double resolution_m);
void add_tile(std::string& frame, TileIndex at, const PackedTile& tile);
/// Nodes from `first` on; what a client has beyond that is replaced.
std::string path_frame(std::span<const PathNode> nodes, std::size_t first);
std::string loops_frame(std::span<const std::pair<std::int32_t, std::int32_t>> loops);
/// Places in a known map where the robot may be, best first; none where there are not at least two.
std::string hypotheses_frame(const live::LiveUpdate& update);

/// What a page asks for: {"id": 1, "do": "set_pose", "x": .., "y": .., "theta": ..}.
struct ViewerCommand {
  std::int64_t id = 0;
  std::string what;  ///< set_pose, relocalise, record, stop, save, speed, seek
  Pose2 pose;
  std::string name;
  double value = 0.0;
};
/// Empty, with a reason in `why`, for what is no command.
std::optional<ViewerCommand> parse_command(std::string_view text, std::string& why);

}  // namespace phasescan::serve
