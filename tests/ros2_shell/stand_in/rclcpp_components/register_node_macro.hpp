// A stand-in: components are made by their names.
#pragma once

#include <rclcpp_lifecycle/lifecycle_node.hpp>

namespace rclcpp_components {
using Maker = std::function<std::shared_ptr<rclcpp_lifecycle::LifecycleNode>()>;
inline std::map<std::string, Maker>& stand_in_components() {
  static std::map<std::string, Maker> components;
  return components;
}
struct StandInRegistration {
  StandInRegistration(const char* name, Maker maker) { stand_in_components()[name] = std::move(maker); }
};
}  // namespace rclcpp_components

#define RCLCPP_COMPONENTS_REGISTER_NODE(Class) \
  static const rclcpp_components::StandInRegistration kRegistered(#Class, [] { return std::make_shared<Class>(); });
