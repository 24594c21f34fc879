// Options as parameters: names, bounds, types, what may be changed when.
#include "ros2/parameters.hpp"

#include <gtest/gtest.h>

#include <set>

#include "phasescan/slam/options.hpp"
#include "ros2/node_options.hpp"
#include "ros2/slam_node.hpp"

namespace phasescan::ros2::parameters_test {
namespace {

std::string complaint(ParameterTable& table, const std::string& name, const ParameterValue& value,
                      bool running = false) {
  const Parameter* entry = table.find(name);
  const auto before = entry != nullptr ? entry->get() : ParameterValue{};
  try {
    table.set(name, value, running);
  } catch (const std::invalid_argument& error) {
    EXPECT_TRUE(entry == nullptr || entry->get() == before) << name << " changed though it was refused";
    return error.what();
  }
  return "";
}

TEST(Parameters, EveryOneHasADescriptionAndItsDefault) {
  NodeOutputs nobody;
  SlamNode node({}, nobody);
  std::set<std::string> names;
  for (const Parameter& entry : node.parameters().entries()) {
    EXPECT_FALSE(entry.description.empty()) << entry.name;
    EXPECT_EQ(entry.get(), entry.default_value) << entry.name;
    EXPECT_NO_THROW(entry.set(entry.get())) << entry.name;
    EXPECT_TRUE(names.insert(entry.name).second) << entry.name << " stands twice";
    for (const std::optional<double>& bound : {entry.min, entry.max}) {
      EXPECT_TRUE(!bound || entry.default_value.index() != 3U) << entry.name;
    }
  }
  for (const char* name : {"odom_frame", "map_frame", "base_frame", "scan_topic", "max_laser_range", "throttle_scans",
                           "transform_publish_period", "transform_timeout", "map_update_interval", "map.resolution_m"})
    EXPECT_TRUE(names.contains(name)) << name;
}

TEST(Parameters, NamesOfAmcl) {
  LocalizationNodeOptions options;
  ParameterTable table;
  table.add("", options, true);
  for (const char* name :
       {"base_frame_id", "odom_frame_id", "global_frame_id", "transform_tolerance", "set_initial_pose",
        "initial_pose.x", "initial_pose.y", "initial_pose.yaw", "always_reset_initial_pose", "save_pose_rate",
        "initialize_at_saved_pose", "saved_pose_filepath", "first_map_only", "scan_topic", "map_topic",
        "laser_min_range", "laser_max_range", "tf_broadcast"})
    EXPECT_NE(table.find(name), nullptr) << name;
  EXPECT_EQ(std::get<double>(table.find("transform_tolerance")->default_value), 1.0);
}

TEST(Parameters, WhatIsRefusedChangesNothingAndIsNamed) {
  SlamNodeOptions options;
  OdometryOptions odometry;
  ParameterTable table;
  table.add("", options, false);
  table.add("odometry.", odometry, true);
  EXPECT_EQ(complaint(table, "nothing", true), "nothing: there is no such parameter");
  EXPECT_EQ(complaint(table, "throttle_scans", 0.5), "throttle_scans: is a number; expected a whole number");
  EXPECT_NE(complaint(table, "throttle_scans", std::int64_t{0}), "");
  EXPECT_NE(complaint(table, "transform_timeout", -0.1), "");
  EXPECT_NE(complaint(table, "odometry", std::string("wheels")).find("auto, tf, topic, none"), std::string::npos);
  EXPECT_NE(complaint(table, "odom_frame", true), "");
  EXPECT_EQ(complaint(table, "odom_frame", std::string("o"), true),
            "odom_frame: can be changed only before the node is configured");
  EXPECT_EQ(complaint(table, "transform_timeout", std::int64_t{1}), "");  // 1 for 1.0, as people write it
  EXPECT_EQ(options.transform_timeout, 1.0);
  EXPECT_EQ(complaint(table, "odometry", std::string("none")), "");
  EXPECT_EQ(options.odometry, OdometrySource::kNone);
}

TEST(Parameters, BoundsOfEachAreHeld) {
  SlamOptions options;
  ParameterTable table;
  SlamOptions::visit_sections(
      options, [&](std::string_view name, auto& section) { table.add(std::string(name) + ".", section, true); });
  int bounded = 0;
  for (const Parameter& entry : table.entries()) {
    if (!entry.max) continue;
    ++bounded;
    if (std::holds_alternative<double>(entry.default_value)) {
      EXPECT_NE(complaint(table, entry.name, *entry.max + 1.0, true), "") << entry.name;
    } else {
      EXPECT_NE(complaint(table, entry.name, static_cast<std::int64_t>(*entry.max) + 1, true), "") << entry.name;
    }
  }
  EXPECT_GT(bounded, 30);
  EXPECT_NO_THROW(options.validate());
}

}  // namespace
}  // namespace phasescan::ros2::parameters_test
