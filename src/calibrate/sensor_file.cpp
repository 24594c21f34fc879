// What a calibration says: the sensor file, and lines for people.
#include <fmt/format.h>

#include <cmath>

#include "calibrate/calibrate.hpp"

namespace phasescan {
namespace {

std::string text_of(bool value) {
  return value ? "true" : "false";
}
std::string text_of(int value) {
  return std::to_string(value);
}
std::string text_of(double value) {
  return fmt::format("{:.10g}", value);
}
std::string text_of(const sim::Table& table) {
  std::string out = "[";
  for (const double value : table) out += (out.size() > 1 ? ", " : "") + text_of(value);
  return out + "]";
}
template <class E>
requires std::is_enum_v<E> std::string text_of(E value) {
  return std::string(to_string(value));
}

/// One line whatever the log is called.
std::string comment_text(std::string_view text) {
  std::string out;
  for (const char c : text) out += static_cast<unsigned char>(c) < 0x20 || c == 0x7f ? '?' : c;
  return out;
}

std::string millimetres(double metres) {
  return std::isnan(metres) ? "-" : fmt::format("{:.1f}", 1000.0 * metres);
}

}  // namespace

std::string format_sensor_file(const Calibration& calibration, std::string_view log) {
  std::string out = fmt::format(
      "# Measured on {}: {} stops with {} scans, {}.\n"
      "# Not measured, so as a cheap sensor has it: beam width, grazing, black and glass surfaces, size of patches, tilt.\n",
      comment_text(log), calibration.stops, calibration.stop_scans,
      calibration.by_wheels ? "where the wheels rest" : "where scans agree");
  sim::LidarOptions plain;
  std::vector<std::string> defaults;
  sim::LidarOptions::visit(
      plain, [&](std::string_view, const auto& value, const OptionInfo&) { defaults.push_back(text_of(value)); });
  std::size_t i = 0, own = 0;
  sim::SensorEffects::visit(plain.effects, [&](std::string_view, const auto&, const OptionInfo&) { ++own; });
  const std::size_t effects_from = defaults.size() - own;
  sim::LidarOptions::visit(calibration.sensor, [&](std::string_view name, const auto& value, const OptionInfo&) {
    // Effects that are off go without a line.
    if (i < effects_from || text_of(value) != defaults[i]) out += fmt::format("{}: {}\n", name, text_of(value));
    ++i;
  });
  return out;
}

std::string format_calibration(const Calibration& c) {
  const sim::LidarOptions& sensor = c.sensor;
  const sim::SensorEffects& effects = sensor.effects;
  const double step_deg = std::abs(rad_to_deg(sensor.angle_increment()));
  std::string out = fmt::format("stops                    {} with {} of {} scans, {}\n", c.stops, c.stop_scans, c.scans,
                                c.by_wheels ? "where the wheels rest" : "where scans agree");
  out += fmt::format("beams                    {} over {:.6g} deg, {}\n", sensor.beams, sensor.fov_deg,
                     sensor.clockwise ? "clockwise" : "counter-clockwise");
  out +=
      "\nAs seen: a beam's standard deviation over a stop, mm (steep: where the range changes by more than 2 cm a beam)\n";
  out += "range [m]    beams   median      90 %    steep\n";
  for (const StandstillRow& row : c.table.rows)
    out += fmt::format("{:<4g}-{:<6g} {:>6} {:>8} {:>9} {:>8}\n", row.from, row.to, row.beams, millimetres(row.median),
                       millimetres(row.most), millimetres(row.steep));
  out += fmt::format("whole revolutions turn by {:.3f} beam steps ({:.3f} deg); ", c.table.turn_steps,
                     c.table.turn_steps * step_deg);
  out += fmt::format("beams that ever answer do so in {:.0f} % of the scans, {:.0f} % of them in 5-95 %\n",
                     100.0 * c.table.present, 100.0 * c.table.come_and_go);
  out += "\nAs fitted\nrange noise [m: mm]     ";
  for (std::size_t i = 0; i < effects.noise_ranges_m.size(); ++i)
    out += fmt::format(" {:.3g}: {}", effects.noise_ranges_m[i], millimetres(effects.noise_sigmas_m[i]));
  out += fmt::format("\njitter of directions     {:.3f} beam steps ({:.3f} deg), {:.2f} of it the neighbour's too\n",
                     std::sqrt(c.noise.jitter_variance), std::sqrt(c.noise.jitter_variance) * step_deg,
                     c.noise.pattern.neighbour_correlation);
  if (effects.sample_rate_hz > 0.0)
    out +=
        fmt::format("samples                  {:.5g} Hz, not in step with the turn: {:.1f} % of the beams stay empty\n",
                    effects.sample_rate_hz, 100.0 / c.noise.pattern.period);
  out += fmt::format("turn of revolutions      {:.3f} beam steps ({:.3f} deg)\n", std::sqrt(c.noise.turn_variance),
                     effects.revolution_turn_deg);
  out += "lost beams [m: %]       ";
  for (std::size_t i = 0; i < effects.dropout_ranges_m.size(); ++i)
    out += fmt::format(" {:.3g}: {:.1f}", effects.dropout_ranges_m[i], 100.0 * effects.dropout_shares[i]);
  out += fmt::format("\nbad surface              {:.1f} % of it, correlation from scan to scan {:.2f}\n",
                     100.0 * effects.patch_share, effects.dropout_memory);
  out += fmt::format(
      "edges                    {:.1f} % lost, none beyond {:.2g} beam steps; {:.1f} % of the answers in between\n",
      100.0 * c.edges.loss, c.edges.width_steps, 100.0 * c.edges.mixed);
  out += fmt::format("lost sectors             in {:.1f} % of the scans of stops\n",
                     c.stop_scans ? 100.0 * static_cast<double>(c.sectors) / static_cast<double>(c.stop_scans) : 0.0);
  if (c.timing.rate_hz > 0.0) {
    out += fmt::format("rate                     {:.4g} Hz, wanders by {:.2f} % over {:.2g} s\n", c.timing.rate_hz,
                       100.0 * c.timing.wander, c.timing.wander_s);
    out += fmt::format("lost revolutions         bursts of {} to {} before {:.1f} % of the scans\n", c.timing.burst_min,
                       c.timing.burst_max, 100.0 * c.timing.lost_share);
  }
  return out;
}

}  // namespace phasescan
