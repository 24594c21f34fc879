// A stand-in for what is made of the .srv of the package.
#pragma once
namespace phasescan_ros::srv {
struct Pause {
  struct Request {};
  struct Response {
    bool paused = false;
  };
};
}  // namespace phasescan_ros::srv
