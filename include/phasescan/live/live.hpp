/// A sensor plugged in, to poses as they come: ports, threads, reconnecting. This part of the library starts threads
/// and looks at the clock; what lies below it does neither.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "phasescan/live/decoder.hpp"
#include "phasescan/scan/scan.hpp"
#include "phasescan/slam/slam.hpp"

namespace phasescan::live {

/// A scan on its way, and when it was whole: by the steady clock [ns].
struct LiveScan {
  RangeMeasurement measurement;
  std::int64_t arrived_ns = 0;
};

/// Where scans come from. Runs in a thread of its own.
class LiveSource {
 public:
  virtual ~LiveSource() = default;
  /// Hands out scans until `stop` says so or there are no more. `tell` takes what people should know, a line each.
  /// @throws SystemError, InputError where it cannot begin
  virtual void run(const std::function<bool()>& stop, const std::function<void(LiveScan)>& hand,
                   const std::function<void(const std::string&)>& tell) = 0;
};

/// A sensor at a port: "auto", a device, "tcp:HOST:PORT", "udp:HOST:PORT", or a file that `raw` wrote.
/// Unplugged, it waits and goes on. @param sensor  empty: found by asking and listening
/// @param raw  file for the bytes as they come; empty: none
/// @throws SystemError with one line that says what to do, std::invalid_argument for a name that is none
std::unique_ptr<LiveSource> open_sensor(const std::string& port, const std::string& sensor, const std::string& raw);

/// What one scan brought, and how long that took.
struct LiveUpdate {
  ScanUpdate update;
  std::shared_ptr<const RangeMeasurement> measurement;  ///< that it came of; never null
  std::shared_ptr<const MapSnapshot> map;               ///< as it was then; never null
  double confidence = 0.0;    ///< 0..1: share of the hits that the map explains; 0 where the scan was not matched
  double latency_ms = 0.0;    ///< from the last byte of the scan to this
  std::uint64_t dropped = 0;  ///< scans so far that came faster than they were used
};

/// What came to pass in all.
struct LiveSummary {
  std::uint64_t scans = 0, dropped = 0;
  double worst_latency_ms = 0.0;
};

/// Source, SLAM and `sink`, each in its own thread with a bounded queue between them: where one is too slow the oldest
/// scan is left out and counted. Returns when the source ends or `stop` says so, all threads joined and every scan that
/// was in a queue done.
/// @param between  by the thread of SLAM where no scan waits: may read the run, as Slam::checkpoint does. What it takes
/// longer than to the next scan makes that one late. Empty: nothing
/// @throws what the source throws
LiveSummary run_live(LiveSource& source, Slam& slam, const std::function<bool()>& stop,
                     const std::function<void(const LiveUpdate&)>& sink,
                     const std::function<void(const std::string&)>& tell,
                     const std::function<void(Slam&)>& between = {});

}  // namespace phasescan::live
