// In place of amcl: rclcpp around phasescan::ros2::LocalizationNode.
#include <memory>
#include <rclcpp_components/register_node_macro.hpp>
#include <std_srvs/srv/empty.hpp>
#include <string>

#ifdef PHASESCAN_HAS_NAV2_MSGS
#include <nav2_msgs/srv/set_initial_pose.hpp>
#include <rclcpp/serialization.hpp>
#endif

#include "managed_node.hpp"
#include "ros2/localization_node.hpp"
#include "ros2/localizer_finder.hpp"

namespace phasescan_ros {

using Empty = std_srvs::srv::Empty;

struct LocalizationWorks {
  static constexpr core::Role kRole = core::Role::kLocalization;
  static constexpr std::chrono::milliseconds kTick{100};

  LocalizationWorks(const std::string& name, core::NodeOutputs& outputs)
      : node({.name = name, .node = {}, .odometry = {}}, finders, outputs) {
    finders.add_parameters(node.parameters());
  }

  core::LocalizerFinders finders;
  core::LocalizationNode node;
};

class LocalizationNode : public ManagedNode<LocalizationWorks> {
 public:
  explicit LocalizationNode(const rclcpp::NodeOptions& options = rclcpp::NodeOptions())
      : ManagedNode("amcl", options) {}

 private:
  void subscribe() override {
    ManagedNode::subscribe();
    const core::LocalizationNodeOptions& options = core_.options();
    subscriptions_.open<core::OccupancyGrid>(
        "map", options.map_topic, [this](const core::OccupancyGrid& message) { core_.on_map(message, now_of(*this)); });
    subscriptions_.open<core::PoseWithCovarianceStamped>(
        "initialpose", "initialpose",
        [this](const core::PoseWithCovarianceStamped& message) { core_.on_initial_pose(message, now_of(*this)); });
  }

  void offer_services() override {
    offer<Empty>("reinitialize_global_localization", [this](const Empty::Request&, Empty::Response&) {
      const core::Answer answer = core_.reinitialize_global_localization(now_of(*this));
      if (!answer.done) RCLCPP_WARN(get_logger(), "%s", answer.why.c_str());
    });
    offer<Empty>("request_nomotion_update",
                 [this](const Empty::Request&, Empty::Response&) { core_.request_nomotion_update(); });
#ifdef PHASESCAN_HAS_NAV2_MSGS
    using SetPose = nav2_msgs::srv::SetInitialPose;
    offer<SetPose>("set_initial_pose", [this](const SetPose::Request& request, SetPose::Response&) {
      rclcpp::SerializedMessage bytes;
      rclcpp::Serialization<std::decay_t<decltype(request.pose)>>().serialize_message(&request.pose, &bytes);
      const rcl_serialized_message_t& raw = bytes.get_rcl_serialized_message();
      core_.on_initial_pose(core::decode<core::PoseWithCovarianceStamped>({raw.buffer, raw.buffer_length}),
                            now_of(*this));
    });
#endif
  }
};

}  // namespace phasescan_ros

RCLCPP_COMPONENTS_REGISTER_NODE(phasescan_ros::LocalizationNode)
