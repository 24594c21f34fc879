// Sources of `live` that need no sensor: a log at its pace, and a simulated drive.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "phasescan/io/log.hpp"
#include "phasescan/live/live.hpp"
#include "serve/live_control.hpp"

namespace phasescan::app {

/// A log at its pace, or at another. Any thread may steer it.
class ReplaySource : public live::LiveSource {
 public:
  virtual void set_speed(double speed) = 0;
  /// Goes to a share of its time, 0..1, through all scans before: without them there is no map. False where a log
  /// cannot be read twice, or its end is not known yet.
  virtual bool seek(double share) = 0;
  virtual serve::ReplayState state() const = 0;
  /// At its end it waits as long as this says that somebody watches.
  virtual void set_watched(std::function<bool()> watched) = 0;
};

/// @throws as open_log
std::unique_ptr<ReplaySource> replay_source(const std::string& log, const LogOptions& options);
/// A sensor at a port, its scans cut down as the options say (ranges, masks). @param sensor  a name, or a file that
/// `calibrate` wrote, whose range limits hold then; the sensor is found by asking. @throws as live::open_sensor,
/// InputError
std::unique_ptr<live::LiveSource> sensor_source(const std::string& port, const std::string& sensor,
                                                const std::string& raw, LogOptions options);
/// A robot in a simulated flat.
std::unique_ptr<live::LiveSource> demo_source(std::uint64_t seed);

}  // namespace phasescan::app
