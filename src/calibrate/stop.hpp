/// Stops of a robot in a log: scans of one place, beam by beam.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "phasescan/io/log.hpp"

namespace phasescan {

/// Scans taken from one place, on one grid of bearings. Missing beams are NaN.
struct Stop {
  double angle_min = 0.0;
  double step = 0.0;    ///< [rad] between beams, negative for clockwise
  bool closed = false;  ///< the grid is a full turn: the last beam is a neighbour of the first
  std::size_t beams = 0;
  std::vector<std::vector<float>> ranges;  ///< scan by scan [m]

  std::size_t size() const { return ranges.size(); }
};

/// How a scan lies to another one of about the same place.
struct SmallMotion {
  double x = 0.0, y = 0.0, theta = 0.0;  ///< [m, rad]
  double agreeing = 0.0;                 ///< share of the beams both saw that agree once the motion is taken out
  std::size_t common = 0;                ///< beams both saw on smooth surface
};

/// The motion of a few centimetres and degrees that explains how ranges changed, by least squares over smooth surface.
/// Directions that no surface shows stay at 0. @param reference, ranges  on one grid, as in Stop
SmallMotion small_motion(const Stop& grid, const std::vector<float>& reference, const std::vector<float>& ranges);

struct StopOptions {
  std::size_t least_scans = 9;   ///< fewer are no stop; the first and last (without wheels three each) are left out
  std::size_t most_scans = 200;  ///< longer stops are cut
  double still_m = 0.01;         ///< farther from the stop's first scan is elsewhere
  double still_deg = 0.7;
  double drift_m = 0.004;        ///< a stop that creeps farther than this from its beginning to its end is none
  double wheels_still_m = 1e-3;  ///< wheels that read more than this have moved
  double wheels_still_deg = 0.05;
  double agreeing_min = 0.6;
  int odd_in_a_row = 3;  ///< so many scans may disagree (a wrong start angle, a person) before the stop ends
};

/// Finds stops in scans given one by one: where wheels rest (if there are any) and scans agree. Scans that repeat the
/// one before are left out.
class StopFinder {
 public:
  explicit StopFinder(const StopOptions& options = {}) : options_(options) {}

  /// A stop that this scan ended, if any.
  std::optional<Stop> add(const Scan& scan, const std::optional<Pose2>& odometry);
  /// The stop that the log's end ends.
  std::optional<Stop> finish();

 private:
  bool wheels_rest(const std::optional<Pose2>& odometry) const;
  void begin(const Scan& scan, const std::optional<Pose2>& odometry);
  std::optional<Stop> end();

  StopOptions options_;
  std::vector<Scan> scans_;  ///< of the stop so far
  Stop grid_;                ///< of its first scan
  std::vector<float> reference_;
  std::vector<SmallMotion> motions_;
  std::optional<Pose2> odometry_;
  int odd_ = 0;
};

/// A scan's ranges on a grid: each hit at the beam whose direction is nearest.
std::vector<float> on_grid(const Scan& scan, const Stop& grid);

/// The grid of a scan's own beams, without scans.
Stop grid_of(const Scan& scan);

}  // namespace phasescan
