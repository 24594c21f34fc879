#include "report/slam_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "output/map_file.hpp"
#include "report/chart.hpp"
#include "report/html.hpp"
#include "report/svg.hpp"

namespace phasescan {
namespace {

constexpr std::size_t kMostPoints = 4000;  // of a line in a figure
constexpr std::size_t kMostLoops = 2000;   // in a figure
constexpr double kFigureWidth = 900.0;

/// A picture of the map with ways over it, in px of `scale` per metre.
class MapPicture {
 public:
  explicit MapPicture(const TrinaryMap& map) : map_(map) {
    width_m_ = map.width * map.resolution_m;
    height_m_ = map.height * map.resolution_m;
    scale_ = kFigureWidth / std::max(width_m_, 1e-6);
    scale_ = std::min(scale_, 1.4 * kFigureWidth / std::max(height_m_, 1e-6));
    body_ = fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0:.0f} {1:.0f}\" width=\"{0:.0f}\" height=\"{1:.0f}\">"
        "<image x=\"0\" y=\"0\" width=\"{0:.0f}\" height=\"{1:.0f}\" style=\"image-rendering:pixelated\" href=\"data:image/png;base64,{2}\"/>",
        width_m_ * scale_, height_m_ * scale_, base64(format_png(map)));
  }

  /// Those stretches of a way whose `flags` are `wanted`; without flags all of it, as one that is wanted.
  void way(std::span<const Pose2> poses, std::span<const char> flags, bool wanted, const Stroke& stroke) {
    const std::size_t stride = std::max<std::size_t>(1, poses.size() / kMostPoints);
    const auto is_wanted = [&](std::size_t i) { return (i >= flags.size() || flags[i] != 0) == wanted; };
    for (std::size_t begin = 0; begin < poses.size();) {
      std::size_t end = begin;
      while (end < poses.size() && is_wanted(end) == is_wanted(begin)) ++end;
      if (is_wanted(begin)) {
        body_ +=
            fmt::format("<polyline fill=\"none\" stroke=\"{}\" stroke-width=\"{}\"{} points=\"", stroke.color,
                        stroke.width, stroke.dash.empty() ? "" : fmt::format(" stroke-dasharray=\"{}\"", stroke.dash));
        for (std::size_t i = begin; i < end; i += stride)
          body_ += fmt::format("{:.1f},{:.1f} ", px(poses[i].x), py(poses[i].y));
        body_ += "\"/>";
      }
      begin = end;
    }
  }

  void link(const Pose2& a, const Pose2& b, std::string_view color) {
    body_ += fmt::format(
        "<path d=\"M{:.1f} {:.1f}L{:.1f} {:.1f}\" stroke=\"{}\" stroke-width=\"1.2\" stroke-opacity=\"0.6\"/>", px(a.x),
        py(a.y), px(b.x), py(b.y), color);
  }

  void pane(const GlassPane& pane) {
    body_ += fmt::format(
        "<path d=\"M{:.1f} {:.1f}L{:.1f} {:.1f}\" stroke=\"{}\" stroke-width=\"4\" stroke-opacity=\"{}\"{}/>",
        px(pane.a.x()), py(pane.a.y()), px(pane.b.x()), py(pane.b.y()),
        pane.kind == GlassKind::kGlass ? palette::kSky : palette::kPurple, pane.sure ? "1" : "0.7",
        pane.sure ? "" : " stroke-dasharray=\"4 3\"");
  }

  /// A numbered ring.
  void mark(double x, double y, std::size_t number) {
    body_ += fmt::format(
        "<circle cx=\"{0:.1f}\" cy=\"{1:.1f}\" r=\"9\" fill=\"none\" stroke=\"{2}\" stroke-width=\"2.5\"/>"
        "<text x=\"{0:.1f}\" y=\"{3:.1f}\" font-size=\"14\" text-anchor=\"middle\" fill=\"{2}\">{4}</text>",
        px(x), py(y), palette::kVermillion, py(y) - 13.0, number);
  }

  std::string str() const { return body_ + "</svg>"; }

 private:
  double px(double x) const { return (x - map_.origin.x) * scale_; }
  double py(double y) const { return (height_m_ - (y - map_.origin.y)) * scale_; }
  const TrinaryMap& map_;
  double width_m_ = 0.0, height_m_ = 0.0, scale_ = 1.0;
  std::string body_;
};

