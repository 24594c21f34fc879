/// Hashes of message types, as distributions from iron on compare them (REP 2011). They are those of the definitions
/// that ROS publishes; a test computes them from these.
#pragma once

#include <string>
#include <string_view>
#include <utility>

namespace phasescan::ros2 {

/// "RIHS01_" and 64 digits; empty for a type that is not one of the topics'.
constexpr std::string_view type_hash(std::string_view type) {
  constexpr std::pair<std::string_view, std::string_view> kHashes[] = {
      {"sensor_msgs/msg/LaserScan", "RIHS01_64c191398013af96509d518dac71d5164f9382553fce5c1f8cca5be7924bd828"},
      {"tf2_msgs/msg/TFMessage", "RIHS01_e369d0f05a23ae52508854b66f6aa0437f3449d652e8cbf22d5abe85d020f087"},
      {"nav_msgs/msg/Odometry", "RIHS01_3cc97dc7fb7502f8714462c526d369e35b603cfc34d946e3f2eda2766dfec6e0"},
      {"geometry_msgs/msg/PoseStamped", "RIHS01_10f3786d7d40fd2b54367835614bff85d4ad3b5dab62bf8bca0cc232d73b4cd8"},
      {"geometry_msgs/msg/PoseWithCovarianceStamped",
       "RIHS01_26432f9803e43727d3c8f668d1fdb3c630f548af631e2f4e31382371bfea3b6e"},
      {"nav_msgs/msg/Path", "RIHS01_1957a5bb3cee5da65c4e52e52b65a93df227efce4c20f8458b36e73066ca334b"},
      {"nav_msgs/msg/MapMetaData", "RIHS01_2772d4b2000ef2b35dbaeb80fd3946c1369f817fb4f75677d916d27c17d763c8"},
      {"nav_msgs/msg/OccupancyGrid", "RIHS01_8d348150c12913a31ee0ec170fbf25089e4745d17035792a1ba94d6f0bc0cfc7"},
      {"diagnostic_msgs/msg/DiagnosticArray",
       "RIHS01_5a8a36efb05fb25070fa0fb3810290c0e6cd4862b54a8fb975a1ee8dc55a333e"},
      {"nav2_msgs/msg/ParticleCloud", "RIHS01_193d8cb88ca2b98cd81ece15342744f054bb398ebfa8f6369914432303f42b11"},
      {"std_msgs/msg/String", "RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18"},
  };
  for (const auto& [name, hash] : kHashes) {
    if (name == type) return hash;
  }
  return "";
}

}  // namespace phasescan::ros2
