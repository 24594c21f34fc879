// The Foxglove protocol over values: what a client may say.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>

#include "foxglove/client.hpp"
#include "io/ros_encode.hpp"
#include "support/foxglove_frames.hpp"

namespace phasescan::foxglove::client_test {
namespace {

using nlohmann::json;
using testing::advertise_pose;
using testing::bytes_of;
using ::testing::HasSubstr;
using testing::publish;

json subscribe(std::uint32_t id, std::uint32_t channel) {
  return {{"op", "subscribe"}, {"subscriptions", {{{"id", id}, {"channelId", channel}}}}};
}

TEST(FoxgloveClient, TakesItsSubscriptionsAndNamesWhatIsWrongWithThem) {
  Client client;
  const Outcome good = client.take_text(subscribe(0, 3).dump(), 8);
  EXPECT_TRUE(good.statuses.empty());
  EXPECT_THAT(good.subscribed, ::testing::ElementsAre(std::pair(0U, 3U)));
  EXPECT_THAT(client.take_text(subscribe(0, 4).dump(), 8).statuses.at(0).second, HasSubstr("there already"));
  EXPECT_THAT(client.take_text(subscribe(1, 9).dump(), 8).statuses.at(0).second, HasSubstr("not available"));
  EXPECT_THAT(client.take_text(subscribe(1, 0).dump(), 8).statuses.at(0).second, HasSubstr("not available"));
  int to_three = 0;
  client.each_subscription(3, [&](std::uint32_t) { ++to_three; });
  EXPECT_EQ(to_three, 1);
  EXPECT_TRUE(client.take_text(R"({"op":"unsubscribe","subscriptionIds":[0]})", 8).statuses.empty());
  EXPECT_EQ(client.subscriptions(), 0U);
  EXPECT_EQ(client.take_text(R"({"op":"unsubscribe","subscriptionIds":[0]})", 8).statuses.size(), 1U);
}

TEST(FoxgloveClient, WhatIsNoneOfTheProtocolIsAStatusNotAThrow) {
  for (const std::string& frame :
       {std::string(""), std::string("no"), std::string("[]"), std::string("3"), std::string("{}"),
        std::string(R"({"op":5})"), std::string(R"({"op":"dance"})"), std::string(R"({"op":"subscribe"})"),
        std::string(R"({"op":"subscribe","subscriptions":3})"),
        std::string(R"({"op":"subscribe","subscriptions":[{"id":-1,"channelId":1}]})"),
        std::string(R"({"op":"subscribe","subscriptions":[{"id":4294967296,"channelId":1}]})"),
        std::string(R"({"op":"subscribe","subscriptions":[{"id":1.5,"channelId":1}]})"),
        std::string(R"({"op":"unsubscribe","subscriptionIds":["a"]})"),
        std::string(R"({"op":"advertise","channels":[{"id":1}]})"), std::string(100'000, '['),
        R"({"op":"subscribe","subscriptions":)" + std::string(5000, '[')}) {
    Client client;
    const Outcome outcome = client.take_text(frame, 8);
    ASSERT_EQ(outcome.statuses.size(), 1U) << frame.substr(0, 80);
    EXPECT_EQ(outcome.statuses[0].first, StatusLevel::kError);
    EXPECT_LT(outcome.statuses[0].second.size(), 200U);
    EXPECT_EQ(client.subscriptions(), 0U);
  }
  json many{{"op", "subscribe"}, {"subscriptions", json::array()}};
  for (int i = 0; i < 257; ++i) many["subscriptions"].push_back({{"id", i}, {"channelId", 1}});
  Client client;
  EXPECT_THAT(client.take_text(many.dump(), 8).statuses.at(0).second, HasSubstr("256"));
  EXPECT_EQ(client.take_text(R"({"op":"getParameters","parameterNames":[]})", 8).statuses.at(0).first,
            StatusLevel::kWarning);
  for (const std::string& frame : {std::string(), std::string("\x01\x02"), std::string("\x07zzzzzzz"), publish(9, {})})
    EXPECT_EQ(client.take_binary(bytes_of(frame)).statuses.size(), 1U);
}

TEST(FoxgloveClient, APoseEstimateComesAsCdrAndAsJson) {
  ros::PoseEstimate said{{5, "map"}, {1.5, -2.5, 2.0}, Eigen::Matrix3d::Identity()};
  said.covariance(0, 2) = said.covariance(2, 0) = 0.25;
  ByteWriter cdr;
  ros::encode(said, cdr);
  Client client;
  ASSERT_TRUE(client.take_text(advertise_pose("cdr"), 8).statuses.empty());
  const Outcome by_cdr = client.take_binary(bytes_of(publish(7, cdr.bytes())));
  ASSERT_TRUE(by_cdr.pose) << by_cdr.statuses.at(0).second;
  EXPECT_NEAR(by_cdr.pose->pose.x, 1.5, 1e-12);
  EXPECT_NEAR(by_cdr.pose->pose.y, -2.5, 1e-12);
  EXPECT_NEAR(by_cdr.pose->pose.theta, 2.0, 1e-12);
  EXPECT_EQ(by_cdr.pose->covariance, said.covariance);
  json message{{"header", {{"frame_id", "map"}}},
               {"pose",
                {{"pose",
                  {{"position", {{"x", 1.5}, {"y", -2.5}, {"z", 0}}},
                   {"orientation", {{"x", 0}, {"y", 0}, {"z", std::sin(1.0)}, {"w", std::cos(1.0)}}}}},
                 {"covariance", std::vector<double>(36, 0.0)}}}};
  message["pose"]["covariance"][35] = 0.5;
  Client other;
  ASSERT_TRUE(other.take_text(advertise_pose("json", "geometry_msgs/PoseWithCovarianceStamped"), 8).statuses.empty());
  const Outcome by_json = other.take_binary(bytes_of(publish(7, bytes_of(message.dump()))));
  ASSERT_TRUE(by_json.pose);
  EXPECT_NEAR(by_json.pose->pose.theta, 2.0, 1e-12);
  EXPECT_EQ(by_json.pose->covariance(2, 2), 0.5);
}

TEST(FoxgloveClient, APoseThatIsNoneIsRefused) {
  Client client;
  EXPECT_THAT(client.take_text(advertise_pose("protobuf"), 8).statuses.at(0).second, HasSubstr("expected"));
  EXPECT_THAT(client.take_text(advertise_pose("cdr", "geometry_msgs/msg/Pose"), 8).statuses.at(0).second,
              HasSubstr("expected"));
  ASSERT_TRUE(client.take_text(advertise_pose("json"), 8).statuses.empty());
  for (const char* text : {"", "3", "{}", R"({"pose":{"pose":{"position":{"x":"a","y":1}}}})"})
    EXPECT_EQ(client.take_binary(bytes_of(publish(7, bytes_of(text)))).statuses.size(), 1U) << text;
  Client by_cdr;
  ASSERT_TRUE(by_cdr.take_text(advertise_pose("cdr"), 8).statuses.empty());
  for (const auto& [frame, pose] : {std::pair<std::string, Pose2>{"odom", {1, 2, 3}}, {"map", {NAN, 0, 0}}}) {
    ByteWriter cdr;
    ros::encode(ros::PoseEstimate{{0, frame}, pose, Eigen::Matrix3d::Identity()}, cdr);
    const Outcome outcome = by_cdr.take_binary(bytes_of(publish(7, cdr.bytes())));
    EXPECT_FALSE(outcome.pose);
    EXPECT_EQ(outcome.statuses.size(), 1U);
  }
  // Goals and clicked points are published by applications, too: no word about them.
  const json goal{{"op", "advertise"},
                  {"channels", {{{"id", 8}, {"topic", "/goal_pose"}, {"encoding", "cdr"}, {"schemaName", "x"}}}}};
  EXPECT_TRUE(by_cdr.take_text(goal.dump(), 8).statuses.empty());
  EXPECT_TRUE(by_cdr.take_binary(bytes_of(publish(8, bytes_of("any")))).statuses.empty());
}

}  // namespace
}  // namespace phasescan::foxglove::client_test
