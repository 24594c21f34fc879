#include "serve/status_board.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <vector>

#include "live/clocks.hpp"

namespace phasescan::serve {
namespace {

constexpr double kStalledS = 3.0;
constexpr std::size_t kMessages = 50;
constexpr std::size_t kLatencies = 1000;
constexpr std::int64_t kRateNs = 3'000'000'000;

double seconds(std::int64_t ns) {
  return 1e-9 * static_cast<double>(ns);
}

double rounded(double value, double step) {
  return std::isfinite(value) ? std::round(value / step) * step : 0.0;
}

}  // namespace

StatusBoard::StatusBoard(std::string source) : began_ns_(live::steady_ns()) {
  status_.source = std::move(source);
}

void StatusBoard::take(const live::LiveUpdate& live) {
  const ScanUpdate& update = live.update;
  const std::int64_t now = live::steady_ns();
  const std::lock_guard lock(mutex_);
  const Pose2 pose = update.T_map_base();
  if (live.restarted) {
    status_.scans = status_.lost = 0;
    status_.path_m = 0.0;
    status_.keyframes = status_.loops = 0;
  }
  if (status_.scans > 0 && live.has_pose()) {
    const double step = translation_distance(status_.T_map_base, pose);
    if (step < 1.0) status_.path_m += step;  // farther is a correction by the map
  }
  status_.known_map = live.located.has_value();
  status_.hypotheses = live.located ? live.located->hypotheses.size() : 0;
  last_ns_ = now;
  ++status_.scans;
  status_.dropped = live.dropped;
  status_.state = to_string(update.status);
  status_.lost += update.status == TrackingStatus::kLost ? 1 : 0;
  status_.stamp = update.stamp;
  status_.T_map_base = pose;
  status_.covariance = update.map_covariance.value_or(update.odom_covariance);
  status_.confidence = live.confidence;
  status_.latency_ms = live.latency_ms;
  status_.map_version = update.map_version;
  if (update.keyframe) status_.keyframes = *update.keyframe + 1;
  for (const live::LiveLoop& loop : live.loops) status_.loops += loop.accepted ? 1 : -1;
  arrivals_ns_.push_back(now);
  while (now - arrivals_ns_.front() > kRateNs) arrivals_ns_.pop_front();
  latencies_ms_.push_back(live.latency_ms);
  if (latencies_ms_.size() > kLatencies) latencies_ms_.pop_front();
  const double uptime_s = seconds(now - began_ns_);
  for (const std::string& warning : live.warnings) status_.messages.emplace_back(uptime_s, warning);
  while (status_.messages.size() > kMessages) status_.messages.pop_front();
}

void StatusBoard::tell(const std::string& text) {
  const std::lock_guard lock(mutex_);
  status_.messages.emplace_back(seconds(live::steady_ns() - began_ns_), text);
  if (status_.messages.size() > kMessages) status_.messages.pop_front();
}

LiveStatus StatusBoard::status() const {
  const std::int64_t now = live::steady_ns();
  const std::lock_guard lock(mutex_);
  LiveStatus out = status_;
  out.uptime_s = seconds(now - began_ns_);
  out.age_s = seconds(now - (last_ns_ > 0 ? last_ns_ : began_ns_));
  if (out.age_s > kStalledS) out.state = out.scans > 0 ? "stalled" : "waiting";
  const auto recent =
      std::count_if(arrivals_ns_.begin(), arrivals_ns_.end(), [&](std::int64_t ns) { return now - ns <= kRateNs; });
  if (recent > 1)
    out.rate_hz = static_cast<double>(recent - 1) /
                  seconds(arrivals_ns_.back() - arrivals_ns_[arrivals_ns_.size() - static_cast<std::size_t>(recent)]);
  if (!latencies_ms_.empty()) {
    std::vector<double> sorted(latencies_ms_.begin(), latencies_ms_.end());
    const auto at = sorted.begin() + static_cast<std::ptrdiff_t>(0.99 * static_cast<double>(sorted.size() - 1));
    std::nth_element(sorted.begin(), at, sorted.end());
    out.latency_p99_ms = *at;
  }
  return out;
}

std::string to_json(const LiveStatus& status, const ControlState& control) {
  nlohmann::ordered_json json;
  json["state"] = status.state;
  json["source"] = status.source;
  json["uptime_s"] = rounded(status.uptime_s, 0.001);
  json["age_s"] = rounded(status.age_s, 0.001);
  json["scans"] = status.scans;
  json["dropped"] = status.dropped;
  json["lost"] = status.lost;
  json["rate_hz"] = rounded(status.rate_hz, 0.01);
  json["latency_ms"] = rounded(status.latency_ms, 0.01);
  json["latency_p99_ms"] = rounded(status.latency_p99_ms, 0.01);
  json["stamp"] = stamp_to_seconds(status.stamp);
  json["pose"] = {{"x", status.T_map_base.x}, {"y", status.T_map_base.y}, {"theta", status.T_map_base.theta}};
  json["covariance"] = std::vector<double>(status.covariance.data(), status.covariance.data() + 9);
  json["confidence"] = rounded(status.confidence, 0.001);
  json["path_m"] = rounded(status.path_m, 0.001);
  json["keyframes"] = status.keyframes;
  json["loops"] = status.loops;
  json["map_version"] = status.map_version;
  json["known_map"] = status.known_map;
  json["hypotheses"] = status.hypotheses;
  json["can"] = {{"set_pose", control.can_set_pose}, {"save", control.can_save}, {"record", control.can_record}};
  json["recording"] = control.recording;
  if (control.replay)
    json["replay"] = {{"time_s", rounded(control.replay->time_s, 0.001)},
                      {"duration_s", rounded(control.replay->duration_s, 0.001)},
                      {"speed", control.replay->speed}};
  json["messages"] = nlohmann::ordered_json::array();
  for (const auto& [uptime_s, text] : status.messages)
    json["messages"].push_back({{"uptime_s", rounded(uptime_s, 0.001)}, {"text", text}});
  return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

}  // namespace phasescan::serve
