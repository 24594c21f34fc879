/// The other side of a node under test: publishes, listens, calls services, changes its state.
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <diagnostic_msgs/msg/diagnostic_array.hpp>
#include <functional>
#include <lifecycle_msgs/msg/transition.hpp>
#include <lifecycle_msgs/srv/change_state.hpp>
#include <lifecycle_msgs/srv/get_state.hpp>
#include <memory>
#include <rcl_interfaces/srv/set_parameters.hpp>
#include <rclcpp/rclcpp.hpp>
#include <rclcpp/serialization.hpp>
#include <string>
#include <utility>
#include <vector>

#include "distributions.hpp"

namespace phasescan_ros::test {

using Transition = lifecycle_msgs::msg::Transition;

/// What a topic said. By way of bytes, as rclcpp's own templates take minutes to compile for each type.
template <class M>
struct Heard {
  std::vector<M> messages;
  rclcpp::GenericSubscription::SharedPtr subscription;
};

template <class M>
class Voice {
 public:
  Voice(rclcpp::Node& node, const std::string& topic, const rclcpp::QoS& qos)
      : publisher_(bytes_publisher(node, topic, rosidl_generator_traits::name<M>(), qos)) {}
  void publish(const M& message) {
    rclcpp::SerializedMessage bytes;
    rclcpp::Serialization<M>().serialize_message(&message, &bytes);
    publisher_->publish(bytes);
  }
  std::size_t hearers() const { return publisher_->get_subscription_count(); }

 private:
  rclcpp::GenericPublisher::SharedPtr publisher_;
};

inline rclcpp::QoS latched() {
  return rclcpp::QoS(1).reliable().transient_local();
}

class Tester {
 public:
  /// @param of  name of the node under test
  explicit Tester(std::string of) : of_(std::move(of)), node_(std::make_shared<rclcpp::Node>("tester")) {
    executor_.add_node(node_);
  }

  rclcpp::Node& node() { return *node_; }

  bool wait(const std::function<bool()>& until, double seconds = 20.0) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
    while (!until()) {
      if (std::chrono::steady_clock::now() > end || !rclcpp::ok()) return false;  // or somebody pressed Ctrl-C
      executor_.spin_once(std::chrono::milliseconds(5));
    }
    return true;
  }
  void pass(double seconds) {
    wait([] { return false; }, seconds);
  }

  template <class M>
  std::shared_ptr<Heard<M>> listen(const std::string& topic, const rclcpp::QoS& qos) {
    auto heard = std::make_shared<Heard<M>>();
    heard->subscription =
        bytes_subscription(*node_, topic, rosidl_generator_traits::name<M>(), qos,
                           [to = heard.get()](const rclcpp::SerializedMessage& bytes) {
                             to->messages.emplace_back();
                             rclcpp::Serialization<M>().deserialize_message(&bytes, &to->messages.back());
                           });
    return heard;
  }

  /// Null where there was no answer.
  template <class S>
  std::shared_ptr<typename S::Response> call(const std::string& name,
                                             typename S::Request request = typename S::Request()) {
    const auto client = node_->create_client<S>(name);
    if (!wait([&] { return client->service_is_ready(); })) return nullptr;
    auto future = client->async_send_request(std::make_shared<typename S::Request>(std::move(request)));
    if (!wait([&] { return future.wait_for(std::chrono::seconds(0)) == std::future_status::ready; })) return nullptr;
    return future.get();
  }

  /// That it answers: services of a process that was killed are known for a while still, and take requests in vain.
  bool meet() {
    using GetState = lifecycle_msgs::srv::GetState;
    const auto client = node_->create_client<GetState>(of_ + "/get_state");
    bool answered = false;
    for (int i = 0; i < 200 && !answered; ++i) {
      auto future = client->async_send_request(std::make_shared<GetState::Request>());
      answered = wait([&] { return future.wait_for(std::chrono::seconds(0)) == std::future_status::ready; }, 0.1);
    }
    return answered;
  }
  bool change_state(std::uint8_t transition) {
    lifecycle_msgs::srv::ChangeState::Request request;
    request.transition.id = transition;
    const auto response = call<lifecycle_msgs::srv::ChangeState>(of_ + "/change_state", request);
    return response && response->success;
  }
  bool bring_up() {
    return meet() && change_state(Transition::TRANSITION_CONFIGURE) && change_state(Transition::TRANSITION_ACTIVATE);
  }

  /// Empty: taken; else why not.
  std::string set(const rclcpp::Parameter& parameter) {
    rcl_interfaces::srv::SetParameters::Request request;
    request.parameters.push_back(parameter.to_parameter_msg());
    const auto response = call<rcl_interfaces::srv::SetParameters>(of_ + "/set_parameters", request);
    if (!response || response->results.empty()) return "no answer";
    return response->results[0].successful ? "" : response->results[0].reason;
  }

 private:
  std::string of_;
  rclcpp::Node::SharedPtr node_;
  rclcpp::executors::SingleThreadedExecutor executor_;
};

/// Whether one of the reports named a kind of trouble.
inline bool named(const Heard<diagnostic_msgs::msg::DiagnosticArray>& reports, const std::string& kind) {
  for (const auto& report : reports.messages) {
    for (const auto& status : report.status) {
      for (const auto& value : status.values) {
        if (value.key == kind) return true;
      }
    }
  }
  return false;
}

}  // namespace phasescan_ros::test
