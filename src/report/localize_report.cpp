#include "report/localize_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "output/map_file.hpp"
#include "report/chart.hpp"
#include "report/html.hpp"
#include "report/slam_report.hpp"
#include "report/svg.hpp"

namespace phasescan {
namespace {

constexpr double kMapFigureWidth = 900.0;
constexpr std::size_t kMostMarks = 6000, kMostHypotheses = 3000;
constexpr double kLongStepM = 1.0;  // poses farther apart are not joined by a line

std::string_view color_of(TrackingStatus status) {
  switch (status) {
    case TrackingStatus::kOk:
      return palette::kBlue;
    case TrackingStatus::kDegraded:
      return palette::kOrange;
    case TrackingStatus::kAmbiguous:
      return palette::kPurple;
    default:
      return palette::kVermillion;
  }
}

class Picture {
 public:
  explicit Picture(const TrinaryMap& map) : T_grid_map_(map.origin.inverse()) {
    const double width_m = map.width * map.resolution_m;
    height_m_ = map.height * map.resolution_m;
    scale_ = std::min(kMapFigureWidth / width_m, 1.4 * kMapFigureWidth / height_m_);
    body_ = fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0:.0f} {1:.0f}\" width=\"{0:.0f}\" height=\"{1:.0f}\">"
        "<image x=\"0\" y=\"0\" width=\"{0:.0f}\" height=\"{1:.0f}\" style=\"image-rendering:pixelated\" href=\"data:image/png;base64,{2}\"/>",
        width_m * scale_, height_m_ * scale_, base64(format_png(map)));
  }
  void line(const Pose2& a, const Pose2& b, std::string_view color) {
    const Eigen::Vector2d p = at(a), q = at(b);
    body_ += fmt::format("<path d=\"M{:.1f} {:.1f}L{:.1f} {:.1f}\" stroke=\"{}\" stroke-width=\"1.6\"/>", p.x(), p.y(),
                         q.x(), q.y(), color);
  }
  void dot(const Pose2& pose, std::string_view color, double radius, double opacity) {
    const Eigen::Vector2d p = at(pose);
    body_ += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{:.1f}\" fill=\"{}\" fill-opacity=\"{:.2f}\"/>",
                         p.x(), p.y(), radius, color, opacity);
  }
  std::string str() const { return body_ + "</svg>"; }

 private:
  Eigen::Vector2d at(const Pose2& pose) const {
    const Eigen::Vector2d p = T_grid_map_ * pose.translation();
    return {p.x() * scale_, (height_m_ - p.y()) * scale_};
  }
  Pose2 T_grid_map_;
  double height_m_ = 0.0, scale_ = 1.0;
  std::string body_;
};

std::string map_figure(const LocalizeReport& report) {
  Picture picture(*report.map);
  const std::vector<LocalizationUpdate>& updates = *report.updates;
  const std::size_t stride = std::max<std::size_t>(1, updates.size() / kMostMarks);
  std::size_t drawn = 0;
  for (std::size_t i = 0; i < updates.size(); i += stride) {
    if (updates[i].status != TrackingStatus::kAmbiguous) continue;
    for (const PoseEstimate& h : updates[i].hypotheses) {
      if (drawn++ < kMostHypotheses) picture.dot(h.T_map_base, palette::kPurple, 1.6, 0.35);
    }
  }
  const LocalizationUpdate* last = nullptr;
  for (std::size_t i = 0; i < updates.size(); i += stride) {
    const LocalizationUpdate& u = updates[i];
    if (!u.T_map_base || u.status == TrackingStatus::kAmbiguous) continue;
    const bool joined = !report.each && last != nullptr && stride == 1 &&
                        translation_distance(*last->T_map_base, *u.T_map_base) < kLongStepM;
    if (joined) picture.line(*last->T_map_base, *u.T_map_base, color_of(u.status));
    picture.dot(*u.T_map_base, color_of(u.status), joined ? 0.8 : 2.2, 1.0);
    last = &u;
  }
  return picture.str();
}

std::string confidence_chart(const LocalizeReport& report) {
  Chart chart;
  chart.title = "Probability that the pose is within 0.1 m and 3 deg";
  chart.x.label = "scan";
  chart.y.min = 0.0;
  chart.y.max = 1.0;
  const std::vector<LocalizationUpdate>& updates = *report.updates;
  const std::size_t stride = std::max<std::size_t>(1, updates.size() / 1500);
  Series confidence, explained, least;
  confidence.name = "probability";
  explained.name = "share of the hits on the map's surfaces";
  least.name = "ok above this";
  least.dash = "4 3";
  for (std::size_t i = 0; i < updates.size(); i += stride) {
    confidence.x.push_back(static_cast<double>(i));
    confidence.y.push_back(updates[i].confidence);
    explained.x.push_back(static_cast<double>(i));
    explained.y.push_back(updates[i].fit.explained);
  }
  least.x = {0.0, static_cast<double>(updates.size())};
  least.y = {report.min_confidence, report.min_confidence};
  chart.series = {confidence, explained, least};
  return chart.svg(900, 280);
}

Table table_of(const std::vector<std::pair<std::string, std::string>>& rows) {
  Table table;
  table.header = {"what", "value"};
  table.text_columns = 2;
  for (const auto& [name, value] : rows) table.rows.push_back({name, value});
  return table;
}

}  // namespace

std::string format_localize_report(const LocalizeReport& report) {
  HtmlReport html("Localisation of " + report.log_name,
                  "Where the scans of the log lie on a map that was known before.");
  html.heading("Verdict");
  html.paragraph(report.verdict);
  if (!report.reasons.empty()) html.bullets(report.reasons);
  html.heading("Map");
  html.figure(
      map_figure(report),
      "Blue: ok, orange: degraded, red: lost. Purple: poses that explain a scan about as well as each other, while "
      "the place was ambiguous.");
  html.table(table_of(report.facts));
  if (!report.updates->empty()) {
    html.heading("Confidence over time");
    html.figure(confidence_chart(report), "Scan by scan.");
  }
  html.heading("Warnings");
  if (report.warnings.empty())
    html.paragraph("None.");
  else
    html.bullets(report.warnings);
  if (!report.times.empty()) {
    html.heading("Times");
    html.table(table_of(report.times));
  }
  return html.str();
}

}  // namespace phasescan
