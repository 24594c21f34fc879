#include "serve/viewer.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>

#include "output/map_file.hpp"
#include "serve/frames.hpp"
#include "serve/live_map.hpp"

namespace phasescan::serve {
namespace {

// A client with more than this on its way gets no scan, and the map waits: what it sees would only grow older.
constexpr std::size_t kBusyBytes = 128 << 10;
constexpr std::size_t kTilesBytes = 32 << 10;  // of one message
constexpr int kProtocol = 1;

SharedBytes share(std::string bytes) {
  return std::make_shared<const std::string>(std::move(bytes));
}

bool same_path(std::span<const PathNode> a, std::span<const PathNode> b) {
  constexpr double kSeenM = 0.005;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
    const Pose2 &before = a[i].T_map_base, &now = b[i].T_map_base;
    if (before.is_finite() != now.is_finite()) return false;
    if (now.is_finite() && translation_distance(before, now) > kSeenM) return false;
  }
  return a.size() <= b.size();
}

/// Calls `cell(i, k, level)` for each known cell of a tile.
template <class Cell>
void unpack(const PackedTile& packed, const Cell& cell) {
  int at = 0;
  for (const char c : packed) {
    const auto byte = static_cast<unsigned char>(c);
    const int level = byte >> 4, run = (byte & 15) + 1;
    for (int n = 0; n < run; ++n, ++at)
      if (level > 0) cell(at % kTileCells, at / kTileCells, level);
  }
}

}  // namespace

Viewer::Viewer(const SlamOptions& options, LiveControl& control, std::function<std::string()> status)
    : options_(options),
      control_(control),
      status_(std::move(status)),
      map_(std::make_unique<LiveMap>(options)),
      loops_(share(loops_frame({}))) {}
Viewer::~Viewer() = default;

void Viewer::take(const live::LiveUpdate& update) {
  SharedBytes scan = share(scan_frame(update, options_.odometry.deskew));
  const bool map_changed = map_->add(update);
  std::map<TileIndex, PackedTile> tiles;
  if (map_changed) tiles = map_->take_changed_tiles();
  SharedBytes hypotheses = update.located ? share(hypotheses_frame(update)) : nullptr;
  const std::lock_guard lock(mutex_);
  if (map_changed) take_map(std::move(tiles));
  const bool others = hypotheses && (!hypotheses_ || *hypotheses != *hypotheses_);
  last_scan_ = scan;
  hypotheses_ = std::move(hypotheses);
  for (Client& client : clients_) {
    if (client.peer->queued_bytes() < kBusyBytes) {
      client.peer->send(scan, true);
      if (others) client.peer->send(hypotheses_, true);
    }
    if (map_changed) feed(client);
  }
}

void Viewer::take_map(std::map<TileIndex, PackedTile> tiles) {
  const LiveMap& map = *map_;
  for (auto& [at, packed] : tiles) {
    Tile& tile = tiles_[at];
    changes_.erase(tile.change);
    tile = {++change_, std::move(packed)};
    changes_[tile.change] = at;
  }
  // What stands is left as it was sent: steps too small to be seen must not add up.
  const std::vector<PathNode>& path = map.path();
  if (same_path(path_, path)) {
    path_.insert(path_.end(), path.begin() + static_cast<std::ptrdiff_t>(path_.size()), path.end());
  } else {
    ++path_generation_;
    path_ = path;
  }
  std::string loops = loops_frame(map.loops());
  if (loops != *loops_) {
    loops_ = share(std::move(loops));
    ++loops_version_;
  }
}

void Viewer::feed(Client& client) {
  if (client.peer->queued_bytes() >= kBusyBytes) return;
  if (client.path_generation != path_generation_) client.path_nodes = 0;
  if (client.path_generation != path_generation_ || client.path_nodes != path_.size()) {
    client.peer->send(share(path_frame(path_, client.path_nodes)), true);
    client.path_generation = path_generation_;
    client.path_nodes = path_.size();
  }
  if (client.loops != loops_version_) {
    client.peer->send(loops_, true);
    client.loops = loops_version_;
  }
  feed_tiles(client);
}

void Viewer::feed_tiles(Client& client) {
  while (client.tiles < change_ && client.peer->queued_bytes() < kBusyBytes) {
    std::string frame = begin_tiles(options_.map.resolution_m);
    const std::size_t empty = frame.size();
    for (auto next = changes_.upper_bound(client.tiles); next != changes_.end() && frame.size() < kTilesBytes; ++next) {
      add_tile(frame, next->second, tiles_[next->second].packed);
      client.tiles = next->first;
    }
    if (frame.size() == empty) break;
    client.peer->send(share(std::move(frame)), true);
  }
}

