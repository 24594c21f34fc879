// Fig. 12: maps straight from scans.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "eval/paper_tracks.hpp"
#include "scan/points.hpp"

namespace phasescan {
namespace {

constexpr double kCell_m = 0.05;

/// Where all maps are drawn: the square around everything that the true poses see.
struct Frame {
  double x0 = 0.0, y0 = 0.0;
  int cells = 1;
};

template <class Use>
void for_each_hit(const RecordedDrive& drive, std::size_t stride, const std::vector<Pose2>& poses, Use use) {
  ScanPoints points;
  for (std::size_t k = 0; k < poses.size(); ++k) {
    scan_to_points(drive.scans[k * stride], points);
    for (std::size_t i = 0; i < points.size(); ++i) use(poses[k] * Eigen::Vector2d(points.x[i], points.y[i]));
  }
}

Frame frame_of(const RecordedDrive& drive) {
  Eigen::Vector2d low(0, 0), high(0, 0);
  for_each_hit(drive, 1, drive.truth, [&](const Eigen::Vector2d& p) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  });
  const double side = std::max(high.x() - low.x(), high.y() - low.y()) + 0.6;
  const Eigen::Vector2d center = 0.5 * (low + high);
  return {center.x() - side / 2.0, center.y() - side / 2.0, static_cast<int>(std::ceil(side / kCell_m))};
}

Chart map_chart(const RecordedDrive& drive, std::size_t stride, const std::vector<Pose2>& poses,
                const std::vector<Pose2>& truth, const Frame& frame, const std::string& title) {
  std::vector<float> hits(static_cast<std::size_t>(frame.cells) * static_cast<std::size_t>(frame.cells), 0.0F);
  for_each_hit(drive, stride, poses, [&](const Eigen::Vector2d& p) {
    const int col = static_cast<int>(std::floor((p.x() - frame.x0) / kCell_m)),
              row = static_cast<int>(std::floor((p.y() - frame.y0) / kCell_m));
    if (col < 0 || row < 0 || col >= frame.cells || row >= frame.cells) return;
    hits[static_cast<std::size_t>(frame.cells - 1 - row) * static_cast<std::size_t>(frame.cells) +
         static_cast<std::size_t>(col)] += 1.0F;
  });
  Chart chart;
  chart.title = title;
  double worst = 0.0;
  for (std::size_t i = 0; i < poses.size(); ++i) worst = std::max(worst, translation_distance(poses[i], truth[i]));
  chart.subtitle = fmt::format("largest position error {} m", plain_number(worst, 2));
  chart.x.label = "x [m]";
  chart.y.label = "y [m]";
  chart.equal = true;
  chart.grid = false;
  chart.x.min = frame.x0;
  chart.y.min = frame.y0;
  chart.x.max = frame.x0 + frame.cells * kCell_m;
  chart.y.max = frame.y0 + frame.cells * kCell_m;
  const float full = stride == 1 ? 12.0F : 4.0F;  // hits from which a cell is drawn black
  for (float& h : hits) h = std::min(1.0F, h / full);
  chart.raster = Chart::Raster{std::move(hits), frame.cells, frame.cells, std::string(palette::kInk), 3};
  Series path;
  path.name = "estimated path";
  path.color = palette::kBlue;
  path.width = 1.6;
  Series stars;
  stars.kind = SeriesKind::kPoints;
  stars.name = "true places";
  stars.color = palette::kVermillion;
  stars.marker = Marker::kDiamond;
  stars.marker_size = 4.5;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    path.x.push_back(poses[i].x);
    path.y.push_back(poses[i].y);
    if (i % (stride == 1 ? 6 : 1) != 0) continue;
    stars.x.push_back(truth[i].x);
    stars.y.push_back(truth[i].y);
  }
  chart.series = {path, stars};
  return chart;
}

}  // namespace

void paper_maps(PaperKit& kit) {
  kit.report.heading("Fig. 12: maps straight from scans");
  kit.report.paragraph(
      "A tour at up to 0.3 m/s and 25 deg/s; every hit is drawn at the pose that the chain of matches gives. No "
      "filter, no loop "
      "closing, no motion correction.");
  const RecordedDrive drive = drive_tour(kit.options.seed + 1, 0.3, 25.0, kit.options.quick ? 8.0 : 16.0);
  const Frame frame = frame_of(drive);
  for (const std::size_t stride : {std::size_t{1}, std::size_t{6}}) {
    Figure figure;
    figure.columns = 3;
    figure.cell_width = 320.0;
    figure.cell_height = 350.0;
    std::vector<Pose2> truth;
    for (std::size_t i = 0; i < drive.truth.size(); i += stride) truth.push_back(drive.truth[i]);
    const auto add = [&](Variant variant, MatchMethod method) {
      const Track track = chain_matches(drive, kit.method(variant, method), stride);
      figure.charts.push_back(map_chart(
          drive, stride, track.estimate, track.truth, frame,
          fmt::format("{}, {}", to_string(method), variant == Variant::kPrinted ? "as printed" : "defaults")));
    };
    add(Variant::kPrinted, MatchMethod::kNdt);
    add(Variant::kPrinted, MatchMethod::kFftIcp2);
    figure.charts.push_back(map_chart(drive, stride, truth, truth, frame, "at the true poses"));
    add(Variant::kOurs, MatchMethod::kNdt);
    add(Variant::kOurs, MatchMethod::kFftIcp2);
    add(Variant::kOurs, MatchMethod::kGlobal);
    kit.figure(stride == 1 ? "fig12_maps_every_scan" : "fig12_maps_once_a_second", figure.svg(),
               fmt::format("Fig. 12: maps and paths, {}.",
                           stride == 1 ? "every scan matched with the one before" : "one match a second"));
  }
}

}  // namespace phasescan
