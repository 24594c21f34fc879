/// Looks at scan messages one by one, before anything else: which are no scan, which contradict those before, and where
/// the clock went back.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "io/ros_scan.hpp"
#include "phasescan/scan/scan.hpp"
#include "ros2/diagnostics.hpp"

namespace phasescan::ros2 {

/// What became of a message.
struct GatedScan {
  std::optional<Scan> scan;  ///< empty: it cannot be used
  std::string frame;         ///< of the laser
  Stamp stamp = 0;
  bool clock_jumped_back = false;  ///< all that came before is of another run of the clock
};

class ScanGate {
 public:
  /// Stamps that go back by more are a clock that was set back, less is a message that came late [s].
  static constexpr double kJump_s = 1.0;

  /// @param topic  one driver is expected on it
  /// @param now    the node's clock, for messages without a stamp and for the diagnostics
  GatedScan take(const std::string& topic, const LaserScan& message, Stamp now, Diagnostics& diagnostics);

  /// Nothing that came before matters any more.
  void forget() { topics_.clear(); }

 private:
  struct Topic {
    ros::ScanReading reading;
    Stamp last = 0;
    std::string frame;
    std::size_t beams = 0;
    bool started = false;
  };
  bool is_usable(const std::string& topic, const LaserScan& message, Stamp now, Diagnostics& diagnostics) const;

  std::map<std::string, Topic> topics_;
};

}  // namespace phasescan::ros2
