// A live run as a Foxglove client sees it: what it is sent, and when.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cstring>
#include <nlohmann/json.hpp>
#include <thread>

#include "foxglove/client.hpp"
#include "foxglove/endpoint.hpp"
#include "io/ros_encode.hpp"
#include "support/foxglove_frames.hpp"

namespace phasescan::foxglove::endpoint_test {
namespace {

using nlohmann::json;
using testing::advertise_pose;
using testing::bytes_of;
using ::testing::HasSubstr;
using testing::publish;

/// A client of the endpoint that takes all, or whose line is slow.
class FakePeer final : public serve::Peer {
 public:
  void send(serve::SharedBytes message, bool binary) override {
    if (binary) {
      frames.push_back(*message);
    } else {
      texts.push_back(json::parse(*message));
    }
  }
  std::size_t queued_bytes() const override { return queued; }
  void close(int, const std::string&) override {}
  std::vector<json> with_op(const std::string& op) const {
    std::vector<json> out;
    for (const json& text : texts)
      if (text["op"] == op) out.push_back(text);
    return out;
  }
  /// Payloads sent to a subscription.
  std::vector<std::string> payloads(std::uint32_t subscription) const {
    std::vector<std::string> out;
    for (const std::string& frame : frames) {
      std::uint32_t to = 0;
      if (frame[0] != 1) continue;
      std::memcpy(&to, frame.data() + 1, 4);
      if (to == subscription) out.push_back(frame.substr(13));
    }
    return out;
  }

  std::vector<json> texts;
  std::vector<std::string> frames;
  std::size_t queued = 0;
};

class ToyMap final : public MapSnapshot {
 public:
  explicit ToyMap(int width = 2, int height = 1) : width_(width), height_(height) {}
  std::uint64_t version() const override { return 1; }
  const Pose2& T_map_odom() const override { return pose_; }
  std::vector<MapKeyframe> keyframes() const override { return {{{1, 2, 0.5}, 0, 0}}; }
  TrinaryMap draw() const override {
    TrinaryMap map;
    map.width = width_, map.height = height_;
    map.cells.assign(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_), CellState::kFree);
    map.cells.back() = CellState::kOccupied;
    return map;
  }

