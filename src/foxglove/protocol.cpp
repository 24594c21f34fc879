#include "foxglove/protocol.hpp"

#include <limits>
#include <nlohmann/json.hpp>
#include <optional>

#include "io/bytes.hpp"
#include "io/file.hpp"
#include "io/ros_encode.hpp"

namespace phasescan::foxglove {
namespace {

using nlohmann::json;

// More than any application asks for at once.
constexpr std::size_t kMostEntries = 256;
constexpr std::size_t kMostTextBytes = 256;

enum Opcode : std::uint8_t { kMessage = 1, kTime = 2 };
enum ClientOpcode : std::uint8_t { kClientMessage = 1, kServiceCall = 2 };

std::string text_of(const json& value) {
  return value.dump(-1, ' ', false, json::error_handler_t::replace);
}

std::string as_string(const ByteWriter& bytes) {
  return {reinterpret_cast<const char*>(bytes.bytes().data()), bytes.size()};
}

const json& member(const json& object, const char* key) {
  const auto found = object.is_object() ? object.find(key) : object.end();
  if (!object.is_object() || found == object.end()) throw ProtocolError(std::string("a message without '") + key + "'");
  return *found;
}

std::uint32_t id_of(const json& value, const char* key) {
  if (!value.is_number_unsigned() || value.get<std::uint64_t>() > std::numeric_limits<std::uint32_t>::max())
    throw ProtocolError(std::string("'") + key + "' is no whole number below 2^32");
  return value.get<std::uint32_t>();
}

std::string short_text(const json& object, const char* key) {
  const json& value = member(object, key);
  if (!value.is_string()) throw ProtocolError(std::string("'") + key + "' is no text");
  const auto& text = value.get_ref<const std::string&>();
  if (text.size() > kMostTextBytes) throw ProtocolError(std::string("'") + key + "' is too long");
  return text;
}

const json& list_of(const json& message, const char* key) {
  const json& list = member(message, key);
  if (!list.is_array()) throw ProtocolError(std::string("'") + key + "' is no list");
  if (list.size() > kMostEntries) throw ProtocolError(std::string("'") + key + "' has more than 256 entries");
  return list;
}

std::vector<std::uint32_t> ids_of(const json& message, const char* key) {
  std::vector<std::uint32_t> out;
  for (const json& id : list_of(message, key)) out.push_back(id_of(id, key));
  return out;
}

Subscribe subscribe_of(const json& message) {
  Subscribe out;
  for (const json& entry : list_of(message, "subscriptions"))
    out.subscriptions.emplace_back(id_of(member(entry, "id"), "id"), id_of(member(entry, "channelId"), "channelId"));
  return out;
}

Advertise advertise_of(const json& message) {
  Advertise out;
  for (const json& entry : list_of(message, "channels"))
    out.channels.push_back({id_of(member(entry, "id"), "id"), short_text(entry, "topic"), short_text(entry, "encoding"),
                            short_text(entry, "schemaName")});
  return out;
}

/// The parser calls itself for each level of nesting.
bool is_deep(std::string_view text) {
  constexpr int kMostLevels = 32;
  int levels = 0, deepest = 0;
  for (const char c : text) {
    if (c == '[' || c == '{') deepest = std::max(deepest, ++levels);
    if (c == ']' || c == '}') --levels;
  }
  return deepest > kMostLevels;
}

}  // namespace

std::string server_info(std::string_view name, std::string_view session) {
  return text_of({{"op", "serverInfo"},
                  {"name", name},
                  {"capabilities", {"clientPublish", "time"}},
                  {"supportedEncodings", {"cdr", "json"}},
                  {"metadata", json::object()},
                  {"sessionId", session}});
}

std::string advertise(std::span<const Channel> channels) {
  json list = json::array();
  for (const Channel& channel : channels) {
    list.push_back({{"id", channel.id},
                    {"topic", channel.topic},
                    {"encoding", "cdr"},
                    {"schemaName", channel.type},
                    {"schemaEncoding", "ros2msg"},
                    {"schema", ros::message_definition(channel.type)}});
  }
  return text_of({{"op", "advertise"}, {"channels", std::move(list)}});
}

std::string status(StatusLevel level, std::string_view message) {
  return text_of({{"op", "status"}, {"level", static_cast<int>(level)}, {"message", message}});
}

std::string message_data(std::uint32_t subscription, std::uint64_t time_ns, std::span<const std::uint8_t> payload) {
  ByteWriter out;
  out.put(static_cast<std::uint8_t>(kMessage));
  out.put(subscription);
  out.put(time_ns);
  out.raw(payload);
  return as_string(out);
}

std::string time_data(std::uint64_t time_ns) {
  ByteWriter out;
  out.put(static_cast<std::uint8_t>(kTime));
  out.put(time_ns);
  return as_string(out);
}

Request parse_text(std::string_view frame) {
  const json message = is_deep(frame) ? json(json::value_t::discarded) : json::parse(frame, nullptr, false);
  if (message.is_discarded()) throw ProtocolError("a text frame that is no JSON");
  const std::string op = short_text(message, "op");
  if (op == "subscribe") return subscribe_of(message);
  if (op == "unsubscribe") return Unsubscribe{ids_of(message, "subscriptionIds")};
  if (op == "advertise") return advertise_of(message);
  if (op == "unadvertise") return Unadvertise{ids_of(message, "channelIds")};
  for (const char* known :
       {"getParameters", "setParameters", "subscribeParameterUpdates", "unsubscribeParameterUpdates",
        "subscribeConnectionGraph", "unsubscribeConnectionGraph", "fetchAsset", "playbackControlRequest"}) {
    if (op == known) return Unsupported{op};
  }
  throw ProtocolError("op " + quote_text(op) + " is not known");
}

Request parse_binary(std::span<const std::uint8_t> frame) {
  ByteReader reader(frame);
  try {
    const auto opcode = reader.get<std::uint8_t>();
    if (opcode == kServiceCall) return Unsupported{"service call"};
    if (opcode != kClientMessage)
      throw ProtocolError("binary frame of kind " + std::to_string(opcode) + "; expected 1, a message");
    const auto channel = reader.get<std::uint32_t>();
    return Publish{channel, reader.bytes(reader.remaining())};
  } catch (const DecodeError&) {
    throw ProtocolError("a binary frame of " + std::to_string(frame.size()) + " bytes; expected 5 at least");
  }
}

}  // namespace phasescan::foxglove
