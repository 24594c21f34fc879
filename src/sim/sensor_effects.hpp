/// What recorded lidars do beyond the plain model of LidarOptions. Everything is off by default.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "phasescan/core/options.hpp"

namespace phasescan::sim {

/// What a scan holds where packets of the sensor were lost.
enum class SectorLoss {
  kEmpty,   ///< nothing there
  kClosed,  ///< what came later moves forward and the end is empty: bearings behind the gap are wrong
  kHeld,    ///< the same, and the end keeps what the revolution before had there
};

/// A table of ranges and values, in YAML two lists of the same length.
using Table = std::vector<double>;

/// Options of the effects. Part of LidarOptions; a sensor file has them beside the others.
struct SensorEffects {
  Table noise_ranges_m;
  Table noise_sigmas_m;
  double direction_jitter_deg = 0.0;
  double revolution_turn_deg = 0.0;
  double sample_rate_hz = 0.0;
  double bearing_step_deg = 0.0;
  Table dropout_ranges_m;
  Table dropout_shares;
  double dropout_memory = 0.0;
  double patch_share = 0.0;
  double patch_m = 0.2;
  double edge_loss = 0.0;
  double edge_width_deg = 2.0;
  double lost_revolutions = 0.0;
  int lost_burst_min = 1;
  int lost_burst_max = 8;
  double lost_sectors = 0.0;
  double lost_sector_min_deg = 30.0;
  double lost_sector_max_deg = 120.0;
  SectorLoss lost_sector_kind = SectorLoss::kEmpty;
  double wrong_start = 0.0;
  double wrong_start_min_deg = 30.0;
  double wrong_start_max_deg = 120.0;
  double rate_wander = 0.0;
  double rate_wander_s = 0.0;
  double tilt_deg = 0.0;
  double tilt_towards_deg = 0.0;
  double height_m = 0.25;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("noise_ranges_m", self.noise_ranges_m, OptionInfo{"m", "range noise as a curve, in place of sigma_*: ranges"});
    v("noise_sigmas_m", self.noise_sigmas_m,
      OptionInfo{"m", "and its standard deviation there; linear in between, in proportion to the range beyond"});
    v("direction_jitter_deg", self.direction_jitter_deg,
      OptionInfo{"deg", "each beam looks past its stated direction, standard deviation", 0, 10});
    v("revolution_turn_deg", self.revolution_turn_deg,
      OptionInfo{"deg", "whole revolutions are turned, standard deviation", 0, 10});
    v("sample_rate_hz", self.sample_rate_hz,
      OptionInfo{"Hz", "samples not in step with the turn, each said for the nearest beam; 0 = one a beam", 0, 1e6});
    v("bearing_step_deg", self.bearing_step_deg,
      OptionInfo{"deg", "stated directions are rounded to this; 0 = not", 0, 10});
    v("dropout_ranges_m", self.dropout_ranges_m, OptionInfo{"m", "further losses by range: ranges"});
    v("dropout_shares", self.dropout_shares, OptionInfo{"", "and the share of beams lost there, linear in between"});
    v("dropout_memory", self.dropout_memory,
      OptionInfo{"", "correlation of these losses from one revolution to the next", 0, 1});
    v("patch_share", self.patch_share,
      OptionInfo{"", "share of the surface that answers badly: each patch loses a share drawn from 0 to 1", 0, 1});
    v("patch_m", self.patch_m, OptionInfo{"m", "size of a patch", 0.01, 100});
    v("edge_loss", self.edge_loss,
      OptionInfo{"", "share of the beams lost where one surface ends before another, less beside it", 0, 1});
    v("edge_width_deg", self.edge_width_deg, OptionInfo{"deg", "and none from here on", 0.01, 90});
    v("lost_revolutions", self.lost_revolutions,
      OptionInfo{"", "how often a burst of revolutions is lost before one that is kept", 0, 0.99});
    v("lost_burst_min", self.lost_burst_min, OptionInfo{"", "revolutions a burst, at least", 1, 1000});
    v("lost_burst_max", self.lost_burst_max,
      OptionInfo{"", "at most, all sizes alike", 1, 1000, false, "lost_burst_min"});
    v("lost_sectors", self.lost_sectors, OptionInfo{"", "share of the revolutions that lack a sector", 0, 1});
    v("lost_sector_min_deg", self.lost_sector_min_deg, OptionInfo{"deg", "width of a lost sector, at least", 0, 360});
    v("lost_sector_max_deg", self.lost_sector_max_deg,
      OptionInfo{"deg", "at most, all widths alike", 0, 360, false, "lost_sector_min_deg"});
    v("lost_sector_kind", self.lost_sector_kind,
      OptionInfo{"", "empty; closed: what came later moves forward; held: and the end is of the revolution before"});
    v("wrong_start", self.wrong_start, OptionInfo{"", "share of the revolutions whose start angle is wrong", 0, 1});
    v("wrong_start_min_deg", self.wrong_start_min_deg, OptionInfo{"deg", "by at least this, either way", 0, 180});
    v("wrong_start_max_deg", self.wrong_start_max_deg,
      OptionInfo{"deg", "by at most this", 0, 180, false, "wrong_start_min_deg"});
    v("rate_wander", self.rate_wander,
      OptionInfo{"", "how far the time of a revolution wanders, standard deviation, share of it", 0, 0.3});
    v("rate_wander_s", self.rate_wander_s,
      OptionInfo{"s", "time after which the wander has forgotten where it was; 0: each revolution anew", 0, 1e4});
    v("tilt_deg", self.tilt_deg, OptionInfo{"deg", "the sensor looks down by this on one side", 0, 45});
    v("tilt_towards_deg", self.tilt_towards_deg, OptionInfo{"deg", "on this side", -360, 360});
    v("height_m", self.height_m, OptionInfo{"m", "of the sensor above the floor, for tilt", 0.01, 100});
  }

  /// Some effect makes beams come and go by what they meet.
  bool loses_beams() const { return !dropout_ranges_m.empty() || patch_share > 0.0 || edge_loss > 0.0; }

  /// Some effect makes beams look past their stated directions.
  bool moves_beams() const {
    return direction_jitter_deg > 0.0 || revolution_turn_deg > 0.0 || sample_rate_hz > 0.0 || wrong_start > 0.0 ||
           tilt_deg > 0.0;
  }
};

/// Linear between a table's entries, its end values outside. `at` rises strictly and is not empty.
double table_value(std::span<const double> at, std::span<const double> values, double x);

/// @throws std::invalid_argument naming the field: options out of bounds; tables of different length, with values out
/// of bounds, or whose ranges do not rise.
void check_effects(std::string_view section, const SensorEffects& effects);

}  // namespace phasescan::sim

namespace phasescan {
template <>
std::span<const std::string_view> enum_names<sim::SectorLoss>();
}  // namespace phasescan