Series thinned(std::span<const float> values, const char* name) {
  // The worst of each stretch is what matters.
  Series series;
  series.name = name;
  series.width = 1.0;
  const std::size_t stretch = std::max<std::size_t>(1, values.size() / 1500);
  for (std::size_t i = 0; i < values.size(); i += stretch) {
    const auto part = values.subspan(i, std::min(stretch, values.size() - i));
    series.x.push_back(static_cast<double>(i));
    series.y.push_back(static_cast<double>(*std::min_element(part.begin(), part.end())));
  }
  return series;
}

std::string overlap_chart(std::span<const float> overlap) {
  Chart chart;
  chart.title = "Share of each scan that lies on the map so far";
  chart.x.label = "scan";
  chart.y.label = "share";
  chart.y.min = 0.0;
  chart.y.max = 1.0;
  chart.legend = LegendPlace::kNone;
  chart.series.push_back(thinned(overlap, ""));
  return chart.svg(900, 260);
}

std::string time_chart(std::span<const float> cpu_ms) {
  Chart chart;
  chart.title = "CPU time per scan, most of each stretch";
  chart.x.label = "scan";
  chart.y.label = "ms";
  chart.y.from_zero = true;
  chart.legend = LegendPlace::kNone;
  std::vector<float> negative(cpu_ms.begin(), cpu_ms.end());
  for (float& v : negative) v = -v;
  Series series = thinned(negative, "");
  for (double& v : series.y) v = -v;
  chart.series.push_back(std::move(series));
  return chart.svg(900, 260);
}

std::string correction_chart(const SlamResult& result) {
  Chart chart;
  chart.title = "How far the loops moved each scan";
  chart.x.label = "scan";
  chart.y.label = "m";
  chart.y.from_zero = true;
  chart.legend = LegendPlace::kNone;
  std::vector<float> moved;
  for (const ScanResult& scan : result.scans)
    moved.push_back(static_cast<float>(translation_distance(scan.T_map_base, scan.T_odom_base)));
  chart.series.push_back(thinned(moved, ""));
  return chart.svg(900, 260);
}

/// What the colours of panes mean, and how many there are of each.
std::string glass_legend(std::span<const GlassPane> panes) {
  std::string text;
  for (const GlassKind kind : {GlassKind::kGlass, GlassKind::kBlack}) {
    int sure = 0, possible = 0;
    double metres = 0.0;
    for (const GlassPane& pane : panes) {
      if (pane.kind != kind) continue;
      ++(pane.sure ? sure : possible);
      if (pane.sure) metres += pane.length();
    }
    if (sure + possible == 0) continue;
    text +=
        fmt::format("{}{}: {} ({:.1f} m)", text.empty() ? "" : " ",
                    kind == GlassKind::kGlass ? "Light blue, glass" : "Purple, black or glossy surfaces", sure, metres);
    text += possible > 0 ? fmt::format(", dashed: {} more that are only possible.", possible) : ".";
  }
  return text;
}

/// The way as it is drawn over a map: poses, and which of them stand on the map.
struct Way {
  std::vector<Pose2> poses;
  std::vector<char> on_map;
};

/// The verdict on top, its reasons numbered as they are on the map.
void add_verdict(const SlamReport& report, HtmlReport& html) {
  html.heading("Verdict");
  html.paragraph(report.verdict);
  std::vector<std::string> lines;
  for (const VerdictReason& reason : report.reasons)
    lines.push_back(fmt::format("{}. {}: {}", lines.size() + 1, reason.kind, reason.text));
  if (!lines.empty()) html.bullets(lines);
}

/// The map with the way on it and what lies off it.
void add_map(const SlamReport& report, const Way& way, HtmlReport& html) {
  const SlamResult& result = *report.result;
  MapPicture picture(result.map);
  for (const GlassPane& pane : result.glass) picture.pane(pane);
  picture.way(way.poses, way.on_map, false, {std::string(palette::kMuted), 1.2, "5 4"});
  picture.way(way.poses, way.on_map, true, {std::string(palette::kBlue), 1.5});
  std::size_t number = 0;
  for (const VerdictReason& reason : report.reasons) {
    ++number;
    if (reason.x && reason.y) picture.mark(*reason.x, *reason.y, number);
  }
  std::string caption = "White: free, black: occupied, grey: unknown. Blue: the way of the robot.";
  if (const std::size_t left_out = result.scans_off_the_map(); left_out > 0) {
    caption += fmt::format(
        " Dashed: {} scans that nothing ties to this map; it is not drawn from them, and where they lie is a guess.",
        left_out);
  }
  if (!result.glass.empty()) caption += " " + glass_legend(result.glass);
  html.figure(picture.str(), caption);
}

