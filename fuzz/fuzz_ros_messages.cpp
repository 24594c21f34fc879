// Single ROS messages: the first byte tells the wire form and the type.
#include "io/ros_messages.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace phasescan;
  if (size == 0) return 0;
  const ros::Wire wire = (data[0] & 1) != 0 ? ros::Wire::kCdr : ros::Wire::kRos1;
  const Bytes bytes(data + 1, size - 1);
  try {
    if (data[0] / 2 % 3 == 0) {
      ros::LaserScan scan;
      decode(wire, bytes, scan);
      static_cast<void>(to_scan(scan));
    } else if (data[0] / 2 % 3 == 1) {
      ros::Odometry odometry;
      decode(wire, bytes, odometry);
    } else {
      std::vector<ros::Transform> transforms;
      decode(wire, bytes, transforms);
    }
  } catch (const DecodeError&) {
  }
  return 0;
}
