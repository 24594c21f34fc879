#include "foxglove/client.hpp"

#include "io/file.hpp"

namespace phasescan::foxglove {
namespace {

constexpr std::size_t kMostSubscriptions = 256, kMostPublished = 64;
constexpr const char* kPoseTopic = "/initialpose";

bool is_pose_type(const std::string& type) {
  return type == "geometry_msgs/msg/PoseWithCovarianceStamped" || type == "geometry_msgs/PoseWithCovarianceStamped";
}

}  // namespace

Outcome Client::take_text(std::string_view frame, std::uint32_t channels) {
  Outcome out;
  try {
    const Request request = parse_text(frame);
    if (const auto* wanted = std::get_if<Subscribe>(&request)) apply(*wanted, channels, out);
    if (const auto* unwanted = std::get_if<Unsubscribe>(&request)) apply(*unwanted, out);
    if (const auto* offered = std::get_if<Advertise>(&request)) apply(*offered, out);
    if (const auto* gone = std::get_if<Unadvertise>(&request)) apply(*gone, out);
    if (const auto* other = std::get_if<Unsupported>(&request)) apply(*other, out);
  } catch (const ProtocolError& error) {
    out.statuses.emplace_back(StatusLevel::kError, error.what());
  }
  return out;
}

Outcome Client::take_binary(std::span<const std::uint8_t> frame) {
  Outcome out;
  try {
    const Request request = parse_binary(frame);
    if (const auto* message = std::get_if<Publish>(&request)) apply(*message, out);
    if (const auto* other = std::get_if<Unsupported>(&request)) apply(*other, out);
  } catch (const ProtocolError& error) {
    out.statuses.emplace_back(StatusLevel::kError, error.what());
  }
  return out;
}

void Client::apply(const Subscribe& request, std::uint32_t channels, Outcome& out) {
  for (const auto& [id, channel] : request.subscriptions) {
    if (channel == 0 || channel > channels) {
      out.statuses.emplace_back(StatusLevel::kWarning, "channel " + std::to_string(channel) +
                                                           " is not available; the subscription is ignored");
    } else if (subscriptions_.size() >= kMostSubscriptions) {
      out.statuses.emplace_back(StatusLevel::kError, "more than 256 subscriptions");
      return;
    } else if (!subscriptions_.emplace(id, channel).second) {
      out.statuses.emplace_back(StatusLevel::kError,
                                "subscription " + std::to_string(id) + " is there already; this one is ignored");
    } else {
      out.subscribed.emplace_back(id, channel);
    }
  }
}

void Client::apply(const Unsubscribe& request, Outcome& out) {
  for (const std::uint32_t id : request.subscriptions) {
    if (subscriptions_.erase(id) == 0)
      out.statuses.emplace_back(StatusLevel::kWarning, "subscription " + std::to_string(id) + " is not known");
  }
}

void Client::apply(const Advertise& request, Outcome& out) {
  for (const ClientChannel& channel : request.channels) {
    // Applications advertise goals and clicked points, too: what nobody reads here is taken and forgotten.
    const bool is_pose = channel.topic == kPoseTopic;
    if (is_pose && (!is_pose_type(channel.type) || (channel.encoding != "cdr" && channel.encoding != "json"))) {
      out.statuses.emplace_back(StatusLevel::kError, std::string(kPoseTopic) + ": " + quote_text(channel.type) +
                                                         " as " + quote_text(channel.encoding) +
                                                         "; expected geometry_msgs/msg/PoseWithCovarianceStamped as "
                                                         "cdr or json");
    } else if (published_.size() >= kMostPublished) {
      out.statuses.emplace_back(StatusLevel::kError, "more than 64 published topics");
      return;
    } else if (!published_.emplace(channel.id, channel).second) {
      out.statuses.emplace_back(StatusLevel::kError,
                                "channel " + std::to_string(channel.id) + " is advertised already");
    }
  }
}

void Client::apply(const Unadvertise& request, Outcome& out) {
  for (const std::uint32_t id : request.channels) {
    if (published_.erase(id) == 0)
      out.statuses.emplace_back(StatusLevel::kWarning, "channel " + std::to_string(id) + " was not advertised");
  }
}

void Client::apply(const Publish& request, Outcome& out) const {
  const auto channel = published_.find(request.channel);
  if (channel == published_.end())
    throw ProtocolError("a message on channel " + std::to_string(request.channel) + ", which was not advertised");
  if (channel->second.topic == kPoseTopic) out.pose = parse_pose(channel->second.encoding, request.payload);
}

void Client::apply(const Unsupported& request, Outcome& out) const {
  out.statuses.emplace_back(StatusLevel::kWarning, request.what + " is not supported by this server");
}

}  // namespace phasescan::foxglove
