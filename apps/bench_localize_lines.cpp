#include "bench_localize_lines.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <nlohmann/json.hpp>

#include "eval/reliability_chart.hpp"
#include "phasescan/core/time.hpp"

namespace phasescan::app {
namespace {

double largest_sigma_m(const Eigen::Matrix3d& covariance) {
  const Eigen::Matrix2d position = covariance.topLeftCorner<2, 2>();
  return std::sqrt(std::max(0.0, Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(position).eigenvalues().maxCoeff()));
}

}  // namespace

std::string case_lines(const std::vector<LocalizeCase>& cases, const std::vector<LocalizeRow>& rows) {
  std::string text;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const LocalizationUpdate& u = rows[i].update;
    const PoseEstimate none{};
    const PoseEstimate& second = u.hypotheses.size() > 1 ? u.hypotheses[1] : none;
    const Pose2& truth = cases[i].T_map_base;
    nlohmann::ordered_json line{{"status", to_string(u.status)},
                                {"right", rows[i].right()},
                                {"mapped", rows[i].mapped},
                                {"named", rows[i].named},
                                {"error_m", rows[i].error_m},
                                {"error_deg", rad_to_deg(rows[i].error_rad)},
                                {"confidence", u.confidence},
                                {"second", second.confidence},
                                {"explained", u.fit.explained},
                                {"unmapped", u.fit.unmapped},
                                {"contradicting", u.fit.contradicting},
                                {"unknown", u.fit.unknown},
                                {"log_likelihood", u.fit.log_likelihood},
                                {"margin", u.margin},
                                {"sigma_x", std::sqrt(u.covariance(0, 0))},
                                {"sigma_y", std::sqrt(u.covariance(1, 1))},
                                {"sigma_m", largest_sigma_m(u.covariance)},
                                {"hits", cases[i].measurement.scan.hit_count()},
                                {"truth", {truth.x, truth.y, truth.theta}},
                                {"ms", rows[i].ms}};
    text += line.dump() + "\n";
  }
  return text;
}

std::string scan_line(const DrivenScan& scan) {
  const LocalizationUpdate& u = scan.update;
  const Pose2 pose = u.T_map_base.value_or(Pose2{1e3, 1e3, 0.0});
  const nlohmann::ordered_json line{{"stamp", stamp_to_seconds(u.stamp)},
                                    {"status", to_string(u.status)},
                                    {"mapped", scan.mapped},
                                    {"started", scan.started},
                                    {"error_m", translation_distance(pose, scan.T_map_base)},
                                    {"error_deg", rad_to_deg(angle_distance(pose.theta, scan.T_map_base.theta))},
                                    {"confidence", u.confidence},
                                    {"explained", u.fit.explained},
                                    {"unmapped", u.fit.unmapped},
                                    {"contradicting", u.fit.contradicting},
                                    {"unknown", u.fit.unknown},
                                    {"log_likelihood", u.fit.log_likelihood},
                                    {"margin", u.margin},
                                    {"hypotheses", u.hypotheses.size()},
                                    {"searched", u.searched},
                                    {"truth", {scan.T_map_base.x, scan.T_map_base.y, scan.T_map_base.theta}},
                                    {"pose", {pose.x, pose.y, pose.theta}}};
  return line.dump() + "\n";
}

std::string reliability_part(const std::vector<ReliabilityBin>& bins) {
  std::string text = ", \"reliability\": [";
  for (const ReliabilityBin& bin : bins)
    text += fmt::format("{}[{:.3f}, {:.3f}, {}]", text.back() == '[' ? "" : ", ", bin.confidence, bin.right, bin.n);
  return text + "]";
}

std::string reliability_figure(const std::vector<ReliabilityBin>& bins, double calibration_error) {
  std::size_t n = 0;
  for (const ReliabilityBin& bin : bins) n += bin.n;
  Chart chart = reliability_axes("Confidence of a pose on the map");
  Series points = reliability_points(bins);
  points.name = fmt::format("{} answers, calibration error {:.3f}", n, calibration_error);
  points.marker = Marker::kCircle;
  chart.series.push_back(std::move(points));
  return chart.svg(420.0, 460.0);
}

std::string number_or_null(double value, int digits) {
  return std::isfinite(value) ? fmt::format("{:.{}f}", value, digits) : "null";
}

}  // namespace phasescan::app
