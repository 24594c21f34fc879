/// What both nodes have in common: a managed node of ROS 2 around a node without ROS.
#pragma once

#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include "glue.hpp"
#include "ros2/node_options.hpp"

namespace phasescan_ros {

using CallbackReturn = rclcpp_lifecycle::node_interfaces::LifecycleNodeInterface::CallbackReturn;

/// @tparam Works  has the node without ROS as `node`, and what that needs; made of name and outputs
template <class Works>
class ManagedNode : public rclcpp_lifecycle::LifecycleNode {
 public:
  /// Ctrl-C ends a node without a change of its state; what it has is saved all the same.
  ~ManagedNode() override { core_.deactivate(now_of(*this)); }

  CallbackReturn on_configure(const rclcpp_lifecycle::State&) override {
    publishers_.open();
    if (const core::Answer answer = core_.configure(now_of(*this)); !answer.done) {
      RCLCPP_ERROR(get_logger(), "%s", answer.why.c_str());
      publishers_.close();
      return CallbackReturn::FAILURE;
    }
    subscribe();
    offer_services();
    return CallbackReturn::SUCCESS;
  }
  CallbackReturn on_activate(const rclcpp_lifecycle::State&) override {
    core_.activate();
    timer_ = create_wall_timer(Works::kTick, [this] { core_.tick(now_of(*this)); });
    bond_.start(std::static_pointer_cast<rclcpp_lifecycle::LifecycleNode>(shared_from_this()));
    return CallbackReturn::SUCCESS;
  }
  CallbackReturn on_deactivate(const rclcpp_lifecycle::State&) override {
    timer_.reset();
    core_.deactivate(now_of(*this));
    bond_.stop();
    return CallbackReturn::SUCCESS;
  }
  CallbackReturn on_cleanup(const rclcpp_lifecycle::State&) override { return end(); }
  CallbackReturn on_shutdown(const rclcpp_lifecycle::State&) override {
    core_.deactivate(now_of(*this));
    return end();
  }

 protected:
  ManagedNode(const std::string& name, const rclcpp::NodeOptions& options)
      : rclcpp_lifecycle::LifecycleNode(name, options),
        publishers_(*this, Works::kRole),
        subscriptions_(*this, Works::kRole),
        works_(get_name(), publishers_),
        core_(works_.node) {
    declare_entries(*this, core_.parameters());
    on_set_ = add_on_set_parameters_callback([this](const std::vector<rclcpp::Parameter>& parameters) {
      return set_entries(
          parameters,
          [this](const std::string& parameter, const core::ParameterValue& value) {
            return core_.set_parameter(parameter, value, now_of(*this));
          },
          core_.parameters());
    });
  }

  virtual void offer_services() = 0;
  virtual void subscribe() {
    const auto& options = core_.options();
    for (const std::string& topic : words_of(options.scan_topic)) {
      subscriptions_.open<core::LaserScan>("scan", topic, [this, topic](const core::LaserScan& message) {
        core_.on_scan(topic, message, now_of(*this));
      });
    }
    for (const bool is_static : {true, false}) {
      const std::string topic = is_static ? "/tf_static" : "/tf";
      subscriptions_.open<core::TFMessage>(topic, topic, [this, is_static](const core::TFMessage& message) {
        core_.on_transforms(message, is_static, now_of(*this));
      });
    }
    if (options.odometry == core::OdometrySource::kTopic) {
      subscriptions_.open<core::Odometry>("odom", options.odom_topic, [this](const core::Odometry& message) {
        core_.on_odometry(message, now_of(*this));
      });
    }
  }

  /// @param act  takes request and response by reference
  template <class Service, class Do>
  void offer(const std::string& name, Do act) {
    services_.push_back(create_service<Service>(
        name, [act](const std::shared_ptr<typename Service::Request> request,
                    std::shared_ptr<typename Service::Response> response) { act(*request, *response); }));
  }

 private:
  CallbackReturn end() {
    timer_.reset();
    bond_.stop();
    services_.clear();
    subscriptions_.close();
    core_.cleanup();
    publishers_.close();
    return CallbackReturn::SUCCESS;
  }

  // Ends from below: the node with its threads, then where that goes what they still have to draw.
  Publishers publishers_;

 protected:
  Subscriptions subscriptions_;

 private:
  Works works_;

 protected:
  decltype(Works::node)& core_;

 private:
  Bond bond_;
  rclcpp::TimerBase::SharedPtr timer_;
  std::vector<rclcpp::ServiceBase::SharedPtr> services_;
  rclcpp::node_interfaces::OnSetParametersCallbackHandle::SharedPtr on_set_;
};

}  // namespace phasescan_ros
