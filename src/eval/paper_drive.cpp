// Fig. 11: dynamic localisation at rising speeds.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "eval/paper_tracks.hpp"

namespace phasescan {
namespace {

constexpr double kLength_m = 8.0;
constexpr std::size_t kEveryScan = 1;
constexpr std::size_t kOncePerSecond = 6;  // 5.5 scans a second

/// Speed and the turn rate that goes with it: up to 0.3 m/s in the proportion of the paper's Fig. 12 (25 deg/s at 0.3
/// m/s), beyond that on to 180 deg/s at 1 m/s.
struct Pace {
  double speed_mps, turn_rate_dps;
};

struct Runner {
  std::string name;
  Variant variant;
  MatchMethod method;
  bool deskew = false;
};

std::vector<Runner> runners() {
  return {{"icp", Variant::kPrinted, MatchMethod::kIcp},
          {"fft-icp2", Variant::kPrinted, MatchMethod::kFftIcp2},
          {"icp", Variant::kOurs, MatchMethod::kIcp},
          {"fft-icp2", Variant::kOurs, MatchMethod::kFftIcp2},
          {"global", Variant::kOurs, MatchMethod::kGlobal},
          {"global, motion removed", Variant::kOurs, MatchMethod::kGlobal, true}};
}

/// All tracks of the experiment: [pace][stride][runner].
struct Experiment {
  std::vector<RecordedDrive> drives;
  std::vector<std::map<std::size_t, std::vector<Track>>> tracks;
};

Series styled(const std::string& name) {
  Series s;
  s.name = name;
  s.color = name == "global, motion removed" ? std::string(palette::kGreen) : method_color(name);
  s.width = 1.4;
  return s;
}

Chart trajectory_chart(const Experiment& all, std::size_t pace, std::size_t stride, Variant variant) {
  Chart chart;
  const RecordedDrive& drive = all.drives[pace];
  chart.title = fmt::format("{} m/s, {} deg/s, {}", plain_number(drive.speed_mps, 2),
                            plain_number(drive.turn_rate_dps, 1), variant_name(variant));
  chart.x.label = "x [m]";
  chart.y.label = "y [m]";
  chart.equal = true;
  Series truth;
  truth.name = "true path";
  truth.color = palette::kGrey;
  truth.width = 4.0;
  truth.opacity = 0.7;
  double reach = 0.5;
  for (const Pose2& p : drive.truth) {
    truth.x.push_back(p.x);
    truth.y.push_back(p.y);
    reach = std::max({reach, std::abs(p.x), std::abs(p.y)});
  }
  const auto limits = [&](ChartAxis& axis, const std::vector<double>& values) {
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    axis.min = *low - 0.25 * reach;
    axis.max = *high + 0.25 * reach;
  };
  limits(chart.x, truth.x);
  limits(chart.y, truth.y);
  chart.series.push_back(std::move(truth));
  const std::vector<Runner> who = runners();
  for (std::size_t r = 0; r < who.size(); ++r) {
    if (who[r].variant != variant) continue;
    Series s = styled(who[r].name);
    for (const Pose2& p : all.tracks[pace].at(stride)[r].estimate) {
      s.x.push_back(p.x);
      s.y.push_back(p.y);
    }
    chart.series.push_back(std::move(s));
  }
  return chart;
}

Chart error_chart(const Experiment& all, std::size_t pace, std::size_t stride, Variant variant) {
  Chart chart;
  const RecordedDrive& drive = all.drives[pace];
  chart.title = fmt::format("{} m/s, {} deg/s, {}", plain_number(drive.speed_mps, 2),
                            plain_number(drive.turn_rate_dps, 1), variant_name(variant));
  chart.x.label = "time [s]";
  chart.y.label = "position error [m]";
  chart.y.log = true;
  chart.y.min = 0.001;
  chart.y.max = 10.0;
  const std::vector<Runner> who = runners();
  for (std::size_t r = 0; r < who.size(); ++r) {
    if (who[r].variant != variant) continue;
    Series s = styled(who[r].name);
    const Track& track = all.tracks[pace].at(stride)[r];
    s.x.assign(track.seconds.begin() + 1, track.seconds.end());
    for (const double e : track.position_errors()) s.y.push_back(std::max(e, 1e-4));
    s.y.erase(s.y.begin());  // the first pose is exact by definition
    chart.series.push_back(std::move(s));
  }
  return chart;
}

template <class Value>
Chart by_speed_chart(const Experiment& all, std::size_t stride, Variant variant, const std::string& title,
                     const std::string& label, Value value) {
  Chart chart;
  chart.title = title;
  chart.x.label = "speed [m/s]";
  chart.x.log = true;
  chart.x.min = 0.045;
  chart.x.max = 1.15;
  chart.y.label = label;
  chart.y.log = true;
  const std::vector<Runner> who = runners();
  for (std::size_t r = 0; r < who.size(); ++r) {
    if (who[r].variant != variant) continue;
    Series s = styled(who[r].name);
    s.marker = method_marker(who[r].name);
    for (std::size_t p = 0; p < all.drives.size(); ++p) {
      s.x.push_back(all.drives[p].speed_mps);
      s.y.push_back(std::max(1e-4, value(all.tracks[p].at(stride)[r])));
    }
    chart.series.push_back(std::move(s));
  }
  return chart;
}

const char* protocol(std::size_t stride) {
  return stride == kEveryScan ? "every scan matched" : "one match a second";
}

void summary_figure(PaperKit& kit, const Experiment& all) {
  Figure figure, rough;
  figure.cell_width = rough.cell_width = 400.0;
  figure.cell_height = rough.cell_height = 280.0;
  for (const std::size_t stride : {kEveryScan, kOncePerSecond}) {
    for (const Variant variant : {Variant::kPrinted, Variant::kOurs}) {
      const std::string title = fmt::format("{}, {}", protocol(stride), variant_name(variant));
      Chart error = by_speed_chart(all, stride, variant, title, "largest error [m]",
                                   [](const Track& t) { return t.max_error(); });
      error.y.min = 0.005;
      error.y.max = 20.0;
      figure.charts.push_back(std::move(error));
      if (stride != kEveryScan) continue;
      Chart roughness = by_speed_chart(all, stride, variant, title, "roughness [mm]",
                                       [](const Track& t) { return 1e3 * t.roughness(); });
      roughness.y.min = 1.0;
      roughness.y.max = 2000.0;
      rough.charts.push_back(std::move(roughness));
    }
  }
  kit.figure("fig11_error_by_speed", figure.svg(),
             fmt::format("Fig. 11: largest position error on {} m of way against speed.", plain_number(kLength_m, 0)));
  kit.figure("fig11_roughness", rough.svg(),
             "Roughness (root mean square of the second difference of the position error): a smooth curve of the true "
             "shape has 0. Sec. 5.4 "
             "claims smoother curves for the FFT method under vibration.");
}

/// "Roughness at 0.3 m/s ...: icp 16 mm, ..."
std::string roughness_text(const Experiment& all, Variant variant) {
  std::string out;
  for (std::size_t p = 0; p < all.drives.size(); ++p) {
    if (all.drives[p].speed_mps != 0.3) continue;
    const std::vector<Runner> who = runners();
    for (std::size_t r = 0; r < who.size(); ++r) {
      if (who[r].variant != variant) continue;
      out += fmt::format("{} {} {} mm", out.empty() ? ":" : ",", who[r].name,
                         plain_number(1e3 * all.tracks[p].at(kEveryScan)[r].roughness(), 0));
    }
  }
  return fmt::format("Roughness at 0.3 m/s, every scan matched, {}{}.", variant_name(variant), out);
}

}  // namespace

void paper_drive(PaperKit& kit) {
  const std::vector<Pace> paces =
      kit.options.quick ? std::vector<Pace>{{0.15, 12.5}, {0.2, 16.7}, {0.3, 25.0}, {1.0, 180.0}}
                        : std::vector<Pace>{{0.05, 4.2}, {0.1, 8.3},  {0.15, 12.5},  {0.2, 16.7}, {0.25, 20.8},
                                            {0.3, 25.0}, {0.5, 60.0}, {0.75, 120.0}, {1.0, 180.0}};
  Experiment all;
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const Pace& pace : paces) {
    all.drives.push_back(drive_tour(kit.options.seed, pace.speed_mps, pace.turn_rate_dps, kLength_m));
    all.tracks.emplace_back();
    for (const std::size_t stride : {kEveryScan, kOncePerSecond}) {
      for (const Runner& runner : runners()) {
        all.tracks.back()[stride].push_back(
            chain_matches(all.drives.back(), kit.method(runner.variant, runner.method), stride, runner.deskew));
        const Track& track = all.tracks.back()[stride].back();
        json.push_back({{"speed_mps", pace.speed_mps},
                        {"turn_rate_dps", pace.turn_rate_dps},
                        {"every_nth_scan", stride},
                        {"method", runner.name},
                        {"variant", runner.variant == Variant::kPrinted ? "printed" : "defaults"},
                        {"largest_error_m", track.max_error()},
                        {"last_error_m", track.position_errors().back()},
                        {"roughness_m", track.roughness()}});
      }
    }
  }
  kit.data("fig11", json);

