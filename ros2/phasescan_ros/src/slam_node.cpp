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

#include "managed_node.hpp"
#include "ros2/slam_node.hpp"

namespace phasescan_ros {

struct SlamWorks {
  static constexpr core::Role kRole = core::Role::kSlam;
  static constexpr std::chrono::milliseconds kTick{20};

  SlamWorks(const std::string& name, core::NodeOutputs& outputs)
      : node({.name = name, .node = {}, .slam = {}}, outputs, &backend, &drawing) {}

  phasescan::ThreadExecutor backend, drawing;  // these end after the node, with what they still have to draw
  core::SlamNode node;
};

class SlamNode : public ManagedNode<SlamWorks> {
 public:
  explicit SlamNode(const rclcpp::NodeOptions& options = rclcpp::NodeOptions())
      : ManagedNode("slam_toolbox", options) {}

 private:
  template <class Response>
  static void say(const core::Answer& answer, Response& response) {
    response.result = answer.done ? 0 : 255;
  }

  void offer_services() override {
    offer<srv::SaveState>("slam_toolbox/save_state",
                          [this](const srv::SaveState::Request& request, srv::SaveState::Response& response) {
                            const core::Answer answer = core_.save_state(request.filename, now_of(*this));
                            say(answer, response);
                            response.reason = answer.why;
                          });
    offer<srv::LoadState>(
        "slam_toolbox/load_state", [this](const srv::LoadState::Request& request, srv::LoadState::Response& response) {
          const core::Answer answer = core_.load_state(request.filename, request.extend, now_of(*this));
          say(answer, response);
          response.reason = answer.why;
        });
    offer<nav_msgs::srv::GetMap>("slam_toolbox/dynamic_map", [this](const nav_msgs::srv::GetMap::Request&,
                                                                    nav_msgs::srv::GetMap::Response& response) {
      if (const auto grid = core_.dynamic_map()) fill(*grid, response.map);
    });
#ifdef PHASESCAN_HAS_SLAM_TOOLBOX
    offer_those_of_slam_toolbox();
#else
    offer<srv::Pause>("slam_toolbox/pause_new_measurements",
                      [this](const srv::Pause::Request&, srv::Pause::Response& response) {
                        core_.pause(!core_.paused());
                        response.paused = core_.paused();
                      });
    offer<srv::Reset>("slam_toolbox/reset", [this](const srv::Reset::Request&, srv::Reset::Response& response) {
      say(core_.reset(now_of(*this)), response);
    });
#endif
  }

#ifdef PHASESCAN_HAS_SLAM_TOOLBOX
  void offer_those_of_slam_toolbox() {
    namespace theirs = slam_toolbox::srv;
    offer<theirs::SerializePoseGraph>("slam_toolbox/serialize_map", [this](const auto& request, auto& response) {
      say(core_.save_state(request.filename, now_of(*this)), response);
    });
    offer<theirs::DeserializePoseGraph>("slam_toolbox/deserialize_map", [this](const auto& request, auto&) {
      const bool extend = request.match_type != theirs::DeserializePoseGraph::Request::START_AT_FIRST_NODE;
      const core::Answer answer = core_.load_state(request.filename, extend, now_of(*this));
      if (!answer.done) RCLCPP_ERROR(get_logger(), "%s", answer.why.c_str());
    });
    offer<theirs::Pause>("slam_toolbox/pause_new_measurements", [this](const auto&, auto& response) {
      core_.pause(!core_.paused());
      response.status = true;
    });
    offer<theirs::Reset>("slam_toolbox/reset",
                         [this](const auto&, auto& response) { say(core_.reset(now_of(*this)), response); });
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
};

}  // namespace phasescan_ros

RCLCPP_COMPONENTS_REGISTER_NODE(phasescan_ros::SlamNode)
