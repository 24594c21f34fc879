// A stand-in.
#pragma once
#include <memory>
#include <rclcpp_lifecycle/lifecycle_node.hpp>
#include <string>
namespace bond {
struct Bond {
  Bond(const std::string&, const std::string&, const std::shared_ptr<rclcpp_lifecycle::LifecycleNode>&) {}
  void setHeartbeatPeriod(double) {}
  void setHeartbeatTimeout(double) {}
  void start() {}
};
}  // namespace bond
