// The five methods of [Jiang19] on two scans of one room, taken 0.3 m and 120 degrees apart.
#include <cmath>
#include <cstdio>
#include <phasescan/fft_icp/fft_icp.hpp>
#include <string>
#include <vector>

namespace {

// What a lidar at `pose` sees in a 5 m x 4 m room with an alcove, 360 beams.
phasescan::Scan look_around(const phasescan::Pose2& pose) {
  const double walls[][4] = {{-2, -1.5, 3, -1.5}, {3, -1.5, 3, 2.5}, {3, 2.5, 0, 2.5},
                             {0, 2.5, 0, 1.8},    {0, 1.8, -2, 1.8}, {-2, 1.8, -2, -1.5}};
  std::vector<float> ranges;
  for (int beam = 0; beam < 360; ++beam) {
    const double angle = pose.theta + phasescan::deg_to_rad(beam), dx = std::cos(angle), dy = std::sin(angle);
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
  return phasescan::make_scan(ranges,
                              {.angle_increment = phasescan::deg_to_rad(1), .range_min = 0.15, .range_max = 12.0});
}

}  // namespace

int main() {
  using phasescan::FftIcpMethod;
  const phasescan::Pose2 truth{0.25, -0.15, phasescan::deg_to_rad(120)};
  const phasescan::Scan before = look_around({}), now = look_around(truth);
  bool right = true;
  for (const FftIcpMethod method :
       {FftIcpMethod::kIcp, FftIcpMethod::kNdt, FftIcpMethod::kFft, FftIcpMethod::kFftIcp1, FftIcpMethod::kFftIcp2}) {
    phasescan::FftIcpOptions options;
    options.fft_icp.method = method;
    phasescan::FftIcpMatcher matcher(options);
    const phasescan::MatchResult result = matcher.match(before, now);
    const double off = phasescan::translation_distance(result.T_ref_scan, truth);
    std::printf("%-9s x %6.3f m, y %6.3f m, turned %7.2f deg: %.3f m off\n", std::string(to_string(method)).c_str(),
                result.T_ref_scan.x, result.T_ref_scan.y, phasescan::rad_to_deg(result.T_ref_scan.theta), off);
    // Refinement alone does not find so large a turn; the methods with an FFT do.
    if (method != FftIcpMethod::kIcp && method != FftIcpMethod::kNdt) right = right && result.usable && off < 0.05;
  }
  return right ? 0 : 1;
}
