/// A drive with a lidar: scan after scan with its truth, wheel odometry and people walking about.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "phasescan/io/log.hpp"
#include "sim/lidar.hpp"
#include "sim/path.hpp"

namespace phasescan::sim {

/// What happens during a drive.
struct DriveOptions {
  int people = 0;
  double people_speed_mps = 0.8;
  bool odometry = false;
  double odometry_scale = 0.02;
  double odometry_noise = 0.03;
  double odometry_slip_per_min = 1.0;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("people", self.people, OptionInfo{"", "people walking about", 0, 1000});
    v("people_speed_mps", self.people_speed_mps, OptionInfo{"m/s", "how fast they walk", 0.05, 5});
    v("odometry", self.odometry, OptionInfo{"", "wheel odometry in the log"});
    v("odometry_scale", self.odometry_scale,
      OptionInfo{"", "constant error of distance and of turn, standard deviation", 0, 0.5});
    v("odometry_noise", self.odometry_noise, OptionInfo{"", "random error of each step, share of the step", 0, 1});
    v("odometry_slip_per_min", self.odometry_slip_per_min,
      OptionInfo{"1/min", "wheels that spin or block for 0.5 s while driving", 0, 60});
  }
};

/// One scan of a drive.
struct DriveScan {
  LogEntry entry;       ///< odometry included where it is asked for; the laser sits at the base
  Pose2 T_world_laser;  ///< at the scan's stamp
  Twist2 twist;         ///< then, in the laser's frame
};

/// Scans of a drive one by one, in bounded memory. The same for the same world, options and seed.
class Drive {
 public:
  /// @throws std::invalid_argument for options out of bounds, or where the world has no room for the people.
  Drive(const World& world, const LidarOptions& lidar, Path path, const DriveOptions& options, std::uint64_t seed);
  ~Drive();
  Drive(Drive&&) noexcept;

  /// The next scan, or nothing at the path's end.
  std::optional<DriveScan> next();

  /// Scans in all, those that never arrive left out.
  std::size_t size() const;
  const Path& path() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace phasescan::sim
