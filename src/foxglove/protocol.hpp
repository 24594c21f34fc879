/// Frames of the Foxglove WebSocket protocol, subprotocols foxglove.sdk.v1 and foxglove.websocket.v1: what a server
/// sends, and what a client may say. Bytes in, values out: no socket and no clock.
#pragma once

#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace phasescan::foxglove {

/// The best first: today's applications and bridges speak the first alone, older ones the second.
inline constexpr std::string_view kSubprotocols[] = {"foxglove.sdk.v1", "foxglove.websocket.v1"};

/// A topic that clients can subscribe to; messages are CDR, their definition ros2msg.
struct Channel {
  std::uint32_t id = 0;
  std::string topic, type;
};

enum class StatusLevel : std::uint8_t { kInfo, kWarning, kError };

/// @name Frames of text.
/// @{
/// Capabilities: clientPublish (cdr, json) and time.
std::string server_info(std::string_view name, std::string_view session);
/// @throws std::invalid_argument for a message type without a definition
std::string advertise(std::span<const Channel> channels);
std::string status(StatusLevel level, std::string_view message);
/// @}

/// @name Binary frames, little endian.
/// @{
std::string message_data(std::uint32_t subscription, std::uint64_t time_ns, std::span<const std::uint8_t> payload);
std::string time_data(std::uint64_t time_ns);
/// @}

/// @name What a client says.
/// @{
struct Subscribe {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> subscriptions;  ///< id that the client chose, channel
};
struct Unsubscribe {
  std::vector<std::uint32_t> subscriptions;
};
/// A topic that the client publishes.
struct ClientChannel {
  std::uint32_t id = 0;
  std::string topic, encoding, type;
};
struct Advertise {
  std::vector<ClientChannel> channels;
};
struct Unadvertise {
  std::vector<std::uint32_t> channels;
};
struct Publish {
  std::uint32_t channel = 0;
  std::span<const std::uint8_t> payload;  ///< a part of the frame
};
/// Known to the protocol, and not to this server.
struct Unsupported {
  std::string what;
};
using Request = std::variant<Subscribe, Unsubscribe, Advertise, Unadvertise, Publish, Unsupported>;
/// @}

/// A frame that is none of the protocol: what is wrong and what was expected.
class ProtocolError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// @throws ProtocolError
Request parse_text(std::string_view frame);
/// @throws ProtocolError
Request parse_binary(std::span<const std::uint8_t> frame);

}  // namespace phasescan::foxglove
