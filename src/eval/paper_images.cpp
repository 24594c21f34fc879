// Fig. 2 (environment, raw scan, scan image) and Fig. 3 (missing-data features).
#include <fmt/format.h>

#include <cmath>

#include "eval/paper_kit.hpp"
#include "fft_icp/image/rasterize.hpp"
#include "report/chart.hpp"
#include "fft_icp/missing/missing.hpp"

namespace phasescan {
namespace {

Series outline(const sim::Shape& shape, const Pose2& T_laser_world) {
  Series s;
  s.color = palette::kGrey;
  s.width = 1.2;
  const auto add = [&](const Eigen::Vector2d& p) {
    const Eigen::Vector2d q = T_laser_world * p;
    s.x.push_back(q.x());
    s.y.push_back(q.y());
  };
  const auto lift_pen = [&] {
    s.x.push_back(std::nan(""));
    s.y.push_back(std::nan(""));
  };
  for (const sim::Segment& segment : shape.segments) {
    add(segment.a);
    add(segment.b);
    lift_pen();
  }
  for (const sim::Disc& disc : shape.discs) {
    for (int i = 0; i <= 24; ++i) {
      add(disc.center + disc.radius * Eigen::Vector2d(std::cos(kTwoPi * i / 24), std::sin(kTwoPi * i / 24)));
    }
    lift_pen();
  }
  return s;
}

Series hits(const Scan& scan, std::string_view color, double diameter) {
  ScanPoints points;
  scan_to_points(scan, points);
  Series s;
  s.kind = SeriesKind::kDots;
  s.color = color;
  s.width = diameter;
  s.x.assign(points.x.begin(), points.x.end());
  s.y.assign(points.y.begin(), points.y.end());
  return s;
}

/// A sector of the sensor's view as a closed outline that a band can fill: its upper and lower edge would cross, so it
/// is drawn as many thin rays.
Series sector(const MissingRun& run, double radius) {
  Series s;
  s.color = palette::kOrange;
  s.width = 2.0;
  s.opacity = 0.55;
  const int rays = std::max(2, static_cast<int>(run.width / deg_to_rad(0.8)));
  for (int i = 0; i <= rays; ++i) {
    const double angle = run.start + run.width * i / rays;
    s.x.insert(s.x.end(), {0.0, radius * std::cos(angle), std::nan("")});
    s.y.insert(s.y.end(), {0.0, radius * std::sin(angle), std::nan("")});
  }
  return s;
}

void limit(Chart& chart, double reach) {
  chart.equal = true;
  chart.x.min = chart.y.min = -reach;
  chart.x.max = chart.y.max = reach;
}

/// Among the first pairs in corridors, where much is out of range, the one whose reference misses most: the paper's
/// Fig. 3.
sim::SimulatedPair pair_with_most_missing(const PaperKit& kit, const PaperPairs& pairs) {
  std::optional<sim::SimulatedPair> best;
  double most = -1.0;
  for (std::size_t k = 0, seen = 0; k < pairs.count && seen < 20; ++k) {
    if (pairs.generator->spec().rows[k % pairs.generator->spec().rows.size()].dataset != "sim-corridor") continue;
    ++seen;
    sim::SimulatedPair made = pairs.generator->make(k);
    const double size = missing_features(made.pair.reference, kit.ours).size;
    if (size <= most) continue;
    most = size;
    best = std::move(made);
  }
  return best ? std::move(*best) : pairs.generator->make(0);
}

Chart image_chart(const Scan& scan, const AnyMatchOptions& options, int size, const std::string& title) {
  ScanPoints points;
  scan_to_points(scan, points);
  std::vector<float> scratch;
  const ImageGrid grid = choose_grid(points, options.image, size, scratch);
  Rasterizer rasterizer(options.image.blur_px);
  Image image;
  rasterizer.draw(points, 0.0, grid, image);
  float brightest = 1e-9F;
  for (const float v : image.pixels()) brightest = std::max(brightest, v);
  Chart chart;
  chart.title = title;
  chart.subtitle = fmt::format("{0} x {0} px, dmax {1} m", size, plain_number(grid.dmax_m, 2));
  limit(chart, grid.dmax_m);
  chart.grid = false;
  chart.x.label = "x [m]";
  chart.y.label = "y [m]";
  Chart::Raster raster;
  raster.rows = image.rows();
  raster.cols = image.cols();
  raster.levels = options.image.blur_px > 0.0 ? 12 : 1;
  for (int row = image.rows() - 1; row >= 0; --row) {  // row 0 of an image is its lowest y, row 0 of a raster its top
    for (int col = 0; col < image.cols(); ++col) {
      const float share = image.at(row, col) / brightest;
      raster.values.push_back(share < 0.03F ? 0.0F
                                            : std::sqrt(share));  // faint lines show, the tail of a blur does not
    }
  }
  chart.raster = std::move(raster);
  return chart;
}

}  // namespace

void paper_images(PaperKit& kit, const PaperPairs& pairs) {
  const sim::SimulatedPair made = pair_with_most_missing(kit, pairs);
  const Scan& scan = made.pair.reference;
  kit.report.heading("Fig. 2, 3: scan, image, missing data");

  Figure figure;
  figure.columns = 2;
  figure.cell_width = figure.cell_height = 380.0;
  figure.shared_legend = false;
  Chart scene;
  scene.title = "(a) The sensor in its environment";
  scene.x.label = "x [m]";
  scene.y.label = "y [m]";
  limit(scene, 7.0);
  scene.series = {outline(made.world.shape, made.T_world_ref.inverse()), hits(scan, palette::kVermillion, 3.0)};
  scene.series[0].name = "surfaces";
  scene.series[1].name = "hits of the scan";
  Chart raw;
  raw.title = "(b) Raw scan data";
  raw.x.label = "direction [deg]";
  raw.y.label = "range [m]";
  raw.y.min = 0.0;
  raw.x.min = -180.0;
  raw.x.max = 180.0;
  Series ranges;
  ranges.kind = SeriesKind::kDots;
  ranges.color = palette::kVermillion;
  ranges.width = 2.6;
  Series missing = ranges;
  missing.color = palette::kInk;
  ranges.name = "range";
  missing.name = "no return (drawn at 0)";
  for (std::size_t i = 0; i < scan.size(); ++i) {
    Series& to = scan.is_hit(i) ? ranges : missing;
    to.x.push_back(rad_to_deg(wrap_angle(scan.angle(i))));
    to.y.push_back(scan.is_hit(i) ? static_cast<double>(scan.ranges[i]) : 0.0);
  }
  raw.series = {ranges, missing};
  figure.charts = {scene, raw, image_chart(scan, kit.printed, kit.printed.image.size, "(c) Scan image as printed"),
                   image_chart(scan, kit.ours, kit.ours.image.size, "(d) Scan image, our defaults")};
  kit.figure("fig02_scan_image", figure.svg(),
             "Fig. 2: a simulated A1 in a corridor, its raw data and its scan image. Our image reaches farther and is "
             "blurred by a "
             "pixel.");

  Figure third;
  third.columns = 2;
  third.cell_width = third.cell_height = 380.0;
  third.shared_legend = false;
  for (const Variant variant : {Variant::kPrinted, Variant::kOurs}) {
    const AnyMatchOptions& options = kit.options_of(variant);
    const MissingFeatures f = missing_features(scan, options);
    Chart chart;
    chart.title = fmt::format("Features, {}", variant_name(variant));
    chart.subtitle = fmt::format("{} runs, |f| = {} deg", f.runs.size(), plain_number(rad_to_deg(f.size), 1));
    chart.x.label = "x [m]";
    chart.y.label = "y [m]";
    limit(chart, 6.5);
    for (std::size_t i = 0; i < f.runs.size(); ++i) {
      chart.series.push_back(sector(f.runs[i], 6.0));
      if (i == 0) chart.series.back().name = "missing-data feature";
      const double at = f.runs[i].centre();
      chart.notes.push_back(
          {4.2 * std::cos(at),
           4.2 * std::sin(at),
           fmt::format("{} / {} deg", plain_number(rad_to_deg(at), 0), plain_number(rad_to_deg(f.runs[i].width), 0)),
           {10.0, TextAnchor::kMiddle, std::string(palette::kInk), true, 0.0, true}});
    }
    chart.series.push_back(hits(scan, palette::kInk, 2.6));
    chart.series.back().name = "hits";
    third.charts.push_back(std::move(chart));
  }
  kit.figure("fig03_missing_data", third.svg(),
             "Fig. 3: the missing-data features (centre / width) of the same scan. As printed, a return beyond dmax "
             "counts as missing.");
}

}  // namespace phasescan
