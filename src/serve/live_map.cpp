#include "serve/live_map.hpp"

#include <algorithm>
#include <climits>
#include <cmath>
#include <limits>
#include <utility>

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

/// @param level_at  level of cell (i, k)
template <class LevelAt>
PackedTile pack(TileIndex at, const LevelAt& level_at) {
  PackedTile packed;
  int level = -1, run = 0;
  bool known = false;
  const auto flush = [&] {
    if (run > 0) packed += static_cast<char>(level << 4 | (run - 1));
    run = 0;
  };
  for (int k = at.second * kTileCells; k < (at.second + 1) * kTileCells; ++k) {
    for (int i = at.first * kTileCells; i < (at.first + 1) * kTileCells; ++i) {
      const int now = level_at(i, k);
      known = known || now != 0;
      if (now != level || run == 16) flush();
      level = now;
      ++run;
    }
  }
  flush();
  return known ? packed : PackedTile{};
}

int level_of(CellState state) {
  constexpr int kFree = 1, kOccupied = 15;
  return state == CellState::kOccupied ? kOccupied : state == CellState::kFree ? kFree : 0;
}

}  // namespace

PackedTile pack_tile(const OccupancyGrid& grid, TileIndex at) {
  return pack(at, [&](int i, int k) {
    const double log_odds = grid.log_odds(i, k);
    return log_odds != 0.0 || grid.known(i, k) ? level_of(log_odds) : 0;
  });
}

std::map<TileIndex, PackedTile> pack_map(const TrinaryMap& map, double resolution_m) {
  const double width_m = map.width * map.resolution_m, height_m = map.height * map.resolution_m;
  const double tile_m = kTileCells * resolution_m;
  double x0 = 1e300, y0 = 1e300, x1 = -1e300, y1 = -1e300;
  for (const Eigen::Vector2d& corner : {Eigen::Vector2d(0.0, 0.0), Eigen::Vector2d(width_m, 0.0),
                                        Eigen::Vector2d(0.0, height_m), Eigen::Vector2d(width_m, height_m)}) {
    const Eigen::Vector2d at = map.origin * corner;
    x0 = std::min(x0, at.x());
    x1 = std::max(x1, at.x());
    y0 = std::min(y0, at.y());
    y1 = std::max(y1, at.y());
  }
  const Pose2 T_origin_map = map.origin.inverse();
  const auto level_at = [&](int i, int k) {
    const Eigen::Vector2d at =
        T_origin_map * Eigen::Vector2d((i + 0.5) * resolution_m, (k + 0.5) * resolution_m) / map.resolution_m;
    const int column = static_cast<int>(std::floor(at.x())), row = static_cast<int>(std::floor(at.y()));
    const bool inside = column >= 0 && row >= 0 && column < map.width && row < map.height;
    return inside ? level_of(map.at(column, row)) : 0;
  };
  std::map<TileIndex, PackedTile> tiles;
  for (int i = static_cast<int>(std::floor(x0 / tile_m)); i * tile_m < x1; ++i) {
    for (int k = static_cast<int>(std::floor(y0 / tile_m)); k * tile_m < y1; ++k) {
      PackedTile packed = pack({i, k}, level_at);
      if (!packed.empty()) tiles[{i, k}] = std::move(packed);
    }
  }
  return tiles;
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

/// What the graph was given is fresh no more. In bounded memory not all of it became nodes: what was drawn of the
/// others stays until all is drawn anew.
void LiveMap::drop_placed(const BackendSnapshot& snapshot) {
  std::set<std::int64_t> nodes;
  for (std::size_t node = 0; node < snapshot.nodes.size(); ++node) nodes.insert(snapshot.nodes[node].id);
  const std::int64_t newest = nodes.empty() ? -1 : *nodes.rbegin();
  std::erase_if(fresh_, [&](const Fresh& fresh) {
    const bool placed = fresh.node.scan <= newest || fresh.keyframe < static_cast<KeyframeId>(snapshot.submitted);
    if (placed && nodes.count(fresh.node.scan) == 0) drawn_.erase(fresh.node.scan);
    return placed;
  });
}

void LiveMap::take_snapshot(const BackendSnapshot& snapshot) {
  version_ = snapshot.version;
  drop_placed(snapshot);
  // The others stand where the graph now has the end of the way.
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

bool LiveMap::add_on_known_map(const live::LiveUpdate& live) {
  // A node of the way each so far; the oldest go, so that a run of days stays small.
  constexpr double kStepM = 0.2;
  constexpr std::size_t kMostNodes = 4000, kOldest = 1000;
  bool changed = live.restarted;
  if (live.map && live.map->version() != version_) {
    version_ = live.map->version();
    known_ = pack_map(live.map->draw(), options_.map.resolution_m);
    changed = true;
  }
  const Pose2 at = live.update.T_map_base();
  if (!live.has_pose() || (!path_.empty() && translation_distance(path_.back().T_map_base, at) < kStepM))
    return changed;
  if (path_.size() >= kMostNodes) path_.erase(path_.begin(), path_.begin() + kOldest);
  path_.push_back({at, live.update.scan});
  return true;
}

bool LiveMap::add(const live::LiveUpdate& live) {
  bool changed = live.restarted;
  if (live.restarted) restart();
  if (live.located) return add_on_known_map(live);
  if (live.map && live.map->version() != version_) {
    if (const auto snapshot = behind(*live.map)) take_snapshot(*snapshot);
    changed = true;
  }
  const ScanUpdate& update = live.update;
  if (!update.keyframe || !live.on_map || !is_tracked(update.status) || !live.measurement) return changed;
  Fresh fresh{live.measurement, {update.T_map_base(), update.scan}, *update.keyframe, update.T_odom_base, update.twist};
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
  std::map<TileIndex, PackedTile> changed = std::exchange(known_, {});
  for (const TileIndex& at : touched_) {
    PackedTile packed = pack_tile(grid_, at);
    PackedTile& before = seen_[at];
    if (packed != before) changed[at] = before = std::move(packed);
  }
  touched_.clear();
  return changed;
}

}  // namespace phasescan::serve