  kit.report.heading("Fig. 11: dynamic localisation");
  kit.report.paragraph(fmt::format(
      "An A1 (5.5 turns a second, 360 beams cast one after the other while it moves) is driven {} m through a flat, "
      "always the same way, "
      "vibrating by 3 mm and 0.5 deg. Its pose is the chain of matches, each scan against the one before, whatever a "
      "match says of itself; "
      "nothing else helps; \"motion removed\" takes the motion of the step before out of both scans. The paper does "
      "not say how often it matched: at every scan the motion between two scans is a few centimetres, so "
      "one match a second is shown too.",
      plain_number(kLength_m, 0)));
  summary_figure(kit, all);
  kit.report.bullets({roughness_text(all, Variant::kPrinted), roughness_text(all, Variant::kOurs)});
  Figure trajectories, errors;
  trajectories.cell_width = trajectories.cell_height = 360.0;
  errors.cell_width = 400.0;
  errors.cell_height = 250.0;
  for (std::size_t p = 0; p < paces.size(); ++p) {
    const double v = paces[p].speed_mps;
    if (v != 0.15 && v != 0.2 && v != 0.3 && v != 1.0) continue;
    for (const Variant variant : {Variant::kPrinted, Variant::kOurs}) {
      trajectories.charts.push_back(trajectory_chart(all, p, kOncePerSecond, variant));
      errors.charts.push_back(error_chart(all, p, kOncePerSecond, variant));
    }
  }
  kit.figure("fig11_trajectories", trajectories.svg(), "Fig. 11: trajectories with one match a second.");
  kit.figure("fig11_error_over_time", errors.svg(), "Fig. 11: position error over time with one match a second.");
}

}  // namespace phasescan
