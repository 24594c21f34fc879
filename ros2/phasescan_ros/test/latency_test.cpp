// From a scan that is published to the transform that another node hears: 10 scans a second, 720 beams.
#include <gtest/gtest.h>

#include <algorithm>

#include "map_of_rooms.hpp"
#include "node_process.hpp"
#include "robot.hpp"

namespace phasescan_ros::test::latency_test {
namespace {

using nav_msgs::msg::OccupancyGrid;
using Clock = std::chrono::steady_clock;

/// Prints median, 99th percentile and CPU; those of a machine that does other things too say little.
class Latency : public ::testing::Test {
 protected:
  /// Whether map -> odom of this stamp was heard.
  static bool says(const Heard<TFMessage>& tf, phasescan::Stamp stamp) {
    for (const TFMessage& message : tf.messages) {
      for (const auto& t : message.transforms) {
        if (t.child_frame_id == "odom" && to_stamp(t.header.stamp) == stamp) return true;
      }
    }
    return false;
  }
  void run(const std::string& executable, const std::string& name, double after_s) {
    constexpr std::size_t kScans = 300;
    Tester tester(name);
    Voice<OccupancyGrid> maps(tester.node(), "map_of_server", latched());
    maps.publish(map_of_rooms());
    std::map<std::string, std::string> parameters;
    if (name == "amcl") parameters["map_topic"] = "map_of_server";
    NodeProcess process(executable, name, parameters);
    ASSERT_TRUE(tester.bring_up());
    Robot robot(tester, true, 720);
    const auto tf = tester.listen<TFMessage>("/tf", 1000);
    robot.stand_up();
    std::vector<double> latencies_ms;
    const double cpu_s = process.cpu_s();
    const auto begun = Clock::now();
    for (std::size_t i = 0; i < kScans; ++i) {
      const phasescan::Stamp stamp = Robot::stamp(0.1 * static_cast<double>(i));
      const phasescan::Stamp awaited = stamp + static_cast<phasescan::Stamp>(std::llround(after_s * 1e9));
      tf->messages.clear();
      const LaserScan scan = robot.scan(i, stamp);
      robot.publish(tf_message(stamp, "odom", "base_footprint", robot.wheel_pose(i)));
      const auto said = Clock::now();
      robot.publish(scan);
      if (tester.wait([&] { return says(*tf, awaited); }, 0.09))
        latencies_ms.push_back(std::chrono::duration<double, std::milli>(Clock::now() - said).count());
      tester.pass(
          std::chrono::duration<double>(begun + (i + 1) * std::chrono::milliseconds(100) - Clock::now()).count());
    }
    const double took_s = std::chrono::duration<double>(Clock::now() - begun).count();
    std::sort(latencies_ms.begin(), latencies_ms.end());
    ASSERT_GT(latencies_ms.size(), kScans * 9 / 10);
    const auto of = [&](double part) {
      return latencies_ms[static_cast<std::size_t>(part * static_cast<double>(latencies_ms.size() - 1))];
    };
    std::printf("%s: %zu of %zu scans answered, p50 %.1f ms, p99 %.1f ms, most %.1f ms; CPU %.1f %% of one core\n",
                name.c_str(), latencies_ms.size(), kScans, of(0.5), of(0.99), latencies_ms.back(),
                100.0 * (process.cpu_s() - cpu_s) / took_s);
  }
};

TEST_F(Latency, SlamNode) {
  run(PHASESCAN_SLAM_NODE, "slam_toolbox", 0.2);
}

TEST_F(Latency, LocalizationNode) {
  run(PHASESCAN_LOCALIZATION_NODE, "amcl", 1.0);
}

}  // namespace
}  // namespace phasescan_ros::test::latency_test
