// In place of slam_toolbox's node: rclcpp around phasescan::ros2::SlamNode.
#include <chrono>
#include <memory>
#include <nav_msgs/srv/get_map.hpp>
#include <optional>
#include <phasescan_ros/srv/load_state.hpp>
#include <phasescan_ros/srv/pause.hpp>
#include <phasescan_ros/srv/reset.hpp>
#include <phasescan_ros/srv/save_state.hpp>
#include <rclcpp/serialization.hpp>
#include <rclcpp_components/register_node_macro.hpp>
#include <string>

#ifdef PHASESCAN_HAS_SLAM_TOOLBOX
#include <slam_toolbox/srv/deserialize_pose_graph.hpp>
#include <slam_toolbox/srv/pause.hpp>
#include <slam_toolbox/srv/reset.hpp>
#include <slam_toolbox/srv/serialize_pose_graph.hpp>
#endif

#include "glue.hpp"
#include "ros2/slam_node.hpp"

namespace phasescan_ros {

using CallbackReturn = rclcpp_lifecycle::node_interfaces::LifecycleNodeInterface::CallbackReturn;

class SlamNode : public rclcpp_lifecycle::LifecycleNode {
 public:
  explicit SlamNode(const rclcpp::NodeOptions& options = rclcpp::NodeOptions())
      : rclcpp_lifecycle::LifecycleNode("slam_toolbox", options),
        publishers_(*this, core::Role::kSlam),
        subscriptions_(*this, core::Role::kSlam),
        core_(setup(), publishers_, &backend_, &drawing_) {
    declare_entries(*this, core_.parameters());
    on_set_ = add_on_set_parameters_callback([this](const std::vector<rclcpp::Parameter>& parameters) {
      return set_entries(
          parameters,
          [this](const std::string& name, const core::ParameterValue& value) {
            return core_.set_parameter(name, value, now_of(*this));
          },
          core_.parameters());
    });
  }

  /// Ctrl-C ends a node without a change of its state; what was mapped is saved all the same.
  ~SlamNode() override {
    core_.deactivate(now_of(*this));
  }

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
    timer_ = create_wall_timer(std::chrono::milliseconds(20), [this] { core_.tick(now_of(*this)); });
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

 private:
  core::SlamNode::Setup setup() const {
    core::SlamNode::Setup out;
    out.name = get_name();
    return out;
  }

  CallbackReturn end() {
    timer_.reset();
    bond_.stop();
    services_.clear();
    subscriptions_.close();
    core_.cleanup();
    publishers_.close();
    return CallbackReturn::SUCCESS;
  }

  void subscribe() {
    const core::SlamNodeOptions& options = core_.options();
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

  template <class Service, class Do>
  void offer(const std::string& name, Do act) {
    services_.push_back(create_service<Service>(
        "slam_toolbox/" + name,
        [this, act](const std::shared_ptr<typename Service::Request> request,
                    std::shared_ptr<typename Service::Response> response) { act(*request, *response); }));
  }

  template <class Response>
  static void say(const core::Answer& answer, Response& response) {
    response.result = answer.done ? 0 : 255;
  }

  void offer_services() {
    offer<srv::SaveState>("save_state",
                          [this](const srv::SaveState::Request& request, srv::SaveState::Response& response) {
                            const core::Answer answer = core_.save_state(request.filename, now_of(*this));
                            say(answer, response);
                            response.reason = answer.why;
                          });
    offer<srv::LoadState>(
        "load_state", [this](const srv::LoadState::Request& request, srv::LoadState::Response& response) {
          const core::Answer answer = core_.load_state(request.filename, request.extend, now_of(*this));
          say(answer, response);
          response.reason = answer.why;
        });
    offer<nav_msgs::srv::GetMap>(
        "dynamic_map", [this](const nav_msgs::srv::GetMap::Request&, nav_msgs::srv::GetMap::Response& response) {
          if (const auto grid = core_.dynamic_map()) fill(*grid, response.map);
        });
#ifdef PHASESCAN_HAS_SLAM_TOOLBOX
    offer_those_of_slam_toolbox();
#else
    offer<srv::Pause>("pause_new_measurements", [this](const srv::Pause::Request&, srv::Pause::Response& response) {
      core_.pause(!core_.paused());
      response.paused = core_.paused();
    });
    offer<srv::Reset>("reset", [this](const srv::Reset::Request&, srv::Reset::Response& response) {
      say(core_.reset(now_of(*this)), response);
    });
#endif
  }

#ifdef PHASESCAN_HAS_SLAM_TOOLBOX
  void offer_those_of_slam_toolbox() {
    namespace theirs = slam_toolbox::srv;
    offer<theirs::SerializePoseGraph>("serialize_map", [this](const auto& request, auto& response) {
      say(core_.save_state(request.filename, now_of(*this)), response);
    });
    offer<theirs::DeserializePoseGraph>("deserialize_map", [this](const auto& request, auto&) {
      const bool extend = request.match_type != theirs::DeserializePoseGraph::Request::START_AT_FIRST_NODE;
      const core::Answer answer = core_.load_state(request.filename, extend, now_of(*this));
      if (!answer.done) RCLCPP_ERROR(get_logger(), "%s", answer.why.c_str());
    });
    offer<theirs::Pause>("pause_new_measurements", [this](const auto&, auto& response) {
      core_.pause(!core_.paused());
      response.status = true;
    });
    offer<theirs::Reset>("reset", [this](const auto&, auto& response) { say(core_.reset(now_of(*this)), response); });
  }
#endif

  /// By way of its bytes: the message need not be filled field by field.
  template <class Theirs>
  static void fill(const core::OccupancyGrid& ours, Theirs& theirs) {
    const std::vector<std::uint8_t> bytes = core::encode(ours);
    rclcpp::SerializedMessage message(bytes.size());
    std::copy(bytes.begin(), bytes.end(), message.get_rcl_serialized_message().buffer);
    message.get_rcl_serialized_message().buffer_length = bytes.size();
    rclcpp::Serialization<Theirs>().deserialize_message(&message, &theirs);
  }

  // Ends from below: the node, then the threads with what they still have to draw, then where that goes.
  Publishers publishers_;
  Subscriptions subscriptions_;
  phasescan::ThreadExecutor backend_, drawing_;
  core::SlamNode core_;
  Bond bond_;
  rclcpp::TimerBase::SharedPtr timer_;
  std::vector<rclcpp::ServiceBase::SharedPtr> services_;
  rclcpp::node_interfaces::OnSetParametersCallbackHandle::SharedPtr on_set_;
};

}  // namespace phasescan_ros

RCLCPP_COMPONENTS_REGISTER_NODE(phasescan_ros::SlamNode)
