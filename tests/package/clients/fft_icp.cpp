#include <phasescan/fft_icp/fft_icp.hpp>
#include <vector>

int main() {
  std::vector<float> ranges;
  for (int k = 0; k < 360; ++k) ranges.push_back(2.0F + static_cast<float>(k) / 180.0F);
  const phasescan::Scan scan = phasescan::make_scan(ranges, {.angle_increment = phasescan::deg_to_rad(1)});
  return phasescan::match_fft_icp(scan, scan).usable ? 0 : 1;
}
