/// Messages to bytes and back, as they are on the wire of DDS and in bags.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "io/bytes.hpp"
#include "ros2/messages.hpp"

namespace phasescan::ros2 {

/// Little-endian XCDR1 with its 4 bytes of encapsulation. For the messages of `for_each_topic_type`.
template <class M>
std::vector<std::uint8_t> encode(const M& message);

/// The message of bytes in either byte order. Takes no more memory than the bytes justify.
/// @throws DecodeError where they end too early, or are not plain CDR
template <class M>
M decode(Bytes bytes);

/// Definition in the form of ROS .msg files, with those of the types it is made of, each behind a line of 80 "=".
template <class M>
std::string definition();

/// IDL of all messages as ROS 2 names them on DDS: pkg::msg::dds_::Name_, fields with a trailing underscore.
std::string idl();

}  // namespace phasescan::ros2
