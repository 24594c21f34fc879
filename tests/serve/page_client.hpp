// A client of /ws as docs/live.md has it, and a run that does what it is asked: what tests of the viewer share.
#pragma once

#include <gtest/gtest.h>

#include <cstring>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "phasescan/core/pose2.hpp"
#include "serve/endpoint.hpp"
#include "serve/live_control.hpp"
#include "serve/live_map.hpp"

namespace phasescan::serve {

template <class T>
inline T value_at(const std::string& bytes, std::size_t at) {
  T value{};
  if (at + sizeof(T) > bytes.size()) throw std::out_of_range("a frame is cut off");
  std::memcpy(&value, bytes.data() + at, sizeof(T));
  return value;
}

/// Understands frames as docs/live.md has them, independently of who makes them.
class Page final : public Peer {
 public:
  void send(SharedBytes message, bool binary) override {
    bytes += message->size();
    if (!binary) return texts.push_back(nlohmann::json::parse(*message));
    const std::string& m = *message;
    switch (m.at(0)) {
      case 1:
        return take_scan(m);
      case 2:
        return take_tiles(m);
      case 3:
        return take_path(m);
      case 4:
        return take_loops(m);
      case 5:
        return take_hypotheses(m);
      default:
        throw std::runtime_error("an unknown frame");
    }
  }
  std::size_t queued_bytes() const override { return busy ? 1 << 20 : 0; }
  void close(int, const std::string&) override {}

  bool busy = false;
  std::size_t bytes = 0;
  std::vector<nlohmann::json> texts;
  int scans = 0, status = -1;
  Pose2 pose;
  std::vector<std::pair<double, double>> hits;
  std::map<TileIndex, std::vector<int>> tiles;  // levels of 64 x 64 cells
  std::vector<std::pair<float, float>> path;
  std::vector<std::pair<int, int>> loops;
  std::vector<Pose2> hypotheses;

 private:
  void take_scan(const std::string& m) {
    ++scans;
    status = static_cast<unsigned char>(m.at(1));
    const auto n = value_at<std::uint32_t>(m, 4);
    pose = {value_at<float>(m, 16), value_at<float>(m, 20), value_at<float>(m, 24)};
    const double unit = value_at<float>(m, 52);
    hits.clear();
    for (std::uint32_t i = 0; i < n; ++i)
      hits.emplace_back(unit * value_at<std::int16_t>(m, 56 + 4 * i), unit * value_at<std::int16_t>(m, 58 + 4 * i));
    EXPECT_EQ(m.size(), 56U + 4 * n);
  }
  void take_tiles(const std::string& m) {
    for (std::size_t at = 8; at < m.size();) {
      const TileIndex index{value_at<std::int32_t>(m, at), value_at<std::int32_t>(m, at + 4)};
      const auto size = value_at<std::uint32_t>(m, at + 8);
      std::vector<int> levels;
      for (std::size_t i = at + 12; i < at + 12 + size; ++i) {
        const auto byte = static_cast<unsigned char>(m.at(i));
        levels.insert(levels.end(), static_cast<std::size_t>(byte % 16 + 1), byte / 16);
      }
      EXPECT_TRUE(levels.empty() || levels.size() == 4096U) << levels.size();
      tiles[index] = levels;
      at += 12 + size;
    }
  }
  void take_path(const std::string& m) {
    path.resize(value_at<std::uint32_t>(m, 4));
    for (std::size_t at = 8; at < m.size(); at += 8)
      path.emplace_back(value_at<float>(m, at), value_at<float>(m, at + 4));
  }
  void take_loops(const std::string& m) {
    loops.clear();
    for (std::size_t at = 4; at < m.size(); at += 8)
      loops.emplace_back(value_at<std::int32_t>(m, at), value_at<std::int32_t>(m, at + 4));
  }
  void take_hypotheses(const std::string& m) {
    hypotheses.clear();
    for (std::size_t at = 4; at < m.size(); at += 16)
      hypotheses.push_back({value_at<float>(m, at), value_at<float>(m, at + 4), value_at<float>(m, at + 8)});
  }
};

/// Says yes and remembers.
class Obedient final : public LiveControl {
 public:
  ControlState state() const override { return {true, true, true, "", std::nullopt}; }
  void set_pose(const Pose2& pose, CommandDone done) override { did("set_pose " + std::to_string(pose.x), done); }
  void relocalise(CommandDone done) override { did("relocalise", done); }
  void start_recording(const std::string& name, CommandDone done) override { did("record " + name, done); }
  void stop_recording(CommandDone done) override { did("stop", done); }
  void save(const std::string& name, CommandDone done) override { did("save " + name, done); }
  void replay_speed(double speed, CommandDone done) override { did("speed " + std::to_string(speed), done); }
  void replay_seek(double share, CommandDone done) override { did("seek " + std::to_string(share), done); }
  std::vector<std::string> done_;

 private:
  void did(const std::string& what, const CommandDone& done) {
    done_.push_back(what);
    done(true, "done");
  }
};

}  // namespace phasescan::serve
