// A stand-in: a message is its bytes.
#pragma once
#include <cstdint>
#include <vector>
namespace nav2_msgs::srv {
struct SetInitialPose {
  struct Request {
    struct Pose {
      std::vector<std::uint8_t> bytes;
    } pose;
  };
  struct Response {};
};
}  // namespace nav2_msgs::srv
