// A stand-in: a message is its bytes.
#pragma once
#include <cstdint>
#include <vector>
namespace nav_msgs {
namespace msg {
struct OccupancyGrid {
  std::vector<std::uint8_t> bytes;
};
}  // namespace msg
namespace srv {
struct GetMap {
  struct Request {};
  struct Response {
    msg::OccupancyGrid map;
  };
};
}  // namespace srv
}  // namespace nav_msgs
