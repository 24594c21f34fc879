// A stand-in, written for tests: the part of rclcpp that the package uses, with topics and services inside the process.
// It is not rclcpp, and that the nodes run with it says nothing about a real one but that their calls have these forms.
#pragma once

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <chrono>
#include <functional>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

struct rcl_serialized_message_t {
  std::uint8_t* buffer = nullptr;
  std::size_t buffer_length = 0, buffer_capacity = 0;
};

namespace rcl_interfaces::msg {
struct ParameterDescriptor {
  std::string name, description;
  bool dynamic_typing = false, read_only = false;
};
struct SetParametersResult {
  bool successful = false;
  std::string reason;
};
}  // namespace rcl_interfaces::msg

namespace rclcpp {

class SerializedMessage {
 public:
  explicit SerializedMessage(std::size_t capacity = 0) : bytes_(capacity) { show(); }
  SerializedMessage(const SerializedMessage& other) : bytes_(other.bytes_) {
    show();
    raw_.buffer_length = other.raw_.buffer_length;
  }
  SerializedMessage& operator=(const SerializedMessage&) = delete;
  rcl_serialized_message_t& get_rcl_serialized_message() { return raw_; }
  const rcl_serialized_message_t& get_rcl_serialized_message() const { return raw_; }
  void reserve(std::size_t n) {
    bytes_.resize(n);
    show();
  }

 private:
  void show() { raw_.buffer = bytes_.data(), raw_.buffer_capacity = bytes_.size(); }
  std::vector<std::uint8_t> bytes_;
  rcl_serialized_message_t raw_;
};

struct KeepLast {
  explicit KeepLast(std::size_t n) : depth(n) {}
  std::size_t depth;
};
class QoS {
 public:
  explicit QoS(const KeepLast& keep) : depth(keep.depth) {}
  QoS& reliable() { return is_reliable = true, *this; }
  QoS& best_effort() { return is_reliable = false, *this; }
  QoS& transient_local() { return is_transient_local = true, *this; }
  QoS& durability_volatile() { return is_transient_local = false, *this; }
  std::size_t depth;
  bool is_reliable = true, is_transient_local = false;
};

/// All that the nodes of this process say.
struct StandInBus {
  using Callback = std::function<void(std::shared_ptr<SerializedMessage>)>;
  struct Subscription {
    std::string topic, type;
    QoS qos;
    Callback callback;
  };
  std::vector<std::weak_ptr<Subscription>> subscriptions;
  std::map<std::string, std::vector<std::vector<std::uint8_t>>> said;  ///< by topic
  std::map<std::string, std::function<void(void*, void*)>> services;   ///< request, response
  std::map<std::string, std::string> missing_types;                    ///< publishers of these throw
  std::int64_t now_ns = 0;
  std::map<std::string, std::variant<bool, std::int64_t, double, std::string>> overrides;  ///< of launch files

  void publish(const std::string& topic, const SerializedMessage& message) {
    const rcl_serialized_message_t& raw = message.get_rcl_serialized_message();
    said[topic].emplace_back(raw.buffer, raw.buffer + raw.buffer_length);
    for (const auto& weak : std::vector(subscriptions)) {
      const auto subscription = weak.lock();
      if (subscription && subscription->topic == topic)
        subscription->callback(std::make_shared<SerializedMessage>(message));
    }
  }
};
inline StandInBus& stand_in_bus() {
  static StandInBus bus;
  return bus;
}

class GenericPublisher {
 public:
  using SharedPtr = std::shared_ptr<GenericPublisher>;
  explicit GenericPublisher(std::string topic) : topic_(std::move(topic)) {}
  void publish(const SerializedMessage& message) { stand_in_bus().publish(topic_, message); }
  const char* get_topic_name() const { return topic_.c_str(); }

 private:
  std::string topic_;
};
struct GenericSubscription {
  using SharedPtr = std::shared_ptr<GenericSubscription>;
  std::shared_ptr<StandInBus::Subscription> held;
};

namespace node_interfaces {
struct NodeTopicsInterface {
  using SharedPtr = std::shared_ptr<NodeTopicsInterface>;
};
struct OnSetParametersCallbackHandle {
  using SharedPtr = std::shared_ptr<OnSetParametersCallbackHandle>;
};
}  // namespace node_interfaces

inline GenericPublisher::SharedPtr create_generic_publisher(node_interfaces::NodeTopicsInterface::SharedPtr,
                                                            const std::string& topic, const std::string& type,
                                                            const QoS&) {
  if (stand_in_bus().missing_types.contains(type)) throw std::runtime_error("package not found");
  return std::make_shared<GenericPublisher>(topic);
}
inline GenericSubscription::SharedPtr create_generic_subscription(
    node_interfaces::NodeTopicsInterface::SharedPtr, const std::string& topic, const std::string& type, const QoS& qos,
    std::function<void(std::shared_ptr<SerializedMessage>)> callback) {
  auto held =
      std::make_shared<StandInBus::Subscription>(StandInBus::Subscription{topic, type, qos, std::move(callback)});
  stand_in_bus().subscriptions.push_back(held);
  return std::make_shared<GenericSubscription>(GenericSubscription{held});
}

enum class ParameterType { PARAMETER_NOT_SET, PARAMETER_BOOL, PARAMETER_INTEGER, PARAMETER_DOUBLE, PARAMETER_STRING };
class ParameterValue {
 public:
  using Held = std::variant<bool, std::int64_t, double, std::string>;
  explicit ParameterValue(const bool value) : held_(value) {}
  explicit ParameterValue(const std::int64_t value) : held_(value) {}
  explicit ParameterValue(const double value) : held_(value) {}
  explicit ParameterValue(const std::string& value) : held_(value) {}
  explicit ParameterValue(Held value) : held_(std::move(value)) {}
  ParameterType get_type() const { return static_cast<ParameterType>(held_.index() + 1); }
  template <class T>
  const T& get() const {
    return std::get<T>(held_);
  }

 private:
  Held held_;
};
class Parameter {
 public:
  Parameter(std::string name, ParameterValue value) : name_(std::move(name)), value_(std::move(value)) {}
  const std::string& get_name() const { return name_; }
  const ParameterValue& get_parameter_value() const { return value_; }

 private:
  std::string name_;
  ParameterValue value_;
};

namespace exceptions {
struct InvalidParameterValueException : std::runtime_error {
  using std::runtime_error::runtime_error;
};
}  // namespace exceptions

class Time {
 public:
  explicit Time(std::int64_t ns) : ns_(ns) {}
  std::int64_t nanoseconds() const { return ns_; }

 private:
  std::int64_t ns_;
};
inline bool ok() {
  return true;
}
struct Logger {};
struct NodeOptions {};
struct TimerBase {
  using SharedPtr = std::shared_ptr<TimerBase>;
  std::function<void()> callback;
};
struct ServiceBase {
  using SharedPtr = std::shared_ptr<ServiceBase>;
};

}  // namespace rclcpp

#define RCLCPP_ERROR(logger, ...) ((void)(logger), std::fprintf(stderr, __VA_ARGS__), std::fputc('\n', stderr))
#define RCLCPP_WARN(logger, ...) RCLCPP_ERROR(logger, __VA_ARGS__)
