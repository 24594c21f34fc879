/// How the time of a match grows with the number of beams and with the size of the place.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "eval/bench.hpp"

namespace phasescan {

/// What is varied: beams of a scan, or the sensor's reach [m] with the place grown to it (6 m: as it is).
enum class ScalingAxis { kBeams, kRange };

struct ScalingSettings {
  std::vector<double> beams{90, 180, 360, 720, 1440, 2880, 4000};
  std::vector<double> range_m{2, 4, 6, 10, 20, 40, 60};
  std::size_t pairs = 100;  ///< for each value
  int repeat = 5;
  std::uint64_t seed = 31;
};

/// One method at one value.
struct ScalingPoint {
  double value;
  double p50_ms, p99_ms;
  double success;  ///< share of the pairs
};

/// One method along one axis.
struct ScalingCurve {
  ScalingAxis axis;
  std::string method;
  std::vector<ScalingPoint> points;
  double exponent;  ///< least squares of log(p50) against log(value): 1 is linear
  double steepest;  ///< the same between neighbours, its largest
};

/// Pairs of rooms, offices, flats and corridors, each seen with every value of the axis.
std::vector<ScalingCurve> measure_scaling(ScalingAxis axis, const std::vector<BenchMethod>& methods,
                                          const ScalingSettings& settings);

/// Exponent b of y ~ x^b, least squares of the logarithms. NaN for fewer than two values.
double power_exponent(std::span<const double> x, std::span<const double> y);

std::string scaling_markdown(const std::vector<ScalingCurve>& curves);
std::string scaling_svg(const std::vector<ScalingCurve>& curves);

}  // namespace phasescan
