/// Simulated lidars: what a sensor of a given kind would say in a world, with the faults of real ones.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <string_view>

#include "phasescan/core/options.hpp"
#include "core/random.hpp"
#include "phasescan/scan/scan.hpp"
#include "sim/ray_caster.hpp"
#include "sim/sensor_effects.hpp"

namespace phasescan::sim {

/// A lidar. Defaults are an RPLidar A1; configs/sensors/*.yaml hold the others. A file names the effects beside the
/// rest.
struct LidarOptions {
  int beams = 360;
  double fov_deg = 360.0;
  double angle_min_deg = 0.0;
  bool clockwise = true;
  double range_min_m = 0.15;
  double range_max_m = 6.0;
  double sigma_m = 0.01;
  double sigma_relative = 0.01;
  double resolution_m = 0.001;
  double dropout = 0.02;
  double beam_width_deg = 0.4;
  double mixed_pixels = 0.5;
  double grazing_deg = 80.0;
  double black_range = 0.25;
  double glass_deg = 8.0;
  double rate_hz = 5.5;
  bool motion = true;
  SensorEffects effects;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("beams", self.beams, OptionInfo{"", "beams a scan", 1, 1e6});
    v("fov_deg", self.fov_deg,
      OptionInfo{"deg", "field of view; 360: the last beam is one step before the first", 0.001, 360});
    v("angle_min_deg", self.angle_min_deg,
      OptionInfo{"deg", "direction of the first beam, counter-clockwise from ahead", -360, 360});
    v("clockwise", self.clockwise, OptionInfo{"", "turns clockwise: a negative angle_increment"});
    v("range_min_m", self.range_min_m, OptionInfo{"m", "nearer surfaces give nothing", 0, 1000});
    v("range_max_m", self.range_max_m,
      OptionInfo{"m", "farther surfaces give nothing", 0.01, 1000, false, "range_min_m"});
    v("sigma_m", self.sigma_m, OptionInfo{"m", "range noise, at least", 0, 10});
    v("sigma_relative", self.sigma_relative, OptionInfo{"", "range noise, at least this share of the range", 0, 1});
    v("resolution_m", self.resolution_m, OptionInfo{"m", "ranges are rounded to this; 0 = not", 0, 1});
    v("dropout", self.dropout, OptionInfo{"", "share of the beams lost for no reason", 0, 1});
    v("beam_width_deg", self.beam_width_deg, OptionInfo{"deg", "full width of a beam, where edges mix", 0, 10});
    v("mixed_pixels", self.mixed_pixels,
      OptionInfo{"", "share of the beams on an edge that say something in between", 0, 1});
    v("grazing_deg", self.grazing_deg,
      OptionInfo{"deg", "from this incidence on hits are missed, at 90 deg all", 0, 90});
    v("black_range", self.black_range, OptionInfo{"", "share of range_max up to which black surfaces answer", 0, 1});
    v("glass_deg", self.glass_deg,
      OptionInfo{"deg", "glass answers up to this incidence, else the beam goes through", 0, 90});
    v("rate_hz", self.rate_hz, OptionInfo{"Hz", "scans a second", 0.01, 1000});
    v("motion", self.motion, OptionInfo{"", "each beam is cast at its own time; off: all at the scan's stamp"});
    SensorEffects::visit(self.effects, v);
  }

  double angle_increment() const;  ///< [rad], negative for clockwise sensors
  double time_increment() const;   ///< [s] between beams; the whole turn takes 1 / rate_hz
  ScanGeometry geometry() const;
  double sigma(double range) const;  ///< standard deviation of a range [m]
  /// How far a beam looks past its stated direction, whole revolutions apart, standard deviation [rad].
  double bearing_sigma() const;
  LidarOptions noise_free() const;  ///< the same geometry and reach without noise, rounding, losses and effects
};

/// Standard deviation of the direction of a whole revolution [rad]: its turn, and what is left of the half beam by
/// which samples are said beside their direction where samples and beams are nearly in step.
double revolution_turn_sigma(const LidarOptions& lidar);

/// @throws std::invalid_argument naming the field that is out of bounds.
void check_lidar(std::string_view section, const LidarOptions& lidar);

/// Share of the samples that a beam of this range is lost by chance: dropout and dropout_shares, no grazing, no
/// patches.
double dropout_share(const LidarOptions& lidar, double range);

/// What stands around the sensor: a fixed world and what is not fixed in it.
struct Surroundings {
  const RayCaster* fixed = nullptr;
  const Shape* loose = nullptr;  ///< may be null: people, moved objects

  RayHit cast(const Eigen::Vector2d& origin, const Eigen::Vector2d& direction, double max_range,
              double min_range = 0.0) const;
};

/// The surface that answers a beam, glass and black surfaces considered; not found = nothing answers within range_max.
RayHit cast_beam(const Surroundings& around, const LidarOptions& lidar, const Eigen::Vector2d& origin,
                 const Eigen::Vector2d& direction);

class RevolutionSource;

/// One scan of a sensor that has just been switched on, at standstill. Missing beams are "no return", as cheap sensors
/// say it. time_increment stays 0.
Scan simulate_scan(const Surroundings& around, const LidarOptions& lidar, const Pose2& T_world_laser, Random& random);

/// One scan in motion, of a sensor that has just been switched on: beam i is cast from T_world_laser(i *
/// time_increment) where lidar.motion is on, else from T_world_laser(0). `around` holds throughout.
/// @param stamp_s  time of the first beam [s]
Scan simulate_scan(const Surroundings& around, const LidarOptions& lidar,
                   const std::function<Pose2(double)>& T_world_laser, double stamp_s, Random& random);

/// The same for the next revolution of a sensor that runs. @param period_s  how long it takes
Scan simulate_scan(const Surroundings& around, const LidarOptions& lidar, RevolutionSource& source, double period_s,
                   const std::function<Pose2(double)>& T_world_laser, double stamp_s, Random& random);

}  // namespace phasescan::sim