/// The ways before and after loops, with the loops between keyframes that are drawn.
void add_loops(const SlamResult& result, const Way& way, HtmlReport& html) {
  MapPicture picture(result.map);
  picture.way(result.odometry_trajectory(), way.on_map, true, {std::string(palette::kOrange), 1.2});
  picture.way(way.poses, way.on_map, true, {std::string(palette::kBlue), 1.2});
  const auto index = [](std::int32_t k) { return static_cast<std::size_t>(k); };
  const auto is_drawn = [&](const MapEdge& e) {
    return e.loop && result.drawn[index(e.from)] && result.drawn[index(e.to)];
  };
  const auto link = [&](const MapEdge& e, std::string_view color) {
    picture.link(result.keyframes[index(e.from)].T_map_base, result.keyframes[index(e.to)].T_map_base, color);
  };
  const auto holds = [&](const MapEdge& e) { return e.enabled && is_drawn(e); };
  const auto loops = static_cast<std::size_t>(std::count_if(result.edges.begin(), result.edges.end(), holds));
  const std::size_t stride = std::max<std::size_t>(1, loops / kMostLoops);
  std::size_t n = 0;
  for (const MapEdge& e : result.edges) {
    if (holds(e) && n++ % stride == 0) link(e, palette::kGreen);
  }
  for (const MapEdge& e : result.edges) {
    if (!e.enabled && is_drawn(e)) link(e, palette::kVermillion);
  }
  html.figure(
      picture.str(),
      "Orange: the way before loops (laser odometry alone), blue: with them. Green: loops that hold, red: loops that were taken out again.");
}

}  // namespace

std::string base64(std::string_view bytes) {
  static constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const auto byte = [&](std::size_t k) {
      return k < bytes.size() ? static_cast<unsigned>(static_cast<unsigned char>(bytes[k])) : 0U;
    };
    const unsigned three = byte(i) << 16 | byte(i + 1) << 8 | byte(i + 2);
    out += kDigits[three >> 18 & 63];
    out += kDigits[three >> 12 & 63];
    out += i + 1 < bytes.size() ? kDigits[three >> 6 & 63] : '=';
    out += i + 2 < bytes.size() ? kDigits[three & 63] : '=';
  }
  return out;
}

std::string format_slam_report(const SlamReport& report) {
  const SlamResult& result = *report.result;
  Way way{result.trajectory(), {}};
  for (const ScanResult& scan : result.scans) way.on_map.push_back(static_cast<char>(scan.on_map));
  HtmlReport html("Map of " + report.log_name, "Trajectory and map that phasescan slam made of the log.");
  if (!report.complete)
    html.paragraph(
        fmt::format("Stopped before the end of the log: all of this is of its first {} scans.", result.scans.size()));
  if (!report.verdict.empty()) add_verdict(report, html);
  html.heading("Map");
  if (report.shown != nullptr) html.raw(map_viewer(result, *report.shown));
  add_map(report, way, html);
  Table facts;
  facts.header = {"what", "value"};
  facts.text_columns = 2;
  for (const auto& [name, value] : report.facts) facts.rows.push_back({name, value});
  html.table(facts);
  html.heading("Loops");
  add_loops(result, way, html);
  if (!way.poses.empty()) html.figure(correction_chart(result), "Distance between the two ways, scan by scan.");
  html.heading("Confidence over time");
  if (!report.overlap.empty())
    html.figure(overlap_chart(report.overlap), "Low values: new ground, people, or a tracker in trouble.");
  html.heading("Warnings");
  if (report.warnings.empty())
    html.paragraph("None.");
  else
    html.bullets(report.warnings);
  if (!report.cpu_ms.empty()) {
    html.heading("Times");
    html.figure(time_chart(report.cpu_ms),
                "Tracking and, at 1 thread, the work on loops and graph that was due with that scan.");
  }
  return html.str();
}

}  // namespace phasescan
