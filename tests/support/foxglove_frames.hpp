// Frames that a Foxglove client sends.
#pragma once

#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>

namespace phasescan::testing {

inline std::span<const std::uint8_t> bytes_of(std::string_view text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

inline std::string publish(std::uint32_t channel, std::span<const std::uint8_t> payload) {
  std::string frame(5, '\x01');
  std::memcpy(frame.data() + 1, &channel, 4);
  frame.append(reinterpret_cast<const char*>(payload.data()), payload.size());
  return frame;
}

inline std::string advertise_pose(const std::string& encoding,
                                  const std::string& type = "geometry_msgs/msg/PoseWithCovarianceStamped") {
  return nlohmann::json{
      {"op", "advertise"},
      {"channels", {{{"id", 7}, {"topic", "/initialpose"}, {"encoding", encoding}, {"schemaName", type}}}}}
      .dump();
}

}  // namespace phasescan::testing
