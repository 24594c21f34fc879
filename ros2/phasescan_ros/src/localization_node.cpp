// In place of amcl: rclcpp around phasescan::ros2::LocalizationNode.
#include <memory>
#include <rclcpp_components/register_node_macro.hpp>
#include <std_srvs/srv/empty.hpp>
#include <string>

#ifdef PHASESCAN_HAS_NAV2_MSGS
#include <nav2_msgs/srv/set_initial_pose.hpp>
#include <rclcpp/serialization.hpp>
#endif

#include "glue.hpp"
#include "ros2/localization_node.hpp"
#include "ros2/localizer_finder.hpp"

namespace phasescan_ros {

using CallbackReturn = rclcpp_lifecycle::node_interfaces::LifecycleNodeInterface::CallbackReturn;
using Empty = std_srvs::srv::Empty;

class LocalizationNode : public rclcpp_lifecycle::LifecycleNode {
 public:
  explicit LocalizationNode(const rclcpp::NodeOptions& options = rclcpp::NodeOptions())
      : rclcpp_lifecycle::LifecycleNode("amcl", options),
        publishers_(*this, core::Role::kLocalization),
        subscriptions_(*this, core::Role::kLocalization),
        core_(setup(), finders_, publishers_) {
    finders_.add_parameters(core_.parameters());
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

  /// Ctrl-C ends a node without a change of its state; the pose is saved all the same.
  ~LocalizationNode() override {
    core_.deactivate(now_of(*this));
  }

  CallbackReturn on_configure(const rclcpp_lifecycle::State&) override {
    publishers_.open();
    if (const core::Answer answer = core_.configure(now_of(*this)); !answer.done) {
      RCLCPP_ERROR(get_logger(), "%s", answer.why.c_str());
      return CallbackReturn::FAILURE;
    }
    subscribe();
    offer_services();
    return CallbackReturn::SUCCESS;
  }
  CallbackReturn on_activate(const rclcpp_lifecycle::State&) override {
    core_.activate(now_of(*this));
    timer_ = create_wall_timer(std::chrono::milliseconds(100), [this] { core_.tick(now_of(*this)); });
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
  core::LocalizationNode::Setup setup() const {
    core::LocalizationNode::Setup out;
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
    const core::LocalizationNodeOptions& options = core_.options();
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
    subscriptions_.open<core::OccupancyGrid>(
        "map", options.map_topic, [this](const core::OccupancyGrid& message) { core_.on_map(message, now_of(*this)); });
    subscriptions_.open<core::PoseWithCovarianceStamped>(
        "initialpose", "initialpose",
        [this](const core::PoseWithCovarianceStamped& message) { core_.on_initial_pose(message, now_of(*this)); });
  }

  void offer_services() {
    services_.push_back(
        create_service<Empty>("reinitialize_global_localization",
                              [this](const std::shared_ptr<Empty::Request>, std::shared_ptr<Empty::Response>) {
                                const core::Answer answer = core_.reinitialize_global_localization(now_of(*this));
                                if (!answer.done) RCLCPP_WARN(get_logger(), "%s", answer.why.c_str());
                              }));
    services_.push_back(create_service<Empty>(
        "request_nomotion_update", [this](const std::shared_ptr<Empty::Request>, std::shared_ptr<Empty::Response>) {
          core_.request_nomotion_update();
        }));
#ifdef PHASESCAN_HAS_NAV2_MSGS
    using SetPose = nav2_msgs::srv::SetInitialPose;
    services_.push_back(create_service<SetPose>(
        "set_initial_pose",
        [this](const std::shared_ptr<SetPose::Request> request, std::shared_ptr<SetPose::Response>) {
          using Theirs = decltype(request->pose);
          rclcpp::SerializedMessage bytes;
          rclcpp::Serialization<Theirs>().serialize_message(&request->pose, &bytes);
          const rcl_serialized_message_t& raw = bytes.get_rcl_serialized_message();
          core_.on_initial_pose(core::decode<core::PoseWithCovarianceStamped>({raw.buffer, raw.buffer_length}),
                                now_of(*this));
        }));
#endif
  }

  Publishers publishers_;
  Subscriptions subscriptions_;
  core::LocalizerFinders finders_;
  core::LocalizationNode core_;
  Bond bond_;
  rclcpp::TimerBase::SharedPtr timer_;
  std::vector<rclcpp::ServiceBase::SharedPtr> services_;
  rclcpp::node_interfaces::OnSetParametersCallbackHandle::SharedPtr on_set_;
};

}  // namespace phasescan_ros

RCLCPP_COMPONENTS_REGISTER_NODE(phasescan_ros::LocalizationNode)
