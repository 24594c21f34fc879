#include <phasescan/match/scan_matcher.hpp>
#include <vector>

int main() {
  std::vector<float> ranges;
  for (int k = 0; k < 360; ++k) ranges.push_back(2.0F + static_cast<float>(k % 90) / 60.0F);
  const phasescan::Scan scan = phasescan::make_scan(ranges, {.angle_increment = phasescan::deg_to_rad(1)});
  const phasescan::MatchResult result = phasescan::match_many(scan, std::vector{scan, scan}, {}, 2).back();
  return result.T_ref_scan.is_finite() && result.confidence ? 0 : 1;
}
