#include "scan/points.hpp"

#include <algorithm>
#include <cmath>

namespace phasescan {
namespace {

// Listed angles may jump once, by a turn: most steps decide.
bool is_clockwise(const Scan& scan) {
  if (scan.angles.empty()) return scan.geometry.angle_increment < 0.0;
  std::size_t up = 0, down = 0;
  for (std::size_t i = 1; i < scan.size(); ++i) {
    up += scan.angles[i] > scan.angles[i - 1];
    down += scan.angles[i] < scan.angles[i - 1];
  }
  return down > up;
}

}  // namespace

void scan_to_points(const Scan& scan, ScanPoints& out, double max_range, const Twist2& twist) {
  out.clear();
  out.x.reserve(scan.size());
  out.y.reserve(scan.size());
  out.range.reserve(scan.size());
  out.beam.reserve(scan.size());
  const bool deskew = !twist.is_zero() && scan.time_increment != 0.0;
  // One order whichever way the beams are listed: what samples or sums the points gives the same for both.
  const bool clockwise = is_clockwise(scan);
  for (std::size_t k = 0; k < scan.size(); ++k) {
    const std::size_t i = clockwise ? scan.size() - 1 - k : k;
    if (!scan.is_hit(i)) continue;
    const auto range = static_cast<double>(scan.ranges[i]);
    if (max_range > 0.0 && range > max_range) continue;
    const double angle = scan.angle(i);
    Eigen::Vector2d p(range * std::cos(angle), range * std::sin(angle));
    if (deskew) p = exp_twist(twist, static_cast<double>(i) * scan.time_increment) * p;
    out.x.push_back(static_cast<float>(p.x()));
    out.y.push_back(static_cast<float>(p.y()));
    out.range.push_back(scan.ranges[i]);
    out.beam.push_back(static_cast<int>(i));
  }
}

double extent(const ScanPoints& points) {
  if (points.size() == 0) return 0.0;
  const auto [left, right] = std::minmax_element(points.x.begin(), points.x.end());
  const auto [low, high] = std::minmax_element(points.y.begin(), points.y.end());
  return std::hypot(static_cast<double>(*right - *left), static_cast<double>(*high - *low));
}

}  // namespace phasescan
