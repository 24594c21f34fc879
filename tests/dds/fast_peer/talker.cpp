#include "dds/fast_peer/talker.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <thread>

namespace fast_peer {
namespace {

constexpr std::int64_t kEpoch = 1'700'000'000'000'000'000;  // added to the stamps of a log, which begin at 0

}  // namespace

Talker::Talker(Peer& peer, const Options& options) : peer_(peer), options_(options) {
  for (int i = 0; i < static_cast<int>(options.number("--publishers", 1)); ++i)
    scans_.push_back(peer.writer("rt/scan", "sensor_msgs::msg::dds_::LaserScan_", false, false));
  tf_ = peer.writer("rt/tf", "tf2_msgs::msg::dds_::TFMessage_", true, false);
  static_ = peer.writer("rt/tf_static", "tf2_msgs::msg::dds_::TFMessage_", true, true);
  if (!options.has("--no-mounting")) {
    Bytes bytes = tf_message(0, "base_link", "laser", {});
    static_->write(&bytes);
  }
  std::ifstream log(options.values.at("--scans"));
  for (std::string line; std::getline(log, line);) lines_.push_back(json::parse(line));
  const auto first = static_cast<std::size_t>(options.number("--first", 0));
  lines_.erase(lines_.begin(), lines_.begin() + static_cast<std::ptrdiff_t>(std::min(first, lines_.size())));
  if (const auto n = static_cast<std::size_t>(options.number("--count", 1e9)); n < lines_.size()) lines_.resize(n);
}

void Talker::say() {
  const json& line = lines_[next_];
  const auto stamp = static_cast<std::int64_t>(std::llround(line.value("stamp", 0.0) * 1e6)) * 1000 + kEpoch;
  if (options_.has("--odometry") && line.contains("odometry")) {
    const json& o = line["odometry"];
    Bytes bytes = tf_message(stamp, "odom", "base_link", {o["x"], o["y"], o["theta"]});
    tf_->write(&bytes);
  }
  for (fdds::DataWriter* writer : scans_) {
    Bytes bytes = scan_message(line, stamp);
    peer_.said(stamp);
    writer->write(&bytes);
  }
  ++next_;
}

Bytes Talker::scan_message(const json& line, std::int64_t stamp) const {
  std::vector<float> ranges;
  for (const json& range : line["ranges"]) ranges.push_back(range.is_number() ? range.get<float>() : std::nanf(""));
  const std::size_t beams = ranges.size();
  std::string frame = "laser";
  if (options_.has("--mangle") && next_ % 10 == 9) {
    const std::string& kind = options_.values.at("--mangle");
    if (kind == "nan") ranges.assign(beams, std::nanf(""));
    if (kind == "empty") ranges.clear();
    if (kind == "beams") ranges.resize(beams / 2);
    if (kind == "noframe") frame.clear();
    if (kind == "jump") stamp -= 60'000'000'000;
  }
  const auto first = line["angle_min"].get<float>(), step = line["angle_increment"].get<float>();
  return made([&](Cdr& cdr) {
    put_header(cdr, stamp, frame);
    cdr << first << first + step * static_cast<float>(beams - 1) << step << line.value("time_increment", 0.0F) << 0.0F
        << line.value("range_min", 0.0F) << line.value("range_max", 0.0F) << ranges << std::vector<float>{};
  });
}

void say_pose(Peer& peer, const std::string& text) {
  Planar pose;
  if (std::sscanf(text.c_str(), "%lf,%lf,%lf", &pose.x, &pose.y, &pose.theta) != 3) return;
  fdds::DataWriter* writer =
      peer.writer("rt/initialpose", "geometry_msgs::msg::dds_::PoseWithCovarianceStamped_", true, false);
  std::this_thread::sleep_for(std::chrono::seconds(1));  // volatile: who listens must be there
  Bytes bytes = made([&](Cdr& cdr) {
    put_header(cdr, 0, "map");
    put_pose(cdr, pose);
    std::array<double, 36> covariance{};
    covariance[0] = covariance[7] = covariance[35] = 0.1;
    cdr << covariance;
  });
  writer->write(&bytes);
}

}  // namespace fast_peer
