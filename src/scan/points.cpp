#include "phasescan/scan/points.hpp"

#include <cmath>

namespace phasescan {

void scan_to_points(const Scan& scan, ScanPoints& out, double max_range, const Twist2& twist) {
  out.clear();
  out.x.reserve(scan.size());
  out.y.reserve(scan.size());
  out.range.reserve(scan.size());
  out.beam.reserve(scan.size());
  const bool deskew = !twist.is_zero() && scan.time_increment != 0.0;
  for (std::size_t i = 0; i < scan.size(); ++i) {
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

}  // namespace phasescan
