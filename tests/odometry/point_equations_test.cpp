#include "odometry/point_equations.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/random.hpp"

namespace phasescan::point_equations_test {
namespace {

TEST(PointEquations, AreThoseOfAPlainLoop) {
  for (const std::size_t count : {0u, 1u, 5u, 16u, 37u, 200u}) {
    Random random(count + 1);
    PointPartners p;
    p.reserve(count);
    p.count = count;
    const auto draw = [&](double low, double high) { return static_cast<float>(random.uniform(low, high)); };
    for (std::size_t i = 0; i < count; ++i) {
      const float angle = draw(-3.0, 3.0);
      p.nx[i] = std::cos(angle), p.ny[i] = std::sin(angle);
      p.rx[i] = draw(-5.0, 5.0), p.ry[i] = draw(-5.0, 5.0);
      p.dx[i] = draw(-0.2, 0.2), p.dy[i] = draw(-0.2, 0.2);
      p.variance[i] = draw(1e-5, 1e-3), p.normal_variance[i] = draw(1e-4, 1e-2);
    }
    // What lies behind the last one is no point.
    for (std::size_t i = count; i < p.rx.size(); ++i) p.variance[i] = 1.0F, p.nx[i] = 1.0F;
    const PointGate gate{0.1F, 0.15F, 4e-4F, 6.0F};
    double h[6] = {}, g[3] = {}, noise[6] = {}, squares = 0.0, efficiency = 0.0;
    int partners = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const double nx = static_cast<double>(p.nx[i]), ny = static_cast<double>(p.ny[i]),
                   dx = static_cast<double>(p.dx[i]), dy = static_cast<double>(p.dy[i]),
                   rx = static_cast<double>(p.rx[i]), ry = static_cast<double>(p.ry[i]);
      const double e = dx * nx + dy * ny, along = dy * nx - dx * ny;
      if (std::abs(e) > 0.1 || std::abs(along) > 0.15) continue;
      ++partners;
      const double sharp = static_cast<double>(p.variance[i]), variance = sharp + 4e-4;
      const double kernel = 1.0 / (1.0 + e * e / (6.0 * variance)), w = kernel * kernel / variance;
      const double j[3] = {nx, ny, rx * ny - ry * nx};
      const double t[3] = {ny, -nx, -(rx * nx + ry * ny)};
      for (int a = 0, k = 0; a < 3; ++a) {
        g[a] += w * j[a] * e;
        for (int b = a; b < 3; ++b, ++k) {
          h[k] += w * j[a] * j[b];
          noise[k] += w * static_cast<double>(p.normal_variance[i]) * t[a] * t[b];
        }
      }
      squares += e * e;
      efficiency += sharp / variance;
    }
    const PointSums sums = sum_point_equations(p, gate);
    EXPECT_EQ(sums.partners, partners) << count;
    const double scale = std::abs(h[0]) + std::abs(h[3]) + std::abs(h[5]) + 1e-9;
    for (int k = 0; k < 6; ++k) {
      EXPECT_NEAR(static_cast<double>(sums.H[k]), h[k], 1e-5 * scale) << count << " " << k;
      EXPECT_NEAR(static_cast<double>(sums.normal_noise[k]), noise[k], 1e-6 * scale) << count << " " << k;
    }
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(static_cast<double>(sums.g[k]), g[k], 1e-5 * scale) << count << " " << k;
    EXPECT_NEAR(static_cast<double>(sums.squares), squares, 1e-5 * squares + 1e-9);
    EXPECT_NEAR(static_cast<double>(sums.efficiency), efficiency, 1e-4 * efficiency + 1e-9);
  }
}

}  // namespace
}  // namespace phasescan::point_equations_test
