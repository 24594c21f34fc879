#include "io/even_scan.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace phasescan {

Scan even_scan(const Scan& scan, double* largest_move_rad) {
  if (largest_move_rad != nullptr) *largest_move_rad = 0.0;
  const std::size_t n = scan.size();
  if (scan.angles.empty() || n == 0) return scan;
  const auto [low, high] = std::minmax_element(scan.angles.begin(), scan.angles.end());
  ScanGeometry geometry = scan.geometry;
  geometry.angle_min = *low;
  geometry.angle_increment = n > 1 && *high > *low ? (double{*high} - double{*low}) / static_cast<double>(n - 1) : 1.0;
  // A falling sweep stays one.
  if (scan.angles.back() < scan.angles.front()) {
    geometry.angle_min = *high;
    geometry.angle_increment = -geometry.angle_increment;
  }
  std::vector<float> raw(n, 0.0F);
  std::vector<float> intensities(scan.intensities.empty() ? 0 : n, 0.0F);
  std::vector<double> distance(n, std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i < n; ++i) {
    const double at = (scan.angle(i) - geometry.angle_min) / geometry.angle_increment;
    const auto bin = static_cast<std::size_t>(std::clamp(std::lround(at), 0L, static_cast<long>(n) - 1));
    const double away = std::abs(at - static_cast<double>(bin));
    const double moved = away * std::abs(geometry.angle_increment);
    // Float angles are even within their own rounding.
    if (largest_move_rad != nullptr && moved > 1e-5) *largest_move_rad = std::max(*largest_move_rad, moved);
    if (away >= distance[bin]) continue;
    distance[bin] = away;
    raw[bin] = raw_range(scan, i);
    if (!intensities.empty()) intensities[bin] = scan.intensities[i];
  }
  Scan out = make_scan(raw, geometry);
  out.stamp = scan.stamp;
  out.time_increment = scan.time_increment;
  out.intensities = std::move(intensities);
  return out;
}

}  // namespace phasescan
