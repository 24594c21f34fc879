#include "serve/live_map.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <string_view>

#include "core/motion.hpp"
#include "slam/map_view.hpp"

namespace phasescan::serve {
namespace {

// A keyframe that moved by less than half a cell, at walls 5 m off, is left as it was drawn: nobody sees it.
constexpr double kLeverM = 5.0;
constexpr double kCellShare = 0.5;

double moved(const Pose2& a, const Pose2& b) {
  return translation_distance(a, b) + kLeverM * angle_distance(a.theta, b.theta);
}

/// Level of each step of log-odds, from -127 on.
std::array<unsigned char, 256> make_levels() {
  std::array<unsigned char, 256> levels{};
  constexpr double kFree = 0.196, kOccupied = 0.65;  // as make_trinary has them
  for (int step = -127; step <= 127; ++step) {
    const double p = 1.0 / (1.0 + std::exp(-step / OccupancyGrid::kStepsPerUnit));
    int level = 0;
    if (p <= kFree)
      level = 1 + std::min(3, static_cast<int>(4.0 * p / kFree));
    else if (p < kOccupied)
      level = 5 + std::min(4, static_cast<int>(5.0 * (p - kFree) / (kOccupied - kFree)));
    else
      level = 10 + std::min(5, static_cast<int>(6.0 * (p - kOccupied) / (1.0 - kOccupied)));
    levels[static_cast<std::size_t>(step + 128)] = static_cast<unsigned char>(level);
  }
  return levels;  // of kUnknown: 0
}

}  // namespace

PackedTile pack_tile(const OccupancyGrid::Tile& tile) {
  static const std::array<unsigned char, 256> kLevels = make_levels();
  PackedTile packed;
  int level = -1, run = 0;
  bool known = false;
  const auto flush = [&] {
    if (run > 0) packed += static_cast<char>(level << 4 | (run - 1));
    run = 0;
  };
  for (const std::int8_t cell : tile) {
    const int now = kLevels[static_cast<std::size_t>(cell + 128)];
    known = known || now != 0;
    if (now != level || run == 16) flush();
    level = now;
    ++run;
  }
  flush();
  return known ? packed : PackedTile{};
}

LiveMap::LiveMap(const SlamOptions& options) : options_(options), grid_(options.map) {}

void LiveMap::draw_node(const BackendSnapshot& snapshot, std::size_t node) {
  const SnapshotNode& at = snapshot.nodes[node];
  grid_.add_scan(at.scan(), snapshot.poses[node] * at.T_mid_stamp * at.T_base_laser,
                 options_.odometry.deskew ? twist_of_frame(at.T_base_laser, at.twist) : Twist2{});
  drawn_[at.id] = snapshot.poses[node] * at.T_mid_stamp;
}

void LiveMap::draw_fresh(const Fresh& fresh) {
  const Pose2& T_base_laser = fresh.measurement->T_base_laser;
  grid_.add_scan(fresh.measurement->scan, fresh.node.T_map_base * T_base_laser,
                 options_.odometry.deskew ? twist_of_frame(T_base_laser, fresh.twist) : Twist2{});
  drawn_[fresh.node.scan] = fresh.node.T_map_base;
}

/// Whether nothing that was drawn moved or went.
bool LiveMap::stands(const BackendSnapshot& snapshot) const {
  const double tolerance = kCellShare * options_.map.resolution_m;
  std::size_t found = 0;
  for (std::size_t node = 0; node < snapshot.poses.size(); ++node) {
    const SnapshotNode& at = snapshot.nodes[node];
    const auto drawn = drawn_.find(at.id);
    const bool shown = !options_.slam.largest_piece || snapshot.pieces.in_largest(node);
    if (drawn == drawn_.end()) continue;
    if (!shown || moved(drawn->second, snapshot.poses[node] * at.T_mid_stamp) > tolerance) return false;
    ++found;
  }
  return found + fresh_.size() >= drawn_.size();
}

void LiveMap::take_snapshot(const BackendSnapshot& snapshot) {
  version_ = snapshot.version;
  // What the graph has is fresh no more; the others stand where the graph now has the end of the way.
  const std::int64_t newest = snapshot.nodes.size() > 0 ? snapshot.nodes[snapshot.nodes.size() - 1].id : -1;
  std::erase_if(fresh_, [&](const Fresh& fresh) { return fresh.node.scan <= newest; });
  bool anew = !stands(snapshot);
  for (Fresh& fresh : fresh_) {
    const Pose2 now = snapshot.T_map_odom * fresh.T_odom_base;
    anew = anew || moved(now, fresh.node.T_map_base) > kCellShare * options_.map.resolution_m;
    fresh.node.T_map_base = now;
  }
  if (anew) {
    grid_.clear();
    drawn_.clear();
    ++redrawn_;
  }
  path_.clear();
  for (std::size_t node = 0; node < snapshot.poses.size(); ++node) {
    const SnapshotNode& at = snapshot.nodes[node];
    path_.push_back({snapshot.poses[node], at.id});
    const bool shown = !options_.slam.largest_piece || snapshot.pieces.in_largest(node);
    if (shown && drawn_.count(at.id) == 0) draw_node(snapshot, node);
  }
  for (const Fresh& fresh : fresh_) {
    path_.push_back(fresh.node);
    if (anew) draw_fresh(fresh);
  }
  loops_.clear();
  for (const SnapshotLoop& loop : snapshot.loops)
    if (loop.enabled) loops_.emplace_back(loop.from, loop.to);
}

void LiveMap::restart() {
  grid_.clear();
  drawn_.clear();
  fresh_.clear();
  path_.clear();
  loops_.clear();
  version_ = 0;
}

bool LiveMap::add(const live::LiveUpdate& live) {
  bool changed = live.restarted;
  if (live.restarted) restart();
  if (live.map && live.map->version() != version_) {
    if (const auto snapshot = behind(*live.map)) take_snapshot(*snapshot);
    changed = true;
  }
  const ScanUpdate& update = live.update;
  if (!update.keyframe || !is_tracked(update.status) || !live.measurement) return changed;
  Fresh fresh{live.measurement, {update.T_map_base(), update.scan}, update.T_odom_base, update.twist};
  draw_fresh(fresh);
  path_.push_back(fresh.node);
  fresh_.push_back(std::move(fresh));
  return true;
}

std::map<TileIndex, PackedTile> LiveMap::take_changed_tiles() {
  std::map<TileIndex, PackedTile> changed;
  std::map<TileIndex, std::size_t> now;
  grid_.for_each_tile([&](int ti, int tk, const OccupancyGrid::Tile& tile) {
    const std::string_view bytes(reinterpret_cast<const char*>(tile.data()), tile.size());
    const std::size_t hash = std::hash<std::string_view>{}(bytes);
    const TileIndex at{ti, tk};
    now[at] = hash;
    const auto before = seen_.find(at);
    if (before == seen_.end() || before->second != hash) changed[at] = pack_tile(tile);
  });
  for (const auto& [at, hash] : seen_)
    if (now.count(at) == 0) changed[at] = {};
  seen_ = std::move(now);
  return changed;
}

}  // namespace phasescan::serve
