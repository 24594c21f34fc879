/// A node that is killed while a robot drives, and started again.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdio>
#include <memory>

#include "node_process.hpp"
#include "robot.hpp"

namespace phasescan_ros::test {

/// Without a word of goodbye. The robot goes on at place `from` of its tour; the node must say a pose soon, and twenty
/// scans later the right one.
/// @param poses  what is heard of the node's poses  @param start  brings the node up again
template <class Poses, class Start>
void kill_and_start_again(Tester& tester, Robot& robot, std::size_t from, Poses& poses,
                          std::unique_ptr<NodeProcess>& process, Start start) {
  process->kill();
  poses.messages.clear();
  const auto begun = std::chrono::steady_clock::now();
  const auto since_s = [&] { return std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count(); };
  start();
  const double up_s = since_s();
  double took_s = 0.0, cpu_s = 0.0;
  for (std::size_t i = from; i < from + 20; ++i) {
    robot.step(i, Robot::stamp(0.1 * static_cast<double>(i)));
    tester.wait([&] { return !poses.messages.empty(); }, 0.1);
    if (poses.messages.empty() || took_s > 0.0) continue;
    took_s = since_s();
    cpu_s = process->cpu_s();
  }
  ASSERT_GT(took_s, 0.0) << "no pose came";
  std::printf("started again: active after %.2f s, a pose after %.2f s, of which its own CPU time %.2f s\n", up_s,
              took_s, cpu_s);
  EXPECT_LT(took_s, kMostOnABusyMachine_s);
  const auto& last = poses.messages.back();
  EXPECT_LT(translation_distance(pose_of(last.pose.pose.position, last.pose.pose.orientation),
                                 robot.pose_at(to_stamp(last.header.stamp))),
            0.15);
}

}  // namespace phasescan_ros::test
