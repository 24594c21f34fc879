#include "report/scan_plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "scan/points.hpp"

namespace phasescan {
namespace {

Series scan_series(const Scan& scan, const Pose2& T_ref_scan, const std::string& name, std::string_view color,
                   double diameter) {
  ScanPoints points;
  scan_to_points(scan, points);
  Series s;
  s.kind = SeriesKind::kDots;
  s.name = name;
  s.color = color;
  s.width = diameter;
  s.opacity = 0.85;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector2d p = T_ref_scan * Eigen::Vector2d(points.x[i], points.y[i]);
    s.x.push_back(p.x());
    s.y.push_back(p.y());
  }
  return s;
}

/// A small arrow head where a sensor stands, pointing along its x axis; `size` in metres.
Series sensor_series(const Pose2& T_ref_sensor, std::string_view color, double size) {
  Series s;
  s.color = color;
  s.width = 1.6;
  for (const Eigen::Vector2d& corner :
       {Eigen::Vector2d(1.0, 0.0), Eigen::Vector2d(-0.7, 0.6), Eigen::Vector2d(-0.3, 0.0), Eigen::Vector2d(-0.7, -0.6),
        Eigen::Vector2d(1.0, 0.0)}) {
    const Eigen::Vector2d p = T_ref_sensor * (size * corner).eval();
    s.x.push_back(p.x());
    s.y.push_back(p.y());
  }
  return s;
}

double extent(const Series& s) {
  if (s.x.empty()) return 1.0;
  const auto [x0, x1] = std::minmax_element(s.x.begin(), s.x.end());
  const auto [y0, y1] = std::minmax_element(s.y.begin(), s.y.end());
  return std::max({*x1 - *x0, *y1 - *y0, 1.0});
}

}  // namespace

std::string error_text(const Pose2& T_ref_scan, const Pose2& truth) {
  return fmt::format("error {:.3f} m, {:.2f} deg", translation_distance(T_ref_scan, truth),
                     rad_to_deg(angle_distance(T_ref_scan.theta, truth.theta)));
}

std::string pose_text(const Pose2& pose) {
  return fmt::format("x {} m, y {} m, {} deg", plain_number(pose.x, 3), plain_number(pose.y, 3),
                     plain_number(rad_to_deg(pose.theta), 2));
}

Chart scan_pair_chart(const Scan& reference, const Scan& scan, const Pose2& T_ref_scan, const std::string& title) {
  Chart chart;
  chart.title = title;
  chart.equal = true;
  chart.x.label = "x [m]";
  chart.y.label = "y [m]";
  Series ref = scan_series(reference, {}, "reference", palette::kInk, 2.6);
  const double size = 0.025 * extent(ref);
  chart.series.push_back(std::move(ref));
  chart.series.push_back(scan_series(scan, T_ref_scan, "scan", palette::kVermillion, 2.6));
  chart.series.push_back(sensor_series({}, palette::kInk, size));
  chart.series.push_back(sensor_series(T_ref_scan, palette::kVermillion, size));
  return chart;
}

std::string scan_pair_svg(const Scan& reference, const Scan& scan, const MatchResult& result,
                          const std::optional<Pose2>& truth, const Pose2& guess, const std::string& title) {
  Figure figure;
  figure.title = title;
  figure.cell_width = 340.0;
  figure.cell_height = 340.0;
  const auto add = [&](const Pose2& pose, const std::string& name, const std::string& note) {
    Chart chart = scan_pair_chart(reference, scan, pose, name);
    chart.subtitle = note;
    figure.charts.push_back(std::move(chart));
  };
  add(guess, "Before", truth ? error_text(guess, *truth) : pose_text(guess));
  const auto note = [&](const Pose2& pose, const std::optional<double>& confidence) {
    const std::string where = truth ? error_text(pose, *truth) : pose_text(pose);
    return confidence ? fmt::format("confidence {:.3f}; {}", *confidence, where) : where;
  };
  add(result.T_ref_scan,
      result.usable ? "After: usable" : "After: not usable, " + std::string(to_string(result.status)),
      note(result.T_ref_scan, result.confidence));
  for (std::size_t i = 0; i < std::min<std::size_t>(2, result.alternatives.size()); ++i) {
    const MatchAlternative& other = result.alternatives[i];
    add(other.T_ref_scan, fmt::format("Alternative {}", i + 1), note(other.T_ref_scan, other.confidence));
  }
  figure.columns = figure.charts.size() == 3 ? 3 : 2;
  return figure.svg();
}

}  // namespace phasescan
