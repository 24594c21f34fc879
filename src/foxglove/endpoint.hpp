/// A live run as Foxglove, Lichtblick and others that speak their protocol see it.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "foxglove/client.hpp"
#include "foxglove/protocol.hpp"
#include "live/map_drawer.hpp"
#include "live/ros_view.hpp"
#include "phasescan/live/live.hpp"
#include "serve/endpoint.hpp"
#include "serve/live_control.hpp"

namespace phasescan::foxglove {

/// A person's pose estimate, and who is told what became of it.
using PoseGiven = std::function<void(const Pose2& T_map_base, serve::CommandDone done)>;

/// Any thread may hand over updates; none waits for a client. A client whose line is slow is left out of scans and
/// frames until it has caught up; the map, the path and what else stays wait for it.
class Endpoint final : public serve::WebSocketEndpoint, public live::LiveSink {
 public:
  explicit Endpoint(PoseGiven pose_given);
  ~Endpoint() override;

  std::vector<std::string> subprotocols() const override;
  /// Foxglove's and Lichtblick's own pages and desktop applications.
  bool allows_origin(std::string_view origin) const override;
  std::size_t most_message_bytes() const override { return 65536; }
  void on_open(const std::shared_ptr<serve::Peer>& peer, const std::string& subprotocol) override;
  void on_message(const std::shared_ptr<serve::Peer>& peer, std::string_view message, bool binary) override;
  void on_drained(const std::shared_ptr<serve::Peer>& peer) override;
  void on_close(const std::shared_ptr<serve::Peer>& peer) override;

  void take(const live::LiveUpdate& update) override;

 private:
  struct Topic {
    Channel channel;
    bool stays = false;
    std::optional<live::RosMessage> last;
  };
  struct Guest {
    Client client;
    std::set<std::uint32_t> missed;  ///< channels whose last message it lacks, though that stays
  };
  Topic& topic_of(const live::RosMessage& message);
  void publish(live::RosMessage message);
  void send_to(serve::Peer& peer, Guest& guest, const Topic& topic, const live::RosMessage& message);
  bool anybody_wants(std::string_view topic) const;

  const PoseGiven pose_given_;
  const std::string session_;
  mutable std::mutex mutex_;
  std::vector<Topic> topics_;
  std::map<std::shared_ptr<serve::Peer>, Guest> guests_;
  live::RosView view_;
  std::int64_t path_due_ns_ = 0;
  std::optional<live::MapDrawer> drawer_;
};

}  // namespace phasescan::foxglove
