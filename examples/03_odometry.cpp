// Follows a lidar through a room, scan by scan, without wheels: pose, covariance and status as each scan comes.
#include <cmath>
#include <cstdio>
#include <string>
#include <phasescan/odometry/odometry.hpp>
#include <vector>

using namespace phasescan;

// What a lidar at `pose` sees in a 5 m x 4 m room with an alcove, 360 beams.
Scan look_around(const Pose2& pose, Stamp stamp) {
  const double walls[][4] = {{-2, -1.5, 3, -1.5}, {3, -1.5, 3, 2.5}, {3, 2.5, 0, 2.5},
                             {0, 2.5, 0, 1.8},    {0, 1.8, -2, 1.8}, {-2, 1.8, -2, -1.5}};
  std::vector<float> ranges;
  for (int beam = 0; beam < 360; ++beam) {
    const double angle = pose.theta + deg_to_rad(beam), dx = std::cos(angle), dy = std::sin(angle);
    double nearest = 0.0;
    for (const auto& [ax, ay, bx, by] : walls) {
      const double cross = dx * (by - ay) - dy * (bx - ax);
      if (std::abs(cross) < 1e-12) continue;
      const double t = ((ax - pose.x) * (by - ay) - (ay - pose.y) * (bx - ax)) / cross;
      const double s = ((ax - pose.x) * dy - (ay - pose.y) * dx) / cross;
      if (t > 0 && s >= 0 && s <= 1 && (nearest == 0.0 || t < nearest)) nearest = t;
    }
    ranges.push_back(static_cast<float>(nearest));
  }
  Scan scan = make_scan(ranges, {.angle_increment = deg_to_rad(1), .range_min = 0.15, .range_max = 12.0});
  scan.stamp = stamp;
  return scan;
}

int main() {
  Odometry odometry;
  Pose2 truth;
  OdometryUpdate update;
  for (int i = 0; i < 100; ++i) {  // an arc, ten scans a second
    truth = exp_twist({0.2, 0.0, 0.25}, 0.1 * i);
    update = odometry.add({look_around(truth, stamp_from_seconds(0.1 * i))});
    if (i % 20 != 0) continue;
    const Pose2& p = update.T_odom_base;
    std::printf("x %.3f m, y %.3f m, %.1f deg, known to %.1f mm, %s\n", p.x, p.y, rad_to_deg(p.theta),
                1e3 * std::sqrt(update.covariance(0, 0)), std::string(to_string(update.status)).c_str());
  }
  const bool right = translation_distance(update.T_odom_base, truth) < 0.02 &&
                     angle_distance(update.T_odom_base.theta, truth.theta) < deg_to_rad(0.5);
  return right && update.status == TrackingStatus::kOk ? 0 : 1;
}
