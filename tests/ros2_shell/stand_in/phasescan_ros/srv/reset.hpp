// A stand-in for what is made of the .srv of the package.
#pragma once
#include <cstdint>
namespace phasescan_ros::srv {
struct Reset {
  struct Request {};
  struct Response {
    std::uint8_t result = 0;
  };
};
}  // namespace phasescan_ros::srv
