/// The endpoint behind the page: `/ws`. A sink of the run on one side, clients on the other.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "serve/endpoint.hpp"
#include "phasescan/live/live.hpp"
#include "serve/live_control.hpp"

namespace phasescan::serve {

class LiveMap;
struct PathNode;
struct ViewerCommand;

class Viewer final : public live::LiveSink, public WebSocketEndpoint {
 public:
  /// @param status  a JSON object for `/api/status`, which clients get once a second. What is given must outlive the
  /// server
  Viewer(const SlamOptions& options, LiveControl& control, std::function<std::string()> status);
  ~Viewer() override;

  // Sink, by its own thread.
  void take(const live::LiveUpdate& update) override;

  // Endpoint, by the server's thread.
  void on_open(const std::shared_ptr<Peer>& peer, const std::string& subprotocol) override;
  void on_message(const std::shared_ptr<Peer>& peer, std::string_view message, bool binary) override;
  void on_drained(const std::shared_ptr<Peer>& peer) override;
  void on_close(const std::shared_ptr<Peer>& peer) override;
  void on_tick() override;

  /// The map as a PNG picture, as it is known now; empty for one of more than 10^8 cells. Any thread.
  std::string png();

 private:
  /// What a client was sent so far.
  struct Client {
    std::shared_ptr<Peer> peer;
    std::uint64_t tiles = 0;  // changes up to this one
    std::uint64_t path_generation = 0;
    std::size_t path_nodes = 0;
    std::uint64_t loops = 0;
  };
  struct Tile {
    std::uint64_t change = 0;
    std::string packed;
  };
  using TileIndex = std::pair<int, int>;
  void take_map(std::map<TileIndex, std::string> tiles);
  void feed(Client& client);
  void feed_tiles(Client& client);
  void run(const ViewerCommand& command, const CommandDone& done);

  const SlamOptions options_;
  LiveControl& control_;
  std::function<std::string()> status_;
  std::unique_ptr<LiveMap> map_;  // of the sink's thread alone

  std::mutex mutex_;  // guards what follows
  std::vector<Client> clients_;
  std::map<TileIndex, Tile> tiles_;
  std::map<std::uint64_t, TileIndex> changes_;  // when each tile changed last
  std::uint64_t change_ = 0;
  std::vector<PathNode> path_;
  std::uint64_t path_generation_ = 1;
  SharedBytes loops_;
  std::uint64_t loops_version_ = 1;
  SharedBytes last_scan_, hypotheses_;
  std::string png_;
  std::uint64_t png_change_ = 0;
};

}  // namespace phasescan::serve