void Viewer::on_open(const std::shared_ptr<Peer>& peer, const std::string&) {
  const nlohmann::ordered_json hello{{"do", "hello"}, {"version", kProtocol}, {"tile_cells", kTileCells}};
  peer->send(share(hello.dump()), false);
  peer->send(share(status_()), false);
  const std::lock_guard lock(mutex_);
  if (last_scan_) peer->send(last_scan_, true);
  if (hypotheses_) peer->send(hypotheses_, true);
  clients_.push_back({peer});
}

void Viewer::on_drained(const std::shared_ptr<Peer>& peer) {
  const std::lock_guard lock(mutex_);
  for (Client& client : clients_)
    if (client.peer == peer) feed(client);
}

void Viewer::on_close(const std::shared_ptr<Peer>& peer) {
  const std::lock_guard lock(mutex_);
  std::erase_if(clients_, [&](const Client& client) { return client.peer == peer; });
}

void Viewer::on_tick() {
  const SharedBytes status = share(status_());
  const std::lock_guard lock(mutex_);
  for (const Client& client : clients_)
    if (client.peer->queued_bytes() < kBusyBytes) client.peer->send(status, false);
}

void Viewer::on_message(const std::shared_ptr<Peer>& peer, std::string_view message, bool binary) {
  std::string why = "expected text";
  std::optional<ViewerCommand> command;
  if (!binary) command = parse_command(message, why);
  // The peer may be gone when the answer comes; it takes it then all the same.
  const auto done = [peer, id = command ? command->id : 0](bool right, const std::string& text) {
    const nlohmann::ordered_json json{{"do", "done"}, {"id", id}, {"ok", right}, {"text", text}};
    peer->send(share(json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace)), false);
  };
  if (!command) return done(false, why);
  run(*command, done);
}

void Viewer::run(const ViewerCommand& command, const CommandDone& done) {
  std::string why;
  if (command.what == "set_pose") return control_.set_pose(command.pose, done);
  if (command.what == "relocalise") return control_.relocalise(done);
  if (command.what == "stop") return control_.stop_recording(done);
  if (command.what == "speed") return control_.replay_speed(command.value, done);
  if (command.what == "seek") return control_.replay_seek(command.value, done);
  if (command.what != "save" && command.what != "record") return done(false, "nothing is known by that name");
  if (!command.name.empty() && !check_save_name(command.name, why)) return done(false, why);
  if (command.what == "save") return control_.save(command.name, done);
  control_.start_recording(command.name, done);
}

std::string Viewer::png() {
  std::map<TileIndex, Tile> tiles;
  {
    const std::lock_guard lock(mutex_);
    if (png_change_ == change_ && !png_.empty()) return png_;
    tiles = tiles_;
    png_change_ = change_;
  }
  constexpr double kMostCells = 1e8;
  int min_i = 0, min_k = 0, max_i = -1, max_k = -1;
  for (const auto& [at, tile] : tiles) {
    if (tile.packed.empty()) continue;
    const bool first = max_i < min_i;
    min_i = first ? at.first : std::min(min_i, at.first);
    max_i = first ? at.first : std::max(max_i, at.first);
    min_k = first ? at.second : std::min(min_k, at.second);
    max_k = first ? at.second : std::max(max_k, at.second);
  }
  const double cells = (1.0 + max_i - min_i) * (1.0 + max_k - min_k) * kTileCells * kTileCells;
  if (cells > kMostCells) return {};
  TrinaryMap map;
  map.resolution_m = options_.map.resolution_m;
  map.width = std::max(1, (max_i - min_i + 1) * kTileCells);
  map.height = std::max(1, (max_k - min_k + 1) * kTileCells);
  map.cells.assign(static_cast<std::size_t>(map.width) * static_cast<std::size_t>(map.height), CellState::kUnknown);
  for (const auto& [at, tile] : tiles)
    unpack(tile.packed, [&, &at = at](int i, int k, int level) {
      const int column = (at.first - min_i) * kTileCells + i, row = (at.second - min_k) * kTileCells + k;
      map.cells[static_cast<std::size_t>(row) * static_cast<std::size_t>(map.width) +
                static_cast<std::size_t>(column)] = level <= 4    ? CellState::kFree
                                                    : level >= 10 ? CellState::kOccupied
                                                                  : CellState::kUnknown;
    });
  std::string png = format_png(map);
  const std::lock_guard lock(mutex_);
  png_ = png;
  return png;
}

}  // namespace phasescan::serve
