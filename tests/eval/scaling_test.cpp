#include "eval/scaling.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "support/xml_check.hpp"

namespace phasescan::scaling_test {
namespace {

TEST(Scaling, ThePowerIsFoundOfPowers) {
  const std::vector<double> x{90, 360, 4000};
  for (const double power : {0.0, 1.0, 1.7}) {
    std::vector<double> y;
    for (const double v : x) y.push_back(3.0 * std::pow(v, power));
    EXPECT_NEAR(power_exponent(x, y), power, 1e-9);
  }
  EXPECT_TRUE(std::isnan(power_exponent({}, {})));
}

TEST(Scaling, EveryValueIsMatchedAndDrawn) {
  ScalingSettings settings;
  settings.beams = {90, 500};
  settings.range_m = {2, 40};
  settings.pairs = 8;
  settings.repeat = 1;
  const std::vector<BenchMethod> methods = bench_methods("icp,global", {});
  std::vector<ScalingCurve> curves = measure_scaling(ScalingAxis::kBeams, methods, settings);
  ASSERT_EQ(curves.size(), 2u);
  for (ScalingCurve& curve : measure_scaling(ScalingAxis::kRange, methods, settings))
    curves.push_back(std::move(curve));
  for (const ScalingCurve& curve : curves) {
    ASSERT_EQ(curve.points.size(), 2u);
    EXPECT_GT(curve.points[0].p50_ms, 0.0);
    EXPECT_TRUE(std::isfinite(curve.exponent));
    if (curve.method == "global") {
      EXPECT_GE(curve.points[1].success, 0.75);
    }
  }
  EXPECT_EQ(xml_error(scaling_svg(curves)), "");
  EXPECT_NE(scaling_markdown(curves).find("| 500 |"), std::string::npos);
}

}  // namespace
}  // namespace phasescan::scaling_test
