/// What a server knows of one client: its subscriptions, and the topics that it publishes.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "foxglove/protocol.hpp"
#include "io/ros_messages.hpp"

namespace phasescan::foxglove {

/// What a frame of a client brought.
struct Outcome {
  std::vector<std::pair<StatusLevel, std::string>> statuses;  ///< to be sent to it
  /// New ones, id and channel: what stays on the channel is to be sent at once.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> subscribed;
  std::optional<ros::PoseEstimate> pose;  ///< where the robot stands, as the client says; in the frame map
};

class Client {
 public:
  /// @param channels  ids up to this one exist, from 1
  Outcome take_text(std::string_view frame, std::uint32_t channels);
  Outcome take_binary(std::span<const std::uint8_t> frame);

  /// Ids of the subscriptions to a channel.
  template <class Visitor>
  void each_subscription(std::uint32_t channel, Visitor&& visit) const {
    for (const auto& [id, to] : subscriptions_) {
      if (to == channel) visit(id);
    }
  }
  std::size_t subscriptions() const { return subscriptions_.size(); }

 private:
  void apply(const Subscribe& request, std::uint32_t channels, Outcome& out);
  void apply(const Unsubscribe& request, Outcome& out);
  void apply(const Advertise& request, Outcome& out);
  void apply(const Unadvertise& request, Outcome& out);
  void apply(const Publish& request, Outcome& out) const;
  void apply(const Unsupported& request, Outcome& out) const;

  std::map<std::uint32_t, std::uint32_t> subscriptions_;  // to channels
  std::map<std::uint32_t, ClientChannel> published_;
};

/// geometry_msgs/PoseWithCovarianceStamped as "cdr" or "json". @throws ProtocolError
ros::PoseEstimate parse_pose(std::string_view encoding, std::span<const std::uint8_t> payload);

}  // namespace phasescan::foxglove
