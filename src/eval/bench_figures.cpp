#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>

#include "eval/bench_report.hpp"
#include "eval/reliability_chart.hpp"

namespace phasescan {
namespace {

Series method_series(const std::vector<BenchMethod>& methods, std::size_t m, SeriesKind kind) {
  Series s;
  s.kind = kind;
  s.name = methods[m].name;
  s.color = method_color(methods[m].name, m);
  s.marker = method_marker(methods[m].name, m);
  if (methods[m].name == "fft-icp2") s.dash = "6 3";  // often lies exactly on fft-icp1
  return s;
}

std::vector<const PairOutcome*> of_method(const std::vector<PairOutcome>& outcomes, std::size_t method) {
  std::vector<const PairOutcome*> out;
  for (const PairOutcome& o : outcomes) {
    if (o.method == method) out.push_back(&o);
  }
  return out;
}

Chart time_chart(const BenchRun& run, const std::vector<BenchMethod>& methods) {
  Chart chart;
  chart.title = "CPU time per match";
  chart.subtitle = "box: quartiles and median; whiskers: 5th and 99th percentile";
  chart.x.categories = classes_in_order(run.outcomes);
  chart.y.label = "ms";
  chart.y.log = true;
  for (std::size_t m = 0; m < methods.size(); ++m) {
    Series s = method_series(methods, m, SeriesKind::kBoxes);
    for (std::size_t c = 0; c < chart.x.categories.size(); ++c) {
      std::vector<double> ms;
      for (const PairOutcome* o : of_method(run.outcomes, m)) {
        if (o->cls == chart.x.categories[c]) ms.push_back(std::max(o->ms.total, 1e-4));
      }
      s.x.push_back(static_cast<double>(c));
      s.low.push_back(quantile(ms, 0.05));
      s.q1.push_back(quantile(ms, 0.25));
      s.y.push_back(quantile(ms, 0.5));
      s.q3.push_back(quantile(ms, 0.75));
      s.high.push_back(quantile(ms, 0.99));
    }
    chart.series.push_back(std::move(s));
  }
  return chart;
}

/// What an error chart shows: of which pairs, and how large.
struct ErrorView {
  const char* title;
  const char* label;
  double min, max, limit;
  std::function<std::optional<double>(const PairOutcome&)> error;  ///< nothing: not of these pairs
};

/// Share of the pairs whose error is below x: failures keep the curve below 1.
Chart error_chart(const BenchRun& run, const std::vector<BenchMethod>& methods, const ErrorView& view) {
  Chart chart;
  chart.title = view.title;
  chart.x.label = view.label;
  chart.x.log = true;
  chart.x.min = view.min;
  chart.x.max = view.max;
  chart.y.label = "share of pairs below [%]";
  chart.y.min = 0.0;
  chart.y.max = 100.0;
  constexpr int kSteps = 120;
  for (std::size_t m = 0; m < methods.size(); ++m) {
    Series s = method_series(methods, m, SeriesKind::kLine);
    s.marker = Marker::kNone;
    std::vector<double> errors;
    for (const PairOutcome* o : of_method(run.outcomes, m)) {
      if (const auto error = view.error(*o)) errors.push_back(*error);
    }
    if (errors.empty()) continue;
    std::sort(errors.begin(), errors.end());
    for (int i = 0; i <= kSteps; ++i) {
      const double x = *chart.x.min * std::pow(*chart.x.max / *chart.x.min, static_cast<double>(i) / kSteps);
      const auto below = std::upper_bound(errors.begin(), errors.end(), x) - errors.begin();
      s.x.push_back(x);
      s.y.push_back(100.0 * static_cast<double>(below) / static_cast<double>(errors.size()));
    }
    chart.series.push_back(std::move(s));
  }
  chart.series.push_back({SeriesKind::kLine, "", {view.limit, view.limit}, {0.0, 100.0}});
  chart.series.back().color = std::string(palette::kMuted);
  chart.series.back().width = 1.0;
  chart.series.back().dash = "4 3";
  return chart;
}

using MaybeError = std::optional<double>;
const ErrorView kTranslation{
    "Translation error", "error [m]", 0.001, 5.0, kSuccessTranslation_m, [](const PairOutcome& o) {
      return o.has_truth ? o.translation_error() : MaybeError();
    }};
const ErrorView kRotation{"Rotation error", "error [deg]", 0.01, 180.0, kSuccessRotation_deg, [](const PairOutcome& o) {
                            return o.has_truth ? rad_to_deg(std::abs(o.error_theta)) : MaybeError();
                          }};
const ErrorView kAcrossCorridors{"Corridors: error across what cannot be known",
                                 "error [m]",
                                 0.001,
                                 5.0,
                                 kSuccessTranslation_m,
                                 [](const PairOutcome& o) { return is_weak(o) ? o.error_across_m : MaybeError(); }};

Chart reliability_chart(const BenchRun& run, const std::vector<BenchMethod>& methods) {
  Chart chart = reliability_axes("Reliability of the confidence");
  for (std::size_t m = 0; m < methods.size(); ++m) {
    std::vector<Judgement> judgements;
    for (const PairOutcome* o : of_method(run.outcomes, m)) {
      if (o->confidence) judgements.push_back({*o->confidence, o->right});
    }
    if (judgements.empty()) continue;
    Series points = reliability_points(reliability(judgements));
    const Series looks = method_series(methods, m, SeriesKind::kPoints);
    points.name = looks.name, points.color = looks.color, points.marker = looks.marker;
    chart.series.push_back(std::move(points));
  }
  return chart;
}

bool any_weak(const BenchRun& run) {
  return std::any_of(run.outcomes.begin(), run.outcomes.end(), is_weak);
}

bool any_confidence(const BenchRun& run) {
  return std::any_of(run.outcomes.begin(), run.outcomes.end(),
                     [](const PairOutcome& o) { return o.confidence.has_value(); });
}

}  // namespace

Chart success_chart(const std::vector<BenchRow>& rows, const std::vector<BenchMethod>& methods,
                    const std::string& title) {
  Chart chart;
  chart.title = title;
  chart.y.label = "success [%]";
  chart.y.min = 0.0;
  chart.y.max = 100.0;
  for (const BenchRow& row : rows) {
    if (row.with_truth == 0) continue;
    if (std::find(chart.x.categories.begin(), chart.x.categories.end(), row.cls) == chart.x.categories.end()) {
      chart.x.categories.push_back(row.cls);
    }
  }
  for (std::size_t m = 0; m < methods.size(); ++m) {
    Series s = method_series(methods, m, SeriesKind::kBars);
    for (const BenchRow& row : rows) {
      if (row.method != m || row.with_truth == 0) continue;
      const auto at =
          std::find(chart.x.categories.begin(), chart.x.categories.end(), row.cls) - chart.x.categories.begin();
      s.x.push_back(static_cast<double>(at));
      s.y.push_back(100.0 * row.success());
      s.low.push_back(100.0 * row.interval.low);
      s.high.push_back(100.0 * row.interval.high);
    }
    chart.series.push_back(std::move(s));
  }
  return chart;
}

Chart overlap_chart(const std::vector<PairOutcome>& outcomes, const std::vector<BenchMethod>& methods,
                    const std::string& title) {
  constexpr int kBins = 10;
  constexpr double kLowest = 0.5;
  Chart chart;
  chart.title = title;
  chart.x.label = "overlap of the two scans at the true pose";
  chart.y.label = "success [%]";
  chart.subtitle = "steps of 0.05 with 5 pairs or more, the lowest holds all below 0.55; 95 % intervals";
  chart.y.min = 0.0;
  chart.y.max = 103.0;
  for (std::size_t m = 0; m < methods.size(); ++m) {
    Series s = method_series(methods, m, SeriesKind::kLine);
    std::vector<std::size_t> n(kBins, 0), right(kBins, 0);
    for (const PairOutcome* o : of_method(outcomes, m)) {
      if (!o->has_truth || !std::isfinite(o->overlap)) continue;
      const double place = (o->overlap - kLowest) / (1.0 - kLowest) * kBins;
      const auto bin =
          static_cast<std::size_t>(std::clamp(place, 0.0, kBins - 1.0));  // less than the lowest counts in the first
      ++n[bin];
      right[bin] += o->right;
    }
    for (std::size_t b = 0; b < n.size(); ++b) {
      if (n[b] < 5) continue;
      const Interval interval = wilson_interval(right[b], n[b]);
      const double aside =
          0.003 * (static_cast<double>(m) - 0.5 * static_cast<double>(methods.size() - 1));  // so that equals show
      s.x.push_back(kLowest + (static_cast<double>(b) + 0.5) * (1.0 - kLowest) / kBins + aside);
      s.y.push_back(100.0 * static_cast<double>(right[b]) / static_cast<double>(n[b]));
      s.low.push_back(100.0 * interval.low);
      s.high.push_back(100.0 * interval.high);
    }
    chart.series.push_back(std::move(s));
  }
  return chart;
}

std::span<const std::string_view> bench_figure_names() {
  static constexpr std::array<std::string_view, 6> kNames{"success.svg",   "overlap.svg", "errors.svg",
                                                          "corridors.svg", "time.svg",    "reliability.svg"};
  return kNames;
}

std::map<std::string, std::string> bench_figures(const BenchRun& run, const std::vector<BenchMethod>& methods,
                                                 const BenchInfo& info) {
  std::map<std::string, std::string> out;
  if (run.outcomes.empty()) return out;
  const std::vector<BenchRow> rows = pair_rows(run.outcomes), totals = pair_totals(run.outcomes);
  Figure success;
  success.title = "Success: within 0.1 m and 3 deg, with 95 % Wilson intervals";
  success.cell_width = 420.0;
  for (const std::string& dataset : datasets_in_order(run.outcomes)) {
    std::vector<BenchRow> of_dataset;
    std::copy_if(rows.begin(), rows.end(), std::back_inserter(of_dataset),
                 [&](const BenchRow& r) { return r.dataset == dataset; });
    Chart chart = success_chart(of_dataset, methods, dataset);
    if (!chart.x.categories.empty()) success.charts.push_back(std::move(chart));
  }
  if (!success.charts.empty()) {
    out["success.svg"] = success.svg();
    out["overlap.svg"] = overlap_chart(run.outcomes, methods, "Success against overlap").svg(560.0, 360.0);
    Figure errors;
    errors.cell_width = 420.0;
    errors.charts = {error_chart(run, methods, kTranslation), error_chart(run, methods, kRotation)};
    out["errors.svg"] = errors.svg();
    if (any_weak(run)) out["corridors.svg"] = error_chart(run, methods, kAcrossCorridors).svg(420.0, 340.0);
  }
  if (info.times) out["time.svg"] = time_chart(run, methods).svg(640.0, 380.0);
  if (any_confidence(run)) out["reliability.svg"] = reliability_chart(run, methods).svg(420.0, 460.0);
  return out;
}

}  // namespace phasescan
