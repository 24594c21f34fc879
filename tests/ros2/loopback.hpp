// A robot in a simulated world whose scans and spoiled wheels go into a localisation node, as nav2's loopback
// simulation does it with a real one: what transforms say of the robot against where it is.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "eval/localize_places.hpp"
#include "ros2/localization_node.hpp"
#include "ros2/localizer_finder.hpp"
#include "ros2/node_support.hpp"
#include "sim/drive.hpp"

namespace phasescan::ros2 {

/// Wheels that count 6 % too much and turn 4 % too little.
inline Pose2 spoiled(const Pose2& step) {
  return {1.06 * step.x, step.y, 0.96 * step.theta};
}

/// After a moment when the robot was put elsewhere.
struct CarriedOff {
  double carried_m = 0.0;
  std::optional<double> back_s;  ///< until transforms are within 0.25 m, and stay so while it is watched
  std::optional<double> ok_s;    ///< until it is so and the status is ok
  double wrong_ok_s = 0.0;       ///< being more than 0.5 m off with the status ok, in all
};

/// A localisation node, driven.
class LoopbackNode {
 public:
  explicit LoopbackNode(const OccupancyGrid& map) {
    LocalizationNode::Setup setup;
    setup.node.mounting_from_tf = false;
    node_ = std::make_unique<LocalizationNode>(setup, finders_, out_);
    finders_.add_parameters(node_->parameters());
    node_->configure(at(0));
    node_->on_map(map, at(0));
    node_->activate();
  }
  LocalizationNode& node() { return *node_; }
  KeptOutputs& out() { return out_; }

  /// @param step  that the robot truly went since the scan before; none where it was carried
  void add(const LaserScan& scan, const Pose2& step) {
    wheels_ = wheels_ * spoiled(step);
    const Stamp now = scan.header.stamp;
    node_->on_transforms(tf_message(now, "odom", "base_footprint", wheels_), false, now);
    node_->on_scan("scan", scan, now);
  }
  /// Where transforms put the robot: what costmaps and planners see.
  std::optional<Pose2> seen() const {
    for (auto t = out_.transform_list.rbegin(); t != out_.transform_list.rend(); ++t) {
      if (t->child_frame_id == "odom") return pose_of(*t) * wheels_;
    }
    return std::nullopt;
  }
  double error_m(const Pose2& truth) const { return seen() ? translation_distance(*seen(), truth) : 1e9; }

 private:
  LocalizerFinders finders_;
  KeptOutputs out_;
  std::unique_ptr<LocalizationNode> node_;
  Pose2 wheels_{3, -2, 1};
};

/// Follows what the node says after a moment when the robot was put elsewhere.
class CarryingWatch {
 public:
  CarryingWatch(double carried_m, double period_s) : period_s_(period_s) { result_.carried_m = carried_m; }
  void add(double error_m, TrackingStatus status) {
    if (error_m >= 0.25) {
      result_.back_s.reset();
    } else if (!result_.back_s) {
      result_.back_s = static_cast<double>(scans_) * period_s_;
    }
    if (error_m < 0.25 && status == TrackingStatus::kOk && !result_.ok_s)
      result_.ok_s = static_cast<double>(scans_) * period_s_;
    if (error_m > 0.5 && status == TrackingStatus::kOk) result_.wrong_ok_s += period_s_;
    ++scans_;
  }
  const CarriedOff& result() const { return result_; }

 private:
  CarriedOff result_;
  double period_s_;
  std::size_t scans_ = 0;
};

}  // namespace phasescan::ros2
