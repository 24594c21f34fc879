// Two hosts on the loopback interface, in two domains of one process: topics, qualities of service, large messages.
#include "dds/participant.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>

#include "ros2/node_support.hpp"

namespace phasescan::dds::participant_test {
namespace {

using ros2::OccupancyGrid;
using ros2::Qos;

Network localhost(int more = 0) {
  Network network;
  network.domain = 100 + (static_cast<int>(::getpid()) + more) % 100;
  network.reach = Reach::kLocalhost;
  return network;
}

template <class Done>
bool within(double seconds, Done&& done) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  while (!done()) {
    if (std::chrono::steady_clock::now() > end) return false;
    ::usleep(2000);
  }
  return true;
}

TEST(DdsNames, AsRos2HasThem) {
  EXPECT_EQ(dds_topic("/scan"), "rt/scan");
  EXPECT_EQ(dds_topic("robot1/scan"), "rt/robot1/scan");
  EXPECT_EQ(dds_type("sensor_msgs/msg/LaserScan"), "sensor_msgs::msg::dds_::LaserScan_");
  for (const char* bad : {"", "/", "/scan/", "a//b", "sc an", "1scan", "~/scan"})
    EXPECT_THROW(dds_topic(bad), std::invalid_argument) << bad;
}

TEST(DdsNetwork, VariablesOfRos2) {
  std::map<std::string, std::string> set;
  const auto read = [&] {
    return network_of([&](const char* name) { return set.contains(name) ? set[name].c_str() : nullptr; });
  };
  EXPECT_EQ(read().domain, 0);
  EXPECT_EQ(read().reach, Reach::kSubnet);
  set["ROS_DOMAIN_ID"] = "42";
  set["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "OFF";
  EXPECT_EQ(read().domain, 42);
  EXPECT_EQ(read().reach, Reach::kOff);
  set["ROS_LOCALHOST_ONLY"] = "1";  // the older variable counts
  set["ROS_STATIC_PEERS"] = "10.0.0.2;;robot.local";
  EXPECT_EQ(read().reach, Reach::kLocalhost);
  EXPECT_EQ(read().peers, (std::vector<std::string>{"10.0.0.2", "robot.local"}));
  for (const auto& [name, bad] : std::map<std::string, std::string>{{"ROS_DOMAIN_ID", "-1"},
                                                                    {"ROS_DOMAIN_ID", "233"},
                                                                    {"ROS_LOCALHOST_ONLY", "yes"},
                                                                    {"ROS_STATIC_PEERS", "a\"/><b"},
                                                                    {"ROS_AUTOMATIC_DISCOVERY_RANGE", "near"}}) {
    std::map<std::string, std::string> before = set;
    set[name] = bad;
    try {
      read();
      ADD_FAILURE() << name << "=" << bad;
    } catch (const std::invalid_argument& error) {
      EXPECT_TRUE(std::string(error.what()).starts_with(name)) << error.what();
    }
    set = before;
  }
}

TEST(Dds, MessagesOfEveryTypeArriveAsTheyWere) {
  Participant host(localhost());
  ros2::for_each_topic_type([&]<class M>() {
    auto writer = host.writer<M>("/there", {true, true, 20});
    auto reader = host.reader<M>("/there", {true, true, 20});
    ASSERT_TRUE(within(10.0, [&] { return writer.readers() == 1 && reader.writers() == 1; })) << ros2::Message<M>::type;
    for (std::uint64_t seed = 1; seed <= 10; ++seed) writer.write(ros2::random_message<M>(seed));
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
      std::optional<M> got;
      ASSERT_TRUE(within(10.0, [&] { return (got = reader.take()).has_value(); }));
      EXPECT_EQ(ros2::encode(*got), ros2::encode(ros2::random_message<M>(seed)));
    }
    EXPECT_FALSE(reader.take());
  });
}

TEST(Dds, ALatecomerGetsTheMapAndNoOldScan) {
  Participant host(localhost(1));
  OccupancyGrid map;
  map.info.width = map.info.height = 1500;
  map.data.resize(1500 * 1500, 100);
  map.data[77] = -1;
  auto maps = host.writer<OccupancyGrid>("map", {true, true, 1});
  auto scans = host.writer<ros2::LaserScan>("scan", {false, false, 10});
  maps.write({});
  maps.write(map);
  scans.write(ros2::random_message<ros2::LaserScan>(1));
  auto late = host.reader<OccupancyGrid>("map", {true, true, 1});
  auto late_scans = host.reader<ros2::LaserScan>("scan", {false, false, 10});
  std::optional<OccupancyGrid> got;
  ASSERT_TRUE(within(10.0, [&] { return (got = late.take()).has_value(); }));
  EXPECT_EQ(got->data, map.data);
  ASSERT_TRUE(within(5.0, [&] { return late_scans.writers() == 1; }));
  EXPECT_FALSE(late_scans.take());
}

TEST(Dds, WhatDoesNotFitDoesNotMatch) {
  Participant host(localhost(2));
  auto scans = host.writer<ros2::LaserScan>("scan", {false, false, 10});
  auto asks_too_much = host.reader<ros2::LaserScan>("scan", {true, false, 10});
  auto fits = host.reader<ros2::LaserScan>("scan", {false, false, 10});
  ASSERT_TRUE(within(5.0, [&] { return fits.writers() == 1; }));
  EXPECT_EQ(asks_too_much.writers(), 0U);
  EXPECT_EQ(scans.readers(), 1U);
}

TEST(Dds, WaitingEndsWhenAMessageComes) {
  Participant host(localhost(3));
  auto writer = host.writer<ros2::String>("a", {});
  auto reader = host.reader<ros2::String>("a", {});
  const auto begin = std::chrono::steady_clock::now();
  host.wait(0.05);
  EXPECT_GE(std::chrono::steady_clock::now() - begin, std::chrono::milliseconds(40));
  writer.write({"x"});
  host.wait(60.0);
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(30));
  EXPECT_EQ(reader.take()->data, "x");
}

}  // namespace
}  // namespace phasescan::dds::participant_test
