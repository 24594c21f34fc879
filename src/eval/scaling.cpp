#include "eval/scaling.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "eval/pair_rows.hpp"
#include "report/chart.hpp"
#include "report/table.hpp"
#include "sim/pairs_spec.hpp"

namespace phasescan {
namespace {

constexpr double kUsualRange_m = 6.0;

sim::Shape scaled(sim::Shape shape, double scale) {
  for (sim::Segment& s : shape.segments) {
    s.a *= scale;
    s.b *= scale;
  }
  for (sim::Disc& d : shape.discs) {
    d.center *= scale;
    d.radius *= scale;
  }
  for (sim::Polygon& outline : shape.solids) {
    for (Eigen::Vector2d& corner : outline) corner *= scale;
  }
  return shape;
}

/// The pair as a sensor with that many beams, or with that reach in a place grown to it, sees it. In a grown place
/// people move no farther than before.
ScanPair seen_with(const sim::SimulatedPair& made, ScalingAxis axis, double value, Random& random) {
  sim::LidarOptions lidar = made.lidar;
  double scale = 1.0;
  if (axis == ScalingAxis::kBeams) {
    lidar.beams = static_cast<int>(value);
  } else {
    lidar.range_max_m = value;
    scale = value / kUsualRange_m;
  }
  Pose2 T_world_ref = made.T_world_ref, T_world_scan = made.T_world_scan;
  const double step = std::min(scale, 1.0);
  T_world_scan.x = scale * T_world_ref.x + step * (T_world_scan.x - T_world_ref.x);
  T_world_scan.y = scale * T_world_ref.y + step * (T_world_scan.y - T_world_ref.y);
  T_world_ref.x *= scale;
  T_world_ref.y *= scale;
  const sim::RayCaster caster(scaled(made.world.shape, scale));
  ScanPair pair = made.pair;
  pair.reference = sim::simulate_scan({&caster, nullptr}, lidar, T_world_ref, random);
  pair.scan = sim::simulate_scan({&caster, nullptr}, lidar, T_world_scan, random);
  pair.truth = T_world_ref.inverse() * T_world_scan;
  return pair;
}

const char* axis_label(ScalingAxis axis) {
  return axis == ScalingAxis::kBeams ? "beams of each scan" : "range of the sensor [m]";
}

}  // namespace

double power_exponent(std::span<const double> x, std::span<const double> y) {
  if (x.size() < 2) return std::numeric_limits<double>::quiet_NaN();
  const auto n = static_cast<double>(x.size());
  double u = 0.0, v = 0.0, uu = 0.0, uv = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double a = std::log(x[i]), b = std::log(y[i]);
    u += a / n;
    v += b / n;
    uu += a * a / n;
    uv += a * b / n;
  }
  return (uv - u * v) / (uu - u * u);
}

std::vector<ScalingCurve> measure_scaling(ScalingAxis axis, const std::vector<BenchMethod>& methods,
                                          const ScalingSettings& settings) {
  sim::PairsSpec spec = sim::read_pairs_spec("bench-sim");
  std::erase_if(spec.rows, [](const sim::PairRow& row) { return row.sensor != "rplidar-a1"; });
  const sim::PairGenerator generator(std::move(spec), settings.seed);
  std::vector<sim::SimulatedPair> made;
  for (std::size_t k = 0; k < settings.pairs; ++k) made.push_back(generator.make(k));

  std::vector<ScalingCurve> curves;
  for (const BenchMethod& method : methods) curves.push_back({axis, method.name, {}, 0.0, 0.0});
  const std::vector<double>& values = axis == ScalingAxis::kBeams ? settings.beams : settings.range_m;
  for (const double value : values) {
    Random random(settings.seed);
    std::vector<ScanPair> pairs;
    for (const sim::SimulatedPair& pair : made) pairs.push_back(seen_with(pair, axis, value, random));
    BenchSettings bench;
    bench.repeat = settings.repeat;
    const BenchRun run = run_bench(pair_source(pairs), methods, bench);
    for (std::size_t m = 0; m < methods.size(); ++m) {
      std::vector<const PairOutcome*> of_method;
      for (const PairOutcome& o : run.outcomes) {
        if (o.method == m) of_method.push_back(&o);
      }
      const BenchRow row = sum_up(of_method);
      curves[m].points.push_back({value, row.times[0].p50, row.times[0].p99, row.success()});
    }
  }
  for (ScalingCurve& curve : curves) {
    std::vector<double> x, y;
    for (const ScalingPoint& p : curve.points) {
      x.push_back(p.value);
      y.push_back(p.p50_ms);
    }
    curve.exponent = power_exponent(x, y);
    curve.steepest = -std::numeric_limits<double>::infinity();
    for (std::size_t i = 1; i < x.size(); ++i) {
      curve.steepest =
          std::max(curve.steepest, power_exponent(std::span(x).subspan(i - 1, 2), std::span(y).subspan(i - 1, 2)));
    }
  }
  return curves;
}

