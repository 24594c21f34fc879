/// Between rclcpp and the nodes without ROS: topics as bytes, parameters, time.
#pragma once

#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "distributions.hpp"
#include "ros2/codec.hpp"
#include "ros2/outputs.hpp"
#include "ros2/parameters.hpp"
#include "ros2/qos.hpp"

namespace phasescan_ros {

using phasescan::Stamp;
namespace core = phasescan::ros2;

inline Stamp now_of(const rclcpp_lifecycle::LifecycleNode& node) {
  return node.now().nanoseconds();
}

rclcpp::QoS to_ros(const core::Qos& qos);
core::ParameterValue to_core(const rclcpp::ParameterValue& value);
rclcpp::ParameterValue to_ros(const core::ParameterValue& value);

/// Declares each with its bounds and description, and sets those that launch files give.
/// @throws rclcpp::exceptions::InvalidParameterValueException naming the parameter
void declare_entries(rclcpp_lifecycle::LifecycleNode& node, core::ParameterTable& table);
/// What add_on_set_parameters_callback asks for. `set` answers for one parameter.
rcl_interfaces::msg::SetParametersResult set_entries(
    const std::vector<rclcpp::Parameter>& parameters,
    const std::function<core::Answer(const std::string&, const core::ParameterValue&)>& set,
    const core::ParameterTable& table);

/// Names separated by blanks.
std::vector<std::string> words_of(const std::string& text);

/// All topics that a role says; a message whose package is not installed is left out with a warning.
class Publishers final : public core::NodeOutputs {
 public:
  Publishers(rclcpp_lifecycle::LifecycleNode& node, core::Role role) : node_(node), role_(role) {}
  void open();
  void close() {
    const std::lock_guard lock(mutex_);
    publishers_.clear();
  }

  void transforms(const core::TFMessage& m) override { publish("/tf", m); }
  void pose(const core::PoseWithCovarianceStamped& m) override {
    publish(role_ == core::Role::kSlam ? "pose" : "amcl_pose", m);
  }
  void map(const core::OccupancyGrid& m) override {
    publish("map", m);
    publish("map_metadata", m.info);
  }
  void path(const core::Path& m) override { publish("path", m); }
  void particles(const core::ParticleCloud& m) override { publish("particle_cloud", m); }
  void status(const core::String& m) override { publish("status", m); }
  void diagnostics(const core::DiagnosticArray& m) override { publish("/diagnostics", m); }

 private:
  template <class M>
  void publish(const std::string& name, const M& message) {
    const std::lock_guard lock(mutex_);
    if (const auto found = publishers_.find(name); found != publishers_.end())
      publish_bytes(*found->second, core::encode(message));
  }
  void publish_bytes(rclcpp::GenericPublisher& publisher, const std::vector<std::uint8_t>& bytes);

  rclcpp_lifecycle::LifecycleNode& node_;
  core::Role role_;
  std::mutex mutex_;  // maps come from a thread of their own
  std::map<std::string, rclcpp::GenericPublisher::SharedPtr> publishers_;
};

/// Subscriptions of a role, each with what is to be done with its messages. Bytes that are none are told and passed
/// over.
class Subscriptions {
 public:
  Subscriptions(rclcpp_lifecycle::LifecycleNode& node, core::Role role) : node_(node), role_(role) {}

  /// @param endpoint  as the role's table calls it; @param topic  where it is
  template <class M, class Use>
  void open(const std::string& endpoint, const std::string& topic, Use use) {
    const core::Endpoint& entry = core::endpoint(role_, core::Direction::kIn, endpoint);
    open_.push_back(bytes_subscription(node_, topic, std::string(entry.type), to_ros(entry.qos),
                                       [this, use, topic](const rclcpp::SerializedMessage& message) {
                                         try {
                                           use(core::decode<M>(bytes_of(message)));
                                         } catch (const phasescan::DecodeError& error) {
                                           RCLCPP_ERROR(node_.get_logger(), "%s: %s", topic.c_str(), error.what());
                                         }
                                       }));
  }
  void close() { open_.clear(); }

 private:
  static phasescan::Bytes bytes_of(const rclcpp::SerializedMessage& message);

  rclcpp_lifecycle::LifecycleNode& node_;
  core::Role role_;
  std::vector<rclcpp::GenericSubscription::SharedPtr> open_;
};

}  // namespace phasescan_ros
