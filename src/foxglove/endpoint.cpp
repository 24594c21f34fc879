#include "foxglove/endpoint.hpp"

#include <algorithm>
#include <utility>

#include "live/clocks.hpp"

namespace phasescan::foxglove {
namespace {

// A quarter of a second of a fast sensor at a slow line: a client that lags farther is better served by the next scan.
constexpr std::size_t kBusyBytes = 256 * 1024;
constexpr std::int64_t kPath_ns = 1'000'000'000;
constexpr double kMap_s = 1.0;
// A client's queue holds 4 MiB: larger maps (100 m x 50 m at 5 cm) come coarser.
constexpr std::size_t kMostCells = 2'000'000;

/// Half as many cells along each side: occupied where one of the four is, else free where one is.
TrinaryMap halved(const TrinaryMap& map) {
  TrinaryMap out;
  out.width = (map.width + 1) / 2;
  out.height = (map.height + 1) / 2;
  out.resolution_m = 2.0 * map.resolution_m;
  out.origin = map.origin;
  out.cells.assign(static_cast<std::size_t>(out.width) * static_cast<std::size_t>(out.height), CellState::kUnknown);
  for (int k = 0; k < map.height; ++k) {
    for (int i = 0; i < map.width; ++i) {
      CellState& cell = out.cells[static_cast<std::size_t>(k / 2) * static_cast<std::size_t>(out.width) +
                                  static_cast<std::size_t>(i / 2)];
      cell = std::max(cell, map.at(i, k));
    }
  }
  return out;
}

live::RosMessage map_for_clients(Stamp stamp, const TrinaryMap& map) {
  if (map.cells.size() <= kMostCells) return live::map_message(stamp, map);
  return map_for_clients(stamp, halved(map));
}

serve::SharedBytes shared(std::string bytes) {
  return std::make_shared<const std::string>(std::move(bytes));
}

std::uint64_t time_of(Stamp stamp) {
  return static_cast<std::uint64_t>(std::max<Stamp>(stamp, 0));
}

}  // namespace

Endpoint::Endpoint(PoseGiven pose_given)
    : pose_given_(std::move(pose_given)), session_(std::to_string(live::system_ns())) {
  for (const live::RosTopic& topic : live::ros_topics()) {
    const auto id = static_cast<std::uint32_t>(topics_.size() + 1);
    topics_.push_back({{id, std::string(topic.topic), std::string(topic.type)}, topic.stays, {}});
  }
  drawer_.emplace(kMap_s, [this](Stamp stamp, const live::DrawnMap& map) {
    live::RosMessage message = map_for_clients(stamp, *map);
    const std::lock_guard lock(mutex_);
    publish(std::move(message));
  });
}

Endpoint::~Endpoint() = default;

std::vector<std::string> Endpoint::subprotocols() const {
  return {std::begin(kSubprotocols), std::end(kSubprotocols)};
}

bool Endpoint::allows_origin(std::string_view origin) const {
  for (const std::string_view known :
       {"https://app.foxglove.dev", "https://studio.foxglove.dev", "https://lichtblick-suite.github.io",
        "app://foxglove", "app://lichtblick", "file://"}) {
    if (origin == known) return true;
  }
  return false;
}

void Endpoint::on_open(const std::shared_ptr<serve::Peer>& peer, const std::string&) {
  const std::lock_guard lock(mutex_);
  guests_[peer];
  peer->send(shared(server_info("phasescan", session_)), false);
  std::vector<Channel> channels;
  for (const Topic& topic : topics_) channels.push_back(topic.channel);
  peer->send(shared(advertise(channels)), false);
}

void Endpoint::on_close(const std::shared_ptr<serve::Peer>& peer) {
  const std::lock_guard lock(mutex_);
  guests_.erase(peer);
}

void Endpoint::on_message(const std::shared_ptr<serve::Peer>& peer, std::string_view message, bool binary) {
  Outcome outcome;
  {
    const std::lock_guard lock(mutex_);
    const auto guest = guests_.find(peer);
    if (guest == guests_.end()) return;
    const auto channels = static_cast<std::uint32_t>(topics_.size());
    outcome =
        binary
            ? guest->second.client.take_binary({reinterpret_cast<const std::uint8_t*>(message.data()), message.size()})
            : guest->second.client.take_text(message, channels);
    for (const auto& [id, channel] : outcome.subscribed) {
      const Topic& topic = topics_[channel - 1];
      if (!topic.stays || !topic.last) continue;
      peer->send(shared(message_data(id, time_of(topic.last->stamp), topic.last->bytes)), true);
    }
  }
  for (const auto& [level, text] : outcome.statuses) peer->send(shared(status(level, text)), false);
  if (!outcome.pose) return;
  pose_given_(outcome.pose->pose, [weak = std::weak_ptr(peer)](bool done, const std::string& text) {
    const std::shared_ptr<serve::Peer> asker = weak.lock();
    if (asker) asker->send(shared(status(done ? StatusLevel::kInfo : StatusLevel::kWarning, text)), false);
  });
}

void Endpoint::on_drained(const std::shared_ptr<serve::Peer>& peer) {
  const std::lock_guard lock(mutex_);
  const auto guest = guests_.find(peer);
  if (guest == guests_.end()) return;
  for (const std::uint32_t channel : std::exchange(guest->second.missed, {})) {
    const Topic& topic = topics_[channel - 1];
    if (topic.last) send_to(*peer, guest->second, topic, *topic.last);
  }
}

Endpoint::Topic& Endpoint::topic_of(const live::RosMessage& message) {
  const auto found = std::find_if(topics_.begin(), topics_.end(),
                                  [&](const Topic& topic) { return topic.channel.topic == message.topic; });
  if (found != topics_.end()) return *found;
  // Another laser of a log that is replayed.
  const auto id = static_cast<std::uint32_t>(topics_.size() + 1);
  Topic& added = topics_.emplace_back(Topic{{id, message.topic, message.type}, false, {}});
  const serve::SharedBytes told = shared(advertise(std::span(&added.channel, 1)));
  for (auto& [peer, guest] : guests_) peer->send(told, false);
  return added;
}

void Endpoint::send_to(serve::Peer& peer, Guest& guest, const Topic& topic, const live::RosMessage& message) {
  guest.client.each_subscription(topic.channel.id, [&](std::uint32_t id) {
    if (peer.queued_bytes() > kBusyBytes) {
      if (topic.stays) guest.missed.insert(topic.channel.id);
      return;
    }
    guest.missed.erase(topic.channel.id);
    peer.send(shared(message_data(id, time_of(message.stamp), message.bytes)), true);
  });
}

void Endpoint::publish(live::RosMessage message) {
  Topic& topic = topic_of(message);
  for (auto& [peer, guest] : guests_) send_to(*peer, guest, topic, message);
  if (topic.stays) topic.last = std::move(message);
}

bool Endpoint::anybody_wants(std::string_view name) const {
  for (const Topic& topic : topics_) {
    if (topic.channel.topic != name) continue;
    for (const auto& [peer, guest] : guests_) {
      bool wanted = false;
      guest.client.each_subscription(topic.channel.id, [&](std::uint32_t) { wanted = true; });
      if (wanted) return true;
    }
  }
  return false;
}

void Endpoint::take(const live::LiveUpdate& update) {
  std::vector<live::RosMessage> messages = view_.of(update);
  const std::lock_guard lock(mutex_);
  const serve::SharedBytes now = shared(time_data(time_of(update.update.stamp)));
  for (auto& [peer, guest] : guests_) {
    if (peer->queued_bytes() <= kBusyBytes) peer->send(now, true);
  }
  for (live::RosMessage& message : messages) publish(std::move(message));
  if (!update.map) return;
  if (anybody_wants("/map")) drawer_->offer(update.update.stamp, update.map);
  if (live::steady_ns() < path_due_ns_ || !anybody_wants("/path")) return;
  path_due_ns_ = live::steady_ns() + kPath_ns;
  publish(live::path_message(update));
}

}  // namespace phasescan::foxglove
