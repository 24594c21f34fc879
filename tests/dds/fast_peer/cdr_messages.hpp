// Messages of ROS 2 by Fast CDR: written field by field, read into JSON.
#pragma once

#include <fastcdr/Cdr.h>
#include <fastcdr/FastBuffer.h>

#include <cstdint>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace fast_peer {

using eprosima::fastcdr::Cdr;
using Bytes = std::vector<char>;
using nlohmann::json;

struct Planar {
  double x = 0, y = 0, theta = 0;
};

/// Little-endian with its encapsulation.
Bytes made(const std::function<void(Cdr&)>& fill);
void put_header(Cdr& cdr, std::int64_t stamp, const std::string& frame);
void put_pose(Cdr& cdr, const Planar& pose);
Bytes tf_message(std::int64_t stamp, const std::string& parent, const std::string& child, const Planar& pose);

/// What stands in a message of the topic's type. @throws std::exception where Fast CDR cannot read it
using Read = json (*)(Bytes&);
json read_pose(Bytes& bytes);
json read_map(Bytes& bytes);
json read_transforms(Bytes& bytes);
json read_scan(Bytes& bytes);
json read_path(Bytes& bytes);
json read_text(Bytes& bytes);
json read_diagnostics(Bytes& bytes);

}  // namespace fast_peer
