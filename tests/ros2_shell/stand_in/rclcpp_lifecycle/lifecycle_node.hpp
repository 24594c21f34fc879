// A stand-in, written for tests: see rclcpp/rclcpp.hpp beside it.
#pragma once

#include <rclcpp/rclcpp.hpp>

namespace rclcpp_lifecycle {

struct State {};
namespace node_interfaces {
struct LifecycleNodeInterface {
  enum class CallbackReturn { SUCCESS, FAILURE, ERROR };
};
}  // namespace node_interfaces

class LifecycleNode : public std::enable_shared_from_this<LifecycleNode> {
 public:
  using SharedPtr = std::shared_ptr<LifecycleNode>;
  using CallbackReturn = node_interfaces::LifecycleNodeInterface::CallbackReturn;
  using OnSet = std::function<rcl_interfaces::msg::SetParametersResult(const std::vector<rclcpp::Parameter>&)>;

  LifecycleNode(std::string name, const rclcpp::NodeOptions&) : name_(std::move(name)) {}
  virtual ~LifecycleNode() = default;
  virtual CallbackReturn on_configure(const State&) { return CallbackReturn::SUCCESS; }
  virtual CallbackReturn on_activate(const State&) { return CallbackReturn::SUCCESS; }
  virtual CallbackReturn on_deactivate(const State&) { return CallbackReturn::SUCCESS; }
  virtual CallbackReturn on_cleanup(const State&) { return CallbackReturn::SUCCESS; }
  virtual CallbackReturn on_shutdown(const State&) { return CallbackReturn::SUCCESS; }

  const char* get_name() const { return name_.c_str(); }
  rclcpp::Logger get_logger() const { return {}; }
  rclcpp::Time now() const { return rclcpp::Time(rclcpp::stand_in_bus().now_ns); }
  rclcpp::node_interfaces::NodeTopicsInterface::SharedPtr get_node_topics_interface() {
    return std::make_shared<rclcpp::node_interfaces::NodeTopicsInterface>();
  }
  // Of these names the real one has members too: they hide functions outside.
  void declare_parameters(const std::string&, const std::map<std::string, int>&) {}
  void set_parameters(const std::vector<rclcpp::Parameter>&) {}
  rclcpp::ParameterValue declare_parameter(const std::string& name, const rclcpp::ParameterValue& otherwise,
                                           const rcl_interfaces::msg::ParameterDescriptor& descriptor) {
    declared[name] = descriptor;
    const auto& overrides = rclcpp::stand_in_bus().overrides;
    const auto found = overrides.find(name);
    return found == overrides.end() ? otherwise : rclcpp::ParameterValue(found->second);
  }
  rclcpp::node_interfaces::OnSetParametersCallbackHandle::SharedPtr add_on_set_parameters_callback(OnSet callback) {
    on_set = std::move(callback);
    return std::make_shared<rclcpp::node_interfaces::OnSetParametersCallbackHandle>();
  }
  rclcpp::TimerBase::SharedPtr create_wall_timer(std::chrono::milliseconds, std::function<void()> callback) {
    auto timer = std::make_shared<rclcpp::TimerBase>(rclcpp::TimerBase{std::move(callback)});
    timers.push_back(timer);
    return timer;
  }
  template <class S, class Callback>
  rclcpp::ServiceBase::SharedPtr create_service(const std::string& name, Callback callback) {
    rclcpp::stand_in_bus().services[name] = [callback](void* request, void* response) {
      const auto* given = static_cast<const typename S::Request*>(request);
      auto answer = std::make_shared<typename S::Response>();
      callback(std::make_shared<typename S::Request>(*given), answer);
      *static_cast<typename S::Response*>(response) = *answer;
    };
    return std::make_shared<rclcpp::ServiceBase>();
  }
  void tick() {
    for (const auto& weak : timers) {
      if (const auto timer = weak.lock()) timer->callback();
    }
  }

  std::map<std::string, rcl_interfaces::msg::ParameterDescriptor> declared;
  OnSet on_set;
  std::vector<std::weak_ptr<rclcpp::TimerBase>> timers;

 private:
  std::string name_;
};

}  // namespace rclcpp_lifecycle
