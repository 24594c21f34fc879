#include "live_output.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>

#include "commands.hpp"

namespace phasescan::app {
namespace {

constexpr Stamp kAgain_ns = 60'000'000'000;  // a warning of a kind that was told

std::string json_pose(const Pose2& pose) {
  return fmt::format(R"({{"x": {:.4f}, "y": {:.4f}, "theta": {:.5f}}})", pose.x, pose.y, pose.theta);
}

std::string json_hypotheses(const std::vector<PoseEstimate>& hypotheses) {
  std::string out;
  for (const PoseEstimate& at : hypotheses)
    out += fmt::format(R"({}{{"pose": {}, "confidence": {:.3f}}})", out.empty() ? "" : ", ", json_pose(at.T_map_base),
                       at.confidence);
  return out;
}

std::string json_line(const live::LiveUpdate& live) {
  const ScanUpdate& update = live.update;
  const Pose2 pose = update.T_map_base();
  // On a known map there is none until the robot is found.
  const bool nowhere = live.located && !live.located->T_map_base;
  std::string line = fmt::format(R"({{"stamp": {:.6f}, "status": "{}", "pose": {}, )", stamp_to_seconds(update.stamp),
                                 to_string(update.status), nowhere ? "null" : json_pose(pose));
  const Eigen::Matrix3d covariance = update.map_covariance.value_or(update.odom_covariance);
  line += "\"covariance\": [";
  for (int i = 0; i < 9; ++i) line += fmt::format("{}{:.6g}", i > 0 ? ", " : "", covariance(i / 3, i % 3));
  line += fmt::format("], \"confidence\": {:.3f}, \"latency_ms\": {:.2f}", live.confidence, live.latency_ms);
  if (live.located) line += ", \"hypotheses\": [" + json_hypotheses(live.located->hypotheses) + "]";
  return line + "}\n";
}

}  // namespace

LiveOutput::LiveOutput(bool json) : json_(json), terminal_(::isatty(STDERR_FILENO) != 0 && !json) {}

void LiveOutput::take(const live::LiveUpdate& update) {
  for (const std::string& text : update.warnings) warn(text, update.update.stamp);
  if (json_) {
    print(json_line(update));
    flush();
    return;
  }
  const Pose2 pose = update.update.T_map_base();
  const std::string status = to_string(update.update.status);
  if (terminal_) {
    std::fprintf(stderr, "\r%-12s x %7.2f m  y %7.2f m  heading %6.1f deg  %5.1f ms ", status.c_str(), pose.x, pose.y,
                 rad_to_deg(pose.theta), update.latency_ms);
  } else if (status != before_) {
    std::fprintf(stderr, "phasescan: %s\n", status.c_str());
  }
  before_ = status;
}

void LiveOutput::warn(const std::string& text, Stamp stamp) {
  const auto [at, first] = told_.try_emplace(text.substr(0, text.find(':')));
  Told& told = at->second;
  if (!first && stamp >= told.at && stamp - told.at < kAgain_ns) {  // a log that begins anew has stamps before
    ++told.held_back;
    return;
  }
  tell(told.held_back > 0 ? fmt::format("{} ({} more since)", text, told.held_back) : text);
  told = {stamp, 0};
}

void LiveOutput::tell(const std::string& text) const {
  std::fprintf(stderr, "%sphasescan: %s\n", terminal_ ? "\n" : "", text.c_str());
}

void LiveOutput::end() const {
  if (terminal_) std::fprintf(stderr, "\n");
}

}  // namespace phasescan::app