std::string scaling_markdown(const std::vector<ScalingCurve>& curves) {
  std::string out;
  for (const ScalingCurve& curve : curves) {
    Table table{fmt::format("{}, time against {}: p50 ~ x^{} over all values, x^{} where it is steepest", curve.method,
                            axis_label(curve.axis), fixed(curve.exponent, 2), fixed(curve.steepest, 2)),
                {axis_label(curve.axis), "p50 [ms]", "p99 [ms]", "success [%]"},
                {},
                0};
    for (const ScalingPoint& p : curve.points)
      table.rows.push_back({fmt::format("{}", p.value), fixed(p.p50_ms, 3), fixed(p.p99_ms, 3), percent(p.success)});
    out += (out.empty() ? "" : "\n") + table.markdown();
  }
  return out;
}

std::string scaling_svg(const std::vector<ScalingCurve>& curves) {
  Figure figure;
  figure.title = "CPU time of a match";
  figure.cell_width = 420.0;
  double least = std::numeric_limits<double>::infinity(), most = 0.0;
  for (const ScalingCurve& curve : curves) {
    for (const ScalingPoint& p : curve.points) {
      least = std::min(least, p.p50_ms);
      most = std::max(most, p.p99_ms);
    }
  }
  for (const ScalingAxis axis : {ScalingAxis::kBeams, ScalingAxis::kRange}) {
    Chart chart;
    chart.title = axis == ScalingAxis::kBeams ? "against the number of beams" : "against the size of the place";
    chart.x.label = axis_label(axis);
    chart.y.label = "ms";
    chart.x.log = chart.y.log = true;
    chart.y.min = 0.5 * least;
    chart.y.max = 2.0 * most;
    std::size_t m = 0;
    for (const ScalingCurve& curve : curves) {
      if (curve.axis != axis) continue;
      Series median, tail;
      median.name = curve.method + ", median";
      tail.name = curve.method + ", 99 %";
      for (const ScalingPoint& p : curve.points) {
        median.x.push_back(p.value);
        median.y.push_back(p.p50_ms);
        tail.y.push_back(p.p99_ms);
      }
      tail.x = median.x;
      median.color = tail.color = method_color(curve.method, m);
      median.marker = method_marker(curve.method, m);
      tail.dash = "2 3";
      ++m;
      if (axis == ScalingAxis::kBeams && m == 1 && !curve.points.empty()) {
        const double from = std::max(median.x.front(), median.x.back() * 0.6 * least / median.y.back()),
                     to = median.x.back();
        Series linear{SeriesKind::kLine, "linear", {from, to}, {median.y.back() * from / to, median.y.back()}};
        linear.color = std::string(palette::kGrey);
        linear.dash = "4 3";
        chart.series.push_back(std::move(linear));
      }
      chart.series.push_back(std::move(median));
      chart.series.push_back(std::move(tail));
    }
    if (!chart.series.empty()) figure.charts.push_back(std::move(chart));
  }
  return figure.svg();
}

}  // namespace phasescan
