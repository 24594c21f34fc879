// The lines of the README, run: where a lidar has got to since an earlier scan; many scans against one that was
// prepared.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

// What follows up to the closing brace stands in README.md.
#include <phasescan/match/scan_matcher.hpp>
using namespace phasescan;

Pose2 where_am_i(std::span<const float> before, std::span<const float> now) {
  const ScanGeometry lidar{.angle_increment = deg_to_rad(1), .range_min = 0.15, .range_max = 6.0};
  const MatchResult match = match_scans(make_scan(before, lidar), make_scan(now, lidar));
  if (!match.usable) throw std::runtime_error("lost: " + std::string(to_string(match.status)));
  return match.T_ref_scan;  // p_before = R(theta) p_now + (x, y)
}

// Distance to the walls of an L-shaped room along every degree, from `pose`.
std::vector<float> look_around(const Pose2& pose) {
  std::vector<float> ranges;
  for (int beam = 0; beam < 360; ++beam) {
    const double angle = pose.theta + deg_to_rad(beam), c = std::cos(angle), s = std::sin(angle);
    double range = 0.0;  // walk until the wall: 4 m x 3 m without its corner
    for (double x = pose.x, y = pose.y; x > -1.5 && x < 2.5 && y > -1.0 && y < 2.0 && !(x > 1.2 && y > 1.0);
         range += 0.002) {
      x = pose.x + range * c;
      y = pose.y + range * s;
    }
    ranges.push_back(static_cast<float>(range));
  }
  return ranges;
}

int main() {
  const Pose2 truth{0.3, 0.2, deg_to_rad(-75)};
  const Pose2 found = where_am_i(look_around({}), look_around(truth));
  std::printf("x %.3f m, y %.3f m, turned %.2f deg\n", found.x, found.y, rad_to_deg(found.theta));
  const bool right =
      translation_distance(found, truth) < 0.02 && angle_distance(found.theta, truth.theta) < deg_to_rad(0.5);

  // Many scans against one: what is prepared of the reference is prepared once.
  const ScanGeometry lidar{.angle_increment = deg_to_rad(1), .range_min = 0.15, .range_max = 6.0};
  ScanMatcher matcher;
  const Reference reference = matcher.prepare(make_scan(look_around({}), lidar));
  int same = 0;
  for (int k = 0; k < 8; ++k) {
    const Pose2 pose{0.05 * k, 0.02 * k, 0.3 * k};
    const MatchResult match = matcher.match(reference, make_scan(look_around(pose), lidar));
    if (match.usable && translation_distance(match.T_ref_scan, pose) < 0.02) ++same;
  }
  std::printf("%d of 8 scans found from the prepared one\n", same);
  return right && same == 8 ? 0 : 1;
}
