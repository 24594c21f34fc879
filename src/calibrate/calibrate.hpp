/// What a lidar does, measured on any log in which it stands still now and then.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "calibrate/dropout_fit.hpp"
#include "calibrate/edge_fit.hpp"
#include "calibrate/noise_fit.hpp"
#include "calibrate/standstill_table.hpp"
#include "calibrate/timing_fit.hpp"
#include "phasescan/io/log.hpp"
#include "sim/lidar.hpp"

namespace phasescan {

/// A sensor as measured, with what it was measured on.
struct Calibration {
  sim::LidarOptions sensor;  ///< what could not be measured has the defaults
  std::size_t scans = 0;     ///< of the log
  std::size_t stops = 0, stop_scans = 0;
  bool by_wheels = false;  ///< stops are where the wheels rest; else where scans agree
  NoiseFit noise;
  DropoutFit dropout;
  EdgeFit edges;
  TimingFit timing;
  std::size_t sectors = 0;  ///< scans of stops that lack a sector
  StandstillTable table;
};

/// Takes a log scan by scan and keeps its stops.
class Calibrator {
 public:
  /// Scans of one laser: those of another than the first one's are left out and counted.
  void add(const LogEntry& entry);
  std::size_t scans() const { return stamps_.size(); }
  std::size_t of_other_lasers() const { return other_lasers_; }

  /// The sensor; nothing where there is no stop, or none that 40 beams on smooth surface say something about.
  /// @cost a few passes over the scans of all stops
  std::optional<Calibration> finish();

 private:
  void keep(std::optional<Stop> stop, std::vector<StopBeams>& stops);

  StopFinder by_wheels_, by_scans_;
  std::vector<StopBeams> stops_by_wheels_, stops_by_scans_;
  std::size_t kept_ = 0;  ///< ranges kept
  std::vector<Stamp> stamps_;
  std::optional<std::string> laser_;
  std::size_t other_lasers_ = 0, with_odometry_ = 0;
  std::optional<Scan> example_;                  ///< a scan with hits: geometry
  double range_least_ = 0.0, range_most_ = 0.0;  ///< of all hits
  std::vector<float> sample_;                    ///< of ranges, for their grain
};

/// The largest grain (0.25 mm to 5 cm) that all but 1 % of the ranges are multiples of; 0 without one.
double range_grain(const std::vector<float>& ranges);
/// The largest grain (0.01 to 1 deg) of which all directions are multiples, where they are unevenly spaced; else 0.
double bearing_grain_deg(const std::vector<float>& angles);

/// The sensor file: what stands in `sensor`, with a heading that says what it was measured on.
/// @param log  what to call the log there
std::string format_sensor_file(const Calibration& calibration, std::string_view log);

/// What was measured, in lines for people.
std::string format_calibration(const Calibration& calibration);

}  // namespace phasescan
