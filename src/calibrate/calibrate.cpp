#include "calibrate/calibrate.hpp"

#include <algorithm>
#include <cmath>

namespace phasescan {
namespace {

/// All the ranges of stops that are kept: 160 MB.
constexpr std::size_t kMostRanges = 40'000'000;
constexpr std::size_t kSample = 20'000;

/// Rounds to so many digits: a file says no more than was measured.
double rounded(double value, int digits) {
  if (value == 0.0 || !std::isfinite(value)) return 0.0;
  const double unit = std::pow(10.0, std::floor(std::log10(std::abs(value))) - digits + 1);
  return std::round(value / unit) * unit;
}

void set_geometry(const Stop& grid, const Scan& example, sim::LidarOptions& sensor) {
  sensor.beams = static_cast<int>(grid.beams);
  const double step_deg = std::abs(rad_to_deg(grid.step));
  sensor.fov_deg = grid.closed ? 360.0 : std::clamp(step_deg * static_cast<double>(grid.beams - 1), 0.001, 360.0);
  sensor.fov_deg = rounded(sensor.fov_deg, 8);
  sensor.angle_min_deg = rounded(std::remainder(rad_to_deg(grid.angle_min), 360.0), 8);
  sensor.clockwise = grid.step < 0.0;
  sensor.effects.bearing_step_deg = bearing_grain_deg(example.angles);
}

void set_noise(const NoiseFit& noise, double step_deg, sim::LidarOptions& sensor) {
  sim::SensorEffects& effects = sensor.effects;
  const double grain2 = sensor.resolution_m * sensor.resolution_m;
  constexpr double kLeast_m = 1e-4;
  for (std::size_t i = 0; i < noise.ranges.size(); ++i) {
    // Rounding adds a twelfth of its square; where there is hardly any noise beside it, it adds less.
    const double variance = std::max(noise.variances[i] - grain2 / 12.0, 0.1 * noise.variances[i]);
    effects.noise_ranges_m.push_back(rounded(noise.ranges[i], 3));
    effects.noise_sigmas_m.push_back(std::max(kLeast_m, rounded(std::sqrt(variance), 3)));
  }
  effects.revolution_turn_deg = rounded(std::sqrt(noise.turn_variance) * step_deg, 3);
  if (noise.pattern.period <= 0.0)
    effects.direction_jitter_deg = rounded(std::sqrt(noise.jitter_variance) * step_deg, 3);
}

void set_dropout(const DropoutFit& dropout, sim::LidarOptions& sensor) {
  sim::SensorEffects& effects = sensor.effects;
  sensor.dropout = 0.0;
  for (std::size_t i = 0; i < dropout.ranges.size(); ++i) {
    effects.dropout_ranges_m.push_back(rounded(dropout.ranges[i], 3));
    effects.dropout_shares.push_back(std::round(dropout.losses[i] * 1e4) / 1e4);
  }
  effects.dropout_memory = std::round(dropout.memory * 100.0) / 100.0;
  effects.patch_share = std::round(dropout.patch_share * 1000.0) / 1000.0;
}

void set_edges(const EdgeFit& edges, double step_deg, sim::LidarOptions& sensor) {
  if (edges.edges == 0) return;
  // An edge lies anywhere between two beams; half a beam's width to each side of it mixes.
  sensor.mixed_pixels =
      std::clamp(std::round(edges.mixed * 2.0 * step_deg / sensor.beam_width_deg * 100.0) / 100.0, 0.0, 1.0);
  sensor.effects.edge_loss = std::round(edges.loss * 1000.0) / 1000.0;
  if (edges.loss > 0.0)
    sensor.effects.edge_width_deg = std::clamp(rounded(edges.width_steps * step_deg, 3), 0.01, 90.0);
}

void set_timing(const TimingFit& timing, sim::LidarOptions& sensor) {
  if (timing.rate_hz <= 0.0) return;
  sensor.rate_hz = std::clamp(rounded(timing.rate_hz, 4), 0.01, 1000.0);
  sensor.effects.rate_wander = std::min(0.3, std::round(timing.wander * 1e4) / 1e4);
  sensor.effects.rate_wander_s = std::min(1e4, rounded(timing.wander_s, 2));
  if (timing.burst_max < 1) return;
  sensor.effects.lost_revolutions = std::min(0.99, std::round(timing.lost_share * 1e4) / 1e4);
  sensor.effects.lost_burst_min = timing.burst_min;
  sensor.effects.lost_burst_max = timing.burst_max;
}

void set_sectors(const std::vector<StopBeams>& stops, std::size_t scans, Calibration& out) {
  constexpr std::size_t kLeast = 10;
  std::vector<double> widths;
  for (const StopBeams& stop : stops) {
    for (const LostSector& sector : stop.lost)
      widths.push_back(static_cast<double>(sector.count) * std::abs(rad_to_deg(stop.stop.step)));
  }
  out.sectors = widths.size();
  if (widths.size() < kLeast) return;
  std::sort(widths.begin(), widths.end());
  // All widths alike from a tenth below the first tenth to a tenth above the last: single scans that are nearly empty
  // do not stretch it.
  const std::size_t tenth = widths.size() / 10;
  const double low = widths[tenth], high = widths[widths.size() - 1 - tenth], more = (high - low) / 8.0;
  sim::SensorEffects& effects = out.sensor.effects;
  effects.lost_sectors = std::round(1e4 * static_cast<double>(widths.size()) / static_cast<double>(scans)) / 1e4;
  effects.lost_sector_min_deg = std::round(std::max(0.0, low - more));
  effects.lost_sector_max_deg = std::min(360.0, std::round(high + more));
}

}  // namespace

double range_grain(const std::vector<float>& ranges) {
  constexpr double kGrains_m[] = {0.05, 0.02, 0.01, 0.005, 0.002, 0.001, 0.0005, 0.00025};
  constexpr double kOff = 0.02, kShare = 0.99;
  if (ranges.empty()) return 0.0;
  for (const double grain : kGrains_m) {
    const auto fits = [&](float range) {
      const double steps = static_cast<double>(range) / grain;
      return std::abs(steps - std::round(steps)) < kOff;
    };
    const auto count = std::count_if(ranges.begin(), ranges.end(), fits);
    if (static_cast<double>(count) >= kShare * static_cast<double>(ranges.size())) return grain;
  }
  return 0.0;
}

double bearing_grain_deg(const std::vector<float>& angles) {
  constexpr double kGrains_deg[] = {1.0,  0.5,     0.25,  0.2,  0.125,    0.1, 0.0625,
                                    0.05, 0.03125, 0.025, 0.02, 0.015625, 0.01};
  constexpr double kOff_deg = 2e-4;
  if (angles.size() < 3) return 0.0;
  const auto deg = [&](std::size_t i) { return rad_to_deg(static_cast<double>(angles[i])); };
  bool even = true;
  for (std::size_t i = 2; i < angles.size(); ++i)
    even = even && std::abs(deg(i) - 2.0 * deg(i - 1) + deg(i - 2)) < kOff_deg;
  if (even) return 0.0;
  for (const double grain : kGrains_deg) {
    bool all = true;
    for (std::size_t i = 0; i < angles.size() && all; ++i)
      all = std::abs(deg(i) - std::round(deg(i) / grain) * grain) < kOff_deg;
    if (all) return grain;
  }
  return 0.0;
}

void Calibrator::keep(std::optional<Stop> stop, std::vector<StopBeams>& stops) {
  if (!stop || kept_ > kMostRanges) return;
  kept_ += stop->size() * stop->beams;
  stops.push_back(summarise(std::move(*stop)));
}

void Calibrator::add(const LogEntry& entry) {
  if (!laser_) laser_ = entry.laser;
  if (*laser_ != entry.laser) {
    ++other_lasers_;
    return;
  }
  stamps_.push_back(entry.scan.stamp);
  for (std::size_t i = 0; i < entry.scan.size(); ++i) {
    if (!entry.scan.is_hit(i)) continue;
    const double range = entry.scan.ranges[i];
    range_least_ = range_least_ > 0.0 ? std::min(range_least_, range) : range;
    range_most_ = std::max(range_most_, range);
    if (sample_.size() < kSample) sample_.push_back(entry.scan.ranges[i]);
  }
  if (!example_ && entry.scan.hit_count() > 0) example_ = entry.scan;
  with_odometry_ += entry.odometry ? 1 : 0;
  keep(by_wheels_.add(entry.scan, entry.odometry), stops_by_wheels_);
  keep(by_scans_.add(entry.scan, {}), stops_by_scans_);
}

std::optional<Calibration> Calibrator::finish() {
  keep(by_wheels_.finish(), stops_by_wheels_);
  keep(by_scans_.finish(), stops_by_scans_);
  Calibration out;
  out.scans = stamps_.size();
  // Odometry that never rests (of a filter, say) finds no stop: then scans alone say.
  auto noise = with_odometry_ > 0 ? fit_noise(stops_by_wheels_) : std::nullopt;
  out.by_wheels = noise.has_value();
  const std::vector<StopBeams>& stops = out.by_wheels ? stops_by_wheels_ : stops_by_scans_;
  if (!noise) noise = fit_noise(stops);
  if (!noise) return {};
  out.stops = stops.size();
  for (const StopBeams& stop : stops) out.stop_scans += stop.stop.size();
  out.noise = *noise;
  const Stop& grid = stops.front().stop;
  const double step_deg = std::abs(rad_to_deg(grid.step));
  sim::LidarOptions& sensor = out.sensor;
  set_geometry(grid, *example_, sensor);
  const ScanGeometry& stated = example_->geometry;
  sensor.range_min_m = rounded(stated.range_min > 0.0 ? stated.range_min : 0.9 * range_least_, 3);
  sensor.range_max_m = rounded(stated.range_max > 0.0 ? stated.range_max : range_most_, 3);
  sensor.resolution_m = range_grain(sample_);
  set_noise(out.noise, step_deg, sensor);
  out.timing = fit_timing(stamps_);
  set_timing(out.timing, sensor);
  const double empty_share = out.noise.pattern.period > 0.0 ? 1.0 / out.noise.pattern.period : 0.0;
  if (empty_share > 0.0)
    sensor.effects.sample_rate_hz = rounded((1.0 - empty_share) * kTwoPi / std::abs(grid.step) * sensor.rate_hz, 4);
  out.dropout = fit_dropout(stops, empty_share);
  set_dropout(out.dropout, sensor);
  out.edges = fit_edges(stops);
  set_edges(out.edges, step_deg, sensor);
  set_sectors(stops, out.stop_scans, out);
  out.table = standstill_table(stops);
  return out;
}

}  // namespace phasescan
