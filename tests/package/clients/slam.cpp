#include <phasescan/odometry/odometry.hpp>
#include <phasescan/slam/slam.hpp>
#include <vector>

int main() {
  phasescan::SlamOptions options;
  options.validate();
  phasescan::Odometry odometry(options.odometry);
  std::vector<float> ranges;
  for (int k = 0; k < 360; ++k) ranges.push_back(2.0F + static_cast<float>(k) / 180.0F);
  phasescan::RangeMeasurement measurement;
  measurement.scan = phasescan::make_scan(ranges, {.angle_increment = phasescan::deg_to_rad(1)});
  odometry.add(measurement);
  return 0;
}
