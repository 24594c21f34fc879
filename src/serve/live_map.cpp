#include "serve/live_map.hpp"

#include <algorithm>
#include <climits>
#include <cmath>
#include <limits>

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

Pose2 nowhere() {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  return {kNaN, kNaN, kNaN};
}

/// Level of a cell that is known.
int level_of(double log_odds) {
  constexpr double kFree = 0.196, kOccupied = 0.65;  // as make_trinary has them
  const double p = 1.0 / (1.0 + std::exp(-log_odds));
  if (p <= kFree) return 1 + std::min(3, static_cast<int>(4.0 * p / kFree));
  if (p < kOccupied) return 5 + std::min(4, static_cast<int>(5.0 * (p - kFree) / (kOccupied - kFree)));
  return 10 + std::min(5, static_cast<int>(6.0 * (p - kOccupied) / (1.0 - kOccupied)));
}

}  // namespace

PackedTile pack_tile(const OccupancyGrid& grid, TileIndex at) {
  PackedTile packed;
  int level = -1, run = 0;
  bool known = false;
  const auto flush = [&] {
    if (run > 0) packed += static_cast<char>(level << 4 | (run - 1));
    run = 0;
  };
  for (int k = at.second * kTileCells; k < (at.second + 1) * kTileCells; ++k) {
    for (int i = at.first * kTileCells; i < (at.first + 1) * kTileCells; ++i) {
      const double log_odds = grid.log_odds(i, k);
      const int now = log_odds != 0.0 || grid.known(i, k) ? level_of(log_odds) : 0;
      known = known || now != 0;
      if (now != level || run == 16) flush();
      level = now;
      ++run;
    }
  }
  flush();
  return known ? packed : PackedTile{};
}

LiveMap::LiveMap(const SlamOptions& options) : options_(options), grid_(options.map) {}

void LiveMap::draw_node(const BackendSnapshot& snapshot, std::size_t node) {
  const SnapshotNode& at = snapshot.nodes[node];
  const Scan scan = at.scan();
  const Pose2 T_map_laser = snapshot.poses[node] * at.T_mid_stamp * at.T_base_laser;
  touch(scan, T_map_laser);
  grid_.add_scan(scan, T_map_laser, options_.odometry.deskew ? twist_of_frame(at.T_base_laser, at.twist) : Twist2{});
  drawn_[at.id] = snapshot.poses[node] * at.T_mid_stamp;
}

void LiveMap::draw_fresh(const Fresh& fresh) {
  const Pose2& T_base_laser = fresh.measurement->T_base_laser;
  touch(fresh.measurement->scan, fresh.node.T_map_base * T_base_laser);
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
    clear_grid();
    ++redrawn_;
  }
  path_.clear();
  for (std::size_t node = 0; node < snapshot.poses.size(); ++node) {
    const SnapshotNode& at = snapshot.nodes[node];
    const bool shown = !options_.slam.largest_piece || snapshot.pieces.in_largest(node);
    path_.push_back({shown ? snapshot.poses[node] : nowhere(), at.id});
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

void LiveMap::clear_grid() {
  grid_.clear();
  drawn_.clear();
  for (const auto& [at, packed] : seen_)
    if (!packed.empty()) touched_.insert(at);
}

void LiveMap::restart() {
  clear_grid();
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
  if (!update.keyframe || !live.on_map || !is_tracked(update.status) || !live.measurement) return changed;
  Fresh fresh{live.measurement, {update.T_map_base(), update.scan}, update.T_odom_base, update.twist};
  draw_fresh(fresh);
  path_.push_back(fresh.node);
  fresh_.push_back(std::move(fresh));
  return true;
}

/// Marks the tiles that the rays of a scan may change.
void LiveMap::touch(const Scan& scan, const Pose2& T_map_laser) {
  const double cell = options_.map.resolution_m, tile = kTileCells * cell;
  const double margin = 3.0 * cell;  // by which the motion during a turn may shift a ray
  TileIndex last{INT_MIN, INT_MIN};
  const auto mark = [&](double x, double y) {
    const TileIndex at{static_cast<int>(std::floor(x / tile)), static_cast<int>(std::floor(y / tile))};
    if (at != last) touched_.insert(at);
    last = at;
  };
  for (std::size_t i = 0; i < scan.size(); ++i) {
    if (!scan.is_hit(i)) continue;  // a missing beam is drawn no farther than its neighbours
    const double reach = std::min(static_cast<double>(scan.ranges[i]), options_.map.max_ray_m);
    const double angle = T_map_laser.theta + scan.angle(i), c = std::cos(angle), s = std::sin(angle);
    for (const double side : {-margin, margin})
      for (double r = 0.0; r <= reach + margin + cell; r += cell)
        mark(T_map_laser.x + r * c - side * s, T_map_laser.y + r * s + side * c);
  }
}

std::map<TileIndex, PackedTile> LiveMap::take_changed_tiles() {
  std::map<TileIndex, PackedTile> changed;
  for (const TileIndex& at : touched_) {
    PackedTile packed = pack_tile(grid_, at);
    PackedTile& before = seen_[at];
    if (packed != before) changed[at] = before = std::move(packed);
  }
  touched_.clear();
  return changed;
}

}  // namespace phasescan::serve
