#include "glue.hpp"

#include <cstring>
#include <sstream>

namespace phasescan_ros {

rclcpp::QoS to_ros(const core::Qos& qos) {
  rclcpp::QoS out(rclcpp::KeepLast(static_cast<std::size_t>(qos.depth)));
  if (qos.reliable) {
    out.reliable();
  } else {
    out.best_effort();
  }
  if (qos.transient_local) {
    out.transient_local();
  } else {
    out.durability_volatile();
  }
  return out;
}

core::ParameterValue to_core(const rclcpp::ParameterValue& value) {
  switch (value.get_type()) {
    case rclcpp::ParameterType::PARAMETER_BOOL:
      return value.get<bool>();
    case rclcpp::ParameterType::PARAMETER_INTEGER:
      return value.get<std::int64_t>();
    case rclcpp::ParameterType::PARAMETER_DOUBLE:
      return value.get<double>();
    case rclcpp::ParameterType::PARAMETER_STRING:
      return value.get<std::string>();
    default:
      throw std::invalid_argument("expected true or false, a number or text");
  }
}

rclcpp::ParameterValue to_ros(const core::ParameterValue& value) {
  return std::visit([](const auto& given) { return rclcpp::ParameterValue(given); }, value);
}

void declare_entries(rclcpp_lifecycle::LifecycleNode& node, core::ParameterTable& table) {
  for (const core::Parameter& entry : table.entries()) {
    rcl_interfaces::msg::ParameterDescriptor descriptor;
    descriptor.name = entry.name;
    descriptor.description = entry.description;
    descriptor.dynamic_typing = true;  // 1 is taken for 1.0; the table says what is wrong
    const rclcpp::ParameterValue given = node.declare_parameter(entry.name, to_ros(entry.default_value), descriptor);
    try {
      table.set(entry.name, to_core(given), false);
    } catch (const std::invalid_argument& error) {
      throw rclcpp::exceptions::InvalidParameterValueException(error.what());
    }
  }
}

rcl_interfaces::msg::SetParametersResult set_entries(
    const std::vector<rclcpp::Parameter>& parameters,
    const std::function<core::Answer(const std::string&, const core::ParameterValue&)>& set,
    const core::ParameterTable& table) {
  rcl_interfaces::msg::SetParametersResult result;
  result.successful = true;
  for (const rclcpp::Parameter& parameter : parameters) {
    if (table.find(parameter.get_name()) == nullptr) continue;  // use_sim_time and others are not ours
    core::Answer answer;
    try {
      answer = set(parameter.get_name(), to_core(parameter.get_parameter_value()));
    } catch (const std::invalid_argument& error) {
      answer = {false, parameter.get_name() + ": " + error.what()};
    }
    if (answer.done) continue;
    result.successful = false;
    result.reason = answer.why;
    return result;
  }
  return result;
}

std::vector<std::string> words_of(const std::string& text) {
  std::istringstream in(text);
  std::vector<std::string> out;
  for (std::string word; in >> word;) out.push_back(word);
  return out;
}

void Publishers::open() {
  const std::lock_guard lock(mutex_);
  for (const core::Endpoint& endpoint : core::endpoints(role_)) {
    if (endpoint.direction != core::Direction::kOut) continue;
    const std::string name(endpoint.name), type(endpoint.type);
    try {
      publishers_[name] = bytes_publisher(node_, name, type, to_ros(endpoint.qos));
    } catch (const std::exception& error) {
      RCLCPP_WARN(node_.get_logger(), "%s is not published: %s (%s)", name.c_str(), error.what(), type.c_str());
    }
  }
}

void Publishers::publish_bytes(rclcpp::GenericPublisher& publisher, const std::vector<std::uint8_t>& bytes) {
  rclcpp::SerializedMessage message(bytes.size());
  rcl_serialized_message_t& raw = message.get_rcl_serialized_message();
  std::memcpy(raw.buffer, bytes.data(), bytes.size());
  raw.buffer_length = bytes.size();
  try {
    publisher.publish(message);
  } catch (const std::exception& error) {
    // At the end of a process the thread that draws may still be at a map, and nobody can be told any more.
    if (rclcpp::ok()) RCLCPP_ERROR(node_.get_logger(), "%s: %s", publisher.get_topic_name(), error.what());
  }
}

phasescan::Bytes Subscriptions::bytes_of(const rclcpp::SerializedMessage& message) {
  const rcl_serialized_message_t& raw = message.get_rcl_serialized_message();
  return {raw.buffer, raw.buffer_length};
}

}  // namespace phasescan_ros