 private:
  int width_, height_;
  Pose2 pose_;
};

live::LiveUpdate update_at(Stamp stamp) {
  auto measurement = std::make_shared<RangeMeasurement>();
  measurement->scan = make_scan(std::vector<float>{1.0F, 2.0F, 0.0F}, {-1.0, 0.5, 0.1, 6.0});
  measurement->scan.stamp = stamp;
  measurement->laser = "ld06";
  live::LiveUpdate update;
  update.update.stamp = stamp;
  update.update.status = TrackingStatus::kOk;
  update.measurement = measurement;
  update.map = std::make_shared<ToyMap>();
  return update;
}

std::uint32_t channel_of(const FakePeer& peer, const std::string& topic) {
  for (const json& text : peer.with_op("advertise")) {
    for (const json& channel : text["channels"])
      if (channel["topic"] == topic) return channel["id"];
  }
  return 0;
}

void say(Endpoint& endpoint, const std::shared_ptr<FakePeer>& peer, const json& message) {
  endpoint.on_message(peer, message.dump(), false);
}

json subscribe(std::uint32_t id, std::uint32_t channel) {
  return {{"op", "subscribe"}, {"subscriptions", {{{"id", id}, {"channelId", channel}}}}};
}

TEST(FoxgloveEndpoint, SaysWhoItIsAndWhatThereIs) {
  Endpoint endpoint([](const Pose2&, const auto&) {});
  EXPECT_THAT(endpoint.subprotocols(), ::testing::ElementsAre("foxglove.sdk.v1", "foxglove.websocket.v1"));
  EXPECT_TRUE(endpoint.allows_origin("https://app.foxglove.dev"));
  EXPECT_FALSE(endpoint.allows_origin("https://app.foxglove.dev.evil.org"));
  const auto peer = std::make_shared<FakePeer>();
  endpoint.on_open(peer, "foxglove.sdk.v1");
  ASSERT_EQ(peer->texts.size(), 2U);
  EXPECT_EQ(peer->texts[0]["op"], "serverInfo");
  EXPECT_THAT(peer->texts[0]["capabilities"].dump(), HasSubstr("clientPublish"));
  ASSERT_EQ(peer->texts[1]["op"], "advertise");
  for (const json& channel : peer->texts[1]["channels"]) {
    EXPECT_EQ(channel["encoding"], "cdr");
    EXPECT_EQ(channel["schemaEncoding"], "ros2msg");
    EXPECT_GT(channel["schema"].get<std::string>().size(), 5U);
  }
  for (const char* topic : {"/scan", "/map", "/tf", "/tf_static", "/path", "/pose", "/status", "/diagnostics"})
    EXPECT_GT(channel_of(*peer, topic), 0U) << topic;
}

TEST(FoxgloveEndpoint, SendsWhatIsSubscribedAndWhatStays) {
  Endpoint endpoint([](const Pose2&, const auto&) {});
  endpoint.take(update_at(1'000'000'000));
  const auto peer = std::make_shared<FakePeer>();
  endpoint.on_open(peer, "");
  say(endpoint, peer, subscribe(10, channel_of(*peer, "/scan")));
  say(endpoint, peer, subscribe(11, channel_of(*peer, "/tf_static")));
  say(endpoint, peer, subscribe(12, channel_of(*peer, "/map")));
  EXPECT_EQ(peer->payloads(11).size(), 1U);  // was sent before it came
  EXPECT_TRUE(peer->payloads(10).empty());
  endpoint.take(update_at(2'000'000'000));
  const std::vector<std::string> scans = peer->payloads(10);
  ASSERT_EQ(scans.size(), 1U);
  ros::LaserScan scan;
  ros::decode(ros::Wire::kCdr, bytes_of(scans[0]), scan);
  EXPECT_EQ(scan.header.stamp, 2'000'000'000);
  EXPECT_EQ(scan.header.frame_id, "laser");
  EXPECT_EQ(scan.ranges.size(), 3U);
  std::uint64_t time = 0;
  ASSERT_EQ(peer->frames[1][0], 2);
  std::memcpy(&time, peer->frames[1].data() + 1, 8);
  EXPECT_EQ(time, 2'000'000'000U);
  for (int i = 0; i < 200 && peer->payloads(12).empty(); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    const std::size_t before = peer->frames.size();
    endpoint.take(update_at(3'000'000'000 + i));  // takes the lock: what the drawing thread sent is seen
    EXPECT_GE(peer->frames.size(), before);
  }
  EXPECT_FALSE(peer->payloads(12).empty());
  endpoint.on_close(peer);
  const std::size_t before = peer->frames.size();
  endpoint.take(update_at(9'000'000'000));
  EXPECT_EQ(peer->frames.size(), before);
}

TEST(FoxgloveEndpoint, AMapThatIsTooLargeForAClientComesCoarser) {
  Endpoint endpoint([](const Pose2&, const auto&) {});
  const auto peer = std::make_shared<FakePeer>();
  endpoint.on_open(peer, "");
  say(endpoint, peer, subscribe(1, channel_of(*peer, "/map")));
  live::LiveUpdate update = update_at(1'000'000'000);
  update.map = std::make_shared<ToyMap>(2001, 1501);  // of 5 cm: sent with 10 cm
  for (int i = 0; i < 400 && peer->payloads(1).empty(); ++i) {
    endpoint.take(update);
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  const std::vector<std::string> maps = peer->payloads(1);
  ASSERT_FALSE(maps.empty());
  const std::size_t cells = 1001 * 751;
  EXPECT_GT(maps[0].size(), cells);
  EXPECT_LT(maps[0].size(), cells + 200);
  EXPECT_EQ(maps[0].back(), 100);  // the wall stays
  EXPECT_EQ(maps[0][maps[0].size() - 2], 0);
}

TEST(FoxgloveEndpoint, ASlowClientLacksScansAndCatchesUpWithWhatStays) {
  Endpoint endpoint([](const Pose2&, const auto&) {});
  const auto peer = std::make_shared<FakePeer>();
  endpoint.on_open(peer, "");
  say(endpoint, peer, subscribe(1, channel_of(*peer, "/scan")));
  say(endpoint, peer, subscribe(2, channel_of(*peer, "/status")));
  peer->queued = 10'000'000;
  for (int i = 1; i <= 5; ++i) endpoint.take(update_at(i * 1'000'000'000LL));
  EXPECT_TRUE(peer->frames.empty());
  peer->queued = 0;
  endpoint.on_drained(peer);
  EXPECT_TRUE(peer->payloads(1).empty());
  EXPECT_EQ(peer->payloads(2).size(), 1U);
  endpoint.on_drained(peer);
  EXPECT_EQ(peer->payloads(2).size(), 1U);
}

TEST(FoxgloveEndpoint, HandsAPoseOnAndTellsWhatBecameOfIt) {
  std::optional<Pose2> given;
  Endpoint endpoint([&](const Pose2& pose, const auto& done) {
    given = pose;
    done(false, "there is no map to stand on");
  });
  const auto peer = std::make_shared<FakePeer>();
  endpoint.on_open(peer, "");
  endpoint.on_message(peer, advertise_pose("cdr"), false);
  ByteWriter cdr;
  ros::encode(ros::PoseEstimate{{0, "map"}, {1, 2, 0.5}, Eigen::Matrix3d::Identity()}, cdr);
  endpoint.on_message(peer, publish(7, cdr.bytes()), true);
  ASSERT_TRUE(given);
  EXPECT_NEAR(given->theta, 0.5, 1e-12);
  ASSERT_EQ(peer->with_op("status").size(), 1U);
  EXPECT_EQ(peer->with_op("status")[0]["level"], 1);
  EXPECT_EQ(peer->with_op("status")[0]["message"], "there is no map to stand on");
}

}  // namespace
}  // namespace phasescan::foxglove::endpoint_test
