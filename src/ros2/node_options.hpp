/// What the two nodes can be told, by the names that slam_toolbox and amcl have for it. Everything else is in the
/// options of the library, section by section ("odometry.cell_m").
#pragma once

#include <string>

#include "phasescan/core/options.hpp"
#include "ros2/scan_intake.hpp"

namespace phasescan::ros2 {

/// In place of slam_toolbox.
struct SlamNodeOptions {
  std::string odom_frame = "odom", map_frame = "map", base_frame = "base_footprint";
  std::string scan_topic = "scan", odom_topic = "odom";
  OdometrySource odometry = OdometrySource::kAuto;
  bool mounting_from_tf = true;
  double min_laser_range = 0.0, max_laser_range = 0.0;
  int throttle_scans = 1;
  double transform_publish_period = 0.05, transform_timeout = 0.2, map_update_interval = 5.0;
  std::string state_file;
  double autosave_period = 30.0;
  bool deterministic = false;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("odom_frame", self.odom_frame, OptionInfo{"", "frame of odometry"});
    v("map_frame", self.map_frame, OptionInfo{"", "frame of the map"});
    v("base_frame", self.base_frame, OptionInfo{"", "frame of the robot"});
    v("scan_topic", self.scan_topic, OptionInfo{"", "topics of laser scans, separated by blanks"});
    v("odom_topic", self.odom_topic, OptionInfo{"", "topic of nav_msgs/Odometry, where odometry is topic"});
    v("odometry", self.odometry,
      OptionInfo{"", "auto: odom -> base of /tf where there is one; tf; topic; none: odom -> base is published"});
    v("mounting_from_tf", self.mounting_from_tf,
      OptionInfo{"", "where lasers sit is read from /tf at each stamp; else they sit at the base"});
    v("min_laser_range", self.min_laser_range, OptionInfo{"m", "nearer returns are left out", 0, 100});
    v("max_laser_range", self.max_laser_range,
      OptionInfo{"m", "farther returns are out of range; 0: as the sensor says", 0, 1000});
    v("throttle_scans", self.throttle_scans, OptionInfo{"", "only each so-manieth scan is used", 1, 1000});
    v("transform_publish_period", self.transform_publish_period,
      OptionInfo{"s", "most time between transforms map -> odom; 0: none are published", 0, 10});
    v("transform_timeout", self.transform_timeout,
      OptionInfo{"s", "map -> odom is stamped so long after the last scan", 0, 10});
    v("map_update_interval", self.map_update_interval,
      OptionInfo{"s", "time between maps, by the scans' stamps", 0.1, 3600});
    v("state_file", self.state_file,
      OptionInfo{"", "saved run: gone on with where it exists, written while running and at the end"});
    v("autosave_period", self.autosave_period,
      OptionInfo{"s", "time between savings, by the scans' stamps; 0: at the end", 0, 1e6});
    v("deterministic", self.deterministic,
      OptionInfo{"", "the same bytes for the same scans; a scan may wait for loops and graph"});
  }
  IntakeOptions intake() const {
    return {base_frame, odom_frame, odometry, mounting_from_tf, min_laser_range, max_laser_range, throttle_scans};
  }
};

/// In place of amcl.
struct LocalizationNodeOptions {
  std::string odom_frame_id = "odom", global_frame_id = "map", base_frame_id = "base_footprint";
  std::string scan_topic = "scan", map_topic = "map", odom_topic = "odom";
  OdometrySource odometry = OdometrySource::kAuto;
  bool mounting_from_tf = true;
  double laser_min_range = -1.0, laser_max_range = -1.0;
  double transform_tolerance = 1.0;
  bool tf_broadcast = true;
  bool first_map_only = false;
  bool set_initial_pose = false, always_reset_initial_pose = false;
  double initial_x = 0.0, initial_y = 0.0, initial_yaw = 0.0;
  std::string saved_pose_filepath;
  bool initialize_at_saved_pose = true;
  double save_pose_rate = 0.5;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("odom_frame_id", self.odom_frame_id, OptionInfo{"", "frame of odometry"});
    v("global_frame_id", self.global_frame_id, OptionInfo{"", "frame of the map"});
    v("base_frame_id", self.base_frame_id, OptionInfo{"", "frame of the robot"});
    v("scan_topic", self.scan_topic, OptionInfo{"", "topics of laser scans, separated by blanks"});
    v("map_topic", self.map_topic, OptionInfo{"", "topic of the map"});
    v("odom_topic", self.odom_topic, OptionInfo{"", "topic of nav_msgs/Odometry, where odometry is topic"});
    v("odometry", self.odometry,
      OptionInfo{"", "auto: odom -> base of /tf where there is one; tf; topic; none: odom -> base is published"});
    v("mounting_from_tf", self.mounting_from_tf,
      OptionInfo{"", "where lasers sit is read from /tf at each stamp; else they sit at the base"});
    v("laser_min_range", self.laser_min_range, OptionInfo{"m", "nearer returns are left out; -1: none", -1, 100});
    v("laser_max_range", self.laser_max_range,
      OptionInfo{"m", "farther returns are out of range; -1: as the sensor says", -1, 1000});
    v("transform_tolerance", self.transform_tolerance,
      OptionInfo{"s", "map -> odom is stamped so long after its scan", 0, 10});
    v("tf_broadcast", self.tf_broadcast, OptionInfo{"", "publish map -> odom"});
    v("first_map_only", self.first_map_only, OptionInfo{"", "maps after the first one are left out"});
    v("set_initial_pose", self.set_initial_pose, OptionInfo{"", "begin at initial_pose"});
    v("always_reset_initial_pose", self.always_reset_initial_pose,
      OptionInfo{"", "begin at initial_pose after each activation, not only the first"});
    v("initial_pose.x", self.initial_x, OptionInfo{"m", "where the robot is at first", -1e6, 1e6});
    v("initial_pose.y", self.initial_y, OptionInfo{"m", "where the robot is at first", -1e6, 1e6});
    v("initial_pose.yaw", self.initial_yaw, OptionInfo{"rad", "where the robot looks at first", -7, 7});
    v("saved_pose_filepath", self.saved_pose_filepath, OptionInfo{"", "file for the last pose; empty: none"});
    v("initialize_at_saved_pose", self.initialize_at_saved_pose, OptionInfo{"", "begin at the pose of that file"});
    v("save_pose_rate", self.save_pose_rate,
      OptionInfo{"1/s", "how often that file is written; 0: at the end alone", 0, 10});
  }
  IntakeOptions intake() const {
    return {base_frame_id,
            odom_frame_id,
            odometry,
            mounting_from_tf,
            laser_min_range > 0.0 ? laser_min_range : 0.0,
            laser_max_range > 0.0 ? laser_max_range : 0.0,
            1};
  }
};

}  // namespace phasescan::ros2
