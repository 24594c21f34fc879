// A stand-in for what is made of the .srv of the package.
#pragma once
#include <cstdint>
#include <string>
namespace phasescan_ros::srv {
struct LoadState {
  struct Request {
    std::string filename;
    bool extend = false;
  };
  struct Response {
    std::uint8_t result = 0;
    std::string reason;
  };
};
}  // namespace phasescan_ros::srv
