// A stand-in: messages of the stand-in are their bytes.
#pragma once

#include <algorithm>
#include <rclcpp/rclcpp.hpp>

namespace rclcpp {

template <class M>
class Serialization {
 public:
  void deserialize_message(const SerializedMessage* bytes, void* message) const {
    const rcl_serialized_message_t& raw = bytes->get_rcl_serialized_message();
    static_cast<M*>(message)->bytes.assign(raw.buffer, raw.buffer + raw.buffer_length);
  }
  void serialize_message(const void* message, SerializedMessage* bytes) const {
    const auto& from = static_cast<const M*>(message)->bytes;
    bytes->reserve(from.size());
    std::copy(from.begin(), from.end(), bytes->get_rcl_serialized_message().buffer);
    bytes->get_rcl_serialized_message().buffer_length = from.size();
  }
};

}  // namespace rclcpp
