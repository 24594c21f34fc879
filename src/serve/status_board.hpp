/// The run in numbers, for `/api/status`, the page and whoever watches over it.
#pragma once

#include <cstdint>
#include <deque>
#include <mutex>
#include <string>

#include "phasescan/live/live.hpp"
#include "serve/live_control.hpp"

namespace phasescan::serve {

struct LiveStatus {
  std::string source;             ///< what scans come from, for people
  std::string state = "waiting";  ///< waiting (no scan yet), stalled (none for 3 s), else the status of the last scan
  double uptime_s = 0.0;
  double age_s = 0.0;                             ///< since the last scan
  double rate_hz = 0.0;                           ///< of scans, over the last ones
  double latency_ms = 0.0, latency_p99_ms = 0.0;  ///< over the last 1000 scans
  std::uint64_t scans = 0, dropped = 0;
  std::uint64_t lost = 0;  ///< scans that were
  Stamp stamp = 0;
  Pose2 T_map_base;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  double confidence = 0.0;
  double path_m = 0.0;
  std::int64_t keyframes = 0;
  std::int64_t loops = 0;  ///< in the graph now
  std::uint64_t map_version = 0;
  bool known_map = false;                               ///< the map was there before the run, and does not grow
  std::size_t hypotheses = 0;                           ///< places in a known map where the robot may be
  std::deque<std::pair<double, std::string>> messages;  ///< the last ones: uptime and text
};

/// One object, one line.
std::string to_json(const LiveStatus& status, const ControlState& control);

/// Keeps count. Any thread may ask.
class StatusBoard final : public live::LiveSink {
 public:
  explicit StatusBoard(std::string source);
  void take(const live::LiveUpdate& update) override;
  /// What a person should know.
  void tell(const std::string& text);
  LiveStatus status() const;

 private:
  mutable std::mutex mutex_;
  LiveStatus status_;
  std::int64_t began_ns_ = 0, last_ns_ = 0;
  std::deque<std::int64_t> arrivals_ns_;
  std::deque<double> latencies_ms_;
};

}  // namespace phasescan::serve
