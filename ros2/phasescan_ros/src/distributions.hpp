/// What differs between distributions of ROS 2, and what may not be installed.
#pragma once

#include <rclcpp/rclcpp.hpp>
#include <rclcpp/version.h>
#include <rclcpp_lifecycle/lifecycle_node.hpp>

#include <memory>
#include <string>

#ifdef PHASESCAN_HAS_BOND
#include <bondcpp/bond.hpp>
#endif

namespace phasescan_ros {

/// A tie to nav2's lifecycle manager, which takes a node without one for dead (its bond_timeout 0 switches that off).
class Bond {
 public:
#ifdef PHASESCAN_HAS_BOND
  void start(const rclcpp_lifecycle::LifecycleNode::SharedPtr& node) {
    bond_ = std::make_unique<bond::Bond>("bond", node->get_name(), node);
    bond_->setHeartbeatPeriod(0.10);
    bond_->setHeartbeatTimeout(4.0);
    bond_->start();
  }
  void stop() {
    bond_.reset();
  }

 private:
  std::unique_ptr<bond::Bond> bond_;
#else
  void start(const rclcpp_lifecycle::LifecycleNode::SharedPtr&) {}
  void stop() {}
#endif
};

/// A publisher of messages that are bytes already. Its type is looked for at run time.
template <class Node>
rclcpp::GenericPublisher::SharedPtr bytes_publisher(Node& node, const std::string& topic, const std::string& type,
                                                    const rclcpp::QoS& qos) {
  return rclcpp::create_generic_publisher(node.get_node_topics_interface(), topic, type, qos);
}

template <class Node, class Callback>
rclcpp::GenericSubscription::SharedPtr bytes_subscription(Node& node, const std::string& topic, const std::string& type,
                                                          const rclcpp::QoS& qos, Callback callback) {
#if RCLCPP_VERSION_GTE(28, 0, 0)
  // From jazzy on any callback that a subscription takes.
  return rclcpp::create_generic_subscription(
      node.get_node_topics_interface(), topic, type, qos,
      [callback](std::shared_ptr<const rclcpp::SerializedMessage> message) { callback(*message); });
#else
  return rclcpp::create_generic_subscription(
      node.get_node_topics_interface(), topic, type, qos,
      std::function<void(std::shared_ptr<rclcpp::SerializedMessage>)>(
          [callback](std::shared_ptr<rclcpp::SerializedMessage> message) { callback(*message); }));
#endif
}

}  // namespace phasescan_ros
