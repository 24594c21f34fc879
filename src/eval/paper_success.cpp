// Fig. 10 (success), and the run whose outcomes Tables 2, 3 and 4 show.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "eval/paper_tables.hpp"
#include "eval/bench_report.hpp"

namespace phasescan {
namespace {

Columns all_columns(const PaperKit& kit) {
  Columns columns{kit.methods(Variant::kPrinted), 0};
  columns.printed = columns.methods.size();
  for (BenchMethod& m : kit.methods(Variant::kOurs)) columns.methods.push_back(std::move(m));
  return columns;
}

/// The outcomes of one variant, its methods numbered from 0.
std::vector<PairOutcome> only(const std::vector<PairOutcome>& outcomes, const Columns& columns, Variant variant) {
  std::vector<PairOutcome> out;
  for (const PairOutcome& o : outcomes) {
    if ((o.method < columns.printed) != (variant == Variant::kPrinted)) continue;
    out.push_back(o);
    if (variant == Variant::kOurs) out.back().method -= columns.printed;
  }
  return out;
}

std::vector<BenchRow> rows_of_all_datasets(const std::vector<PairOutcome>& outcomes) {
  std::vector<BenchRow> rows;
  for (BenchRow& row : pair_totals(outcomes)) {
    if (row.dataset == "all" && row.cls != "all") rows.push_back(std::move(row));
  }
  return rows;
}

/// Success per class, all datasets together, as printed and with our defaults.
Figure success_figure(const PaperKit& kit, const std::vector<PairOutcome>& outcomes, const Columns& columns) {
  Figure figure;
  figure.cell_width = 430.0;
  for (const Variant variant : kBoth) {
    figure.charts.push_back(success_chart(rows_of_all_datasets(only(outcomes, columns, variant)), kit.methods(variant),
                                          variant == Variant::kPrinted ? "As printed" : "This project's defaults"));
  }
  return figure;
}

/// "fft 14 %, ndt 27 %, ..." from worst to best in one class.
std::string order_text(const std::vector<PairOutcome>& outcomes, const std::vector<BenchMethod>& methods,
                       const std::string& cls) {
  std::vector<BenchRow> rows = rows_of_all_datasets(outcomes);
  std::erase_if(rows, [&](const BenchRow& row) { return row.cls != cls || row.method >= 5; });
  std::stable_sort(rows.begin(), rows.end(),
                   [](const BenchRow& a, const BenchRow& b) { return a.success() < b.success(); });
  std::string out;
  for (const BenchRow& row : rows)
    out += fmt::format("{}{} {} %", out.empty() ? "" : " < ", methods[row.method].name, percent(row.success()));
  return out;
}

nlohmann::ordered_json rows_json(const std::vector<PairOutcome>& outcomes, const std::vector<BenchMethod>& methods,
                                 bool times) {
  nlohmann::ordered_json out = nlohmann::ordered_json::array();
  for (const BenchRow& row : pair_rows(outcomes)) {
    out.push_back({{"dataset", row.dataset},
                   {"class", row.cls},
                   {"method", methods[row.method].name},
                   {"n", row.with_truth},
                   {"success", row.right},
                   {"low", row.interval.low},
                   {"high", row.interval.high},
                   {"x_m", {row.x_m.mean, row.x_m.variance}},
                   {"y_m", {row.y_m.mean, row.y_m.variance}},
                   {"rotation_deg", {row.rotation_deg.mean, row.rotation_deg.variance}}});
    if (times) out.back()["ms"] = {{"mean", row.times[0].mean}, {"p50", row.times[0].p50}, {"p99", row.times[0].p99}};
  }
  return out;
}

void scene_figure(PaperKit& kit, const std::vector<PairOutcome>& outcomes, const Columns& columns,
                  const std::string& name, const std::string& caption) {
  Figure figure;
  figure.cell_width = 430.0;
  figure.cell_height = 240.0;
  for (const std::string& dataset : datasets_in_order(outcomes)) {
    const bool any_truth = std::any_of(outcomes.begin(), outcomes.end(),
                                       [&](const PairOutcome& o) { return o.dataset == dataset && o.has_truth; });
    if (!any_truth) continue;
    for (const Variant variant : kBoth) {
      std::vector<PairOutcome> of_dataset;
      for (PairOutcome& o : only(outcomes, columns, variant)) {
        if (o.dataset == dataset) of_dataset.push_back(std::move(o));
      }
      figure.charts.push_back(success_chart(pair_rows(of_dataset), kit.methods(Variant::kOurs),
                                            fmt::format("{}, {}", dataset, variant_name(variant))));
    }
  }
  kit.figure(name, figure.svg(), caption);
}

}  // namespace

void paper_success(PaperKit& kit, const PaperPairs& pairs) {
  const Columns columns = all_columns(kit);
  BenchSettings settings;
  settings.threads = kit.options.threads;
  const BenchRun run =
      run_bench(simulated_source(pairs.generator, pairs.count, kit.options.threads), columns.methods, settings);
  const std::vector<PairOutcome> printed = only(run.outcomes, columns, Variant::kPrinted),
                                 ours = only(run.outcomes, columns, Variant::kOurs);

  kit.report.heading("Fig. 10: success rate");
  kit.report.paragraph(fmt::format(
      "{} pairs from rooms, offices, flats and corridors in equal parts, no first guess, at most 200 iterations; "
      "success: within 0.1 m and 3 deg of the truth. Class global (any rotation, up to 1.5 m) is not in the "
      "paper. Whiskers: 95 % Wilson intervals.",
      run.pairs));
  kit.figure("fig10_success", success_figure(kit, run.outcomes, columns).svg(),
             "Fig. 10: success per class, all scenes.");
  kit.report.bullets({"Large class in the paper, from worst to best: icp < ndt < fft, fft-icp1, fft-icp2.",
                      "As printed: " + order_text(printed, kit.methods(Variant::kPrinted), "large"),
                      "With this project's defaults: " + order_text(ours, kit.methods(Variant::kOurs), "large")});
  paper_changes(kit, pairs);
  scene_figure(kit, run.outcomes, columns, "fig10_scenes", "Fig. 10 by scene.");
  Figure overlap;
  overlap.cell_width = 430.0;
  overlap.charts = {overlap_chart(printed, kit.methods(Variant::kPrinted), "As printed"),
                    overlap_chart(ours, kit.methods(Variant::kOurs), "This project's defaults")};
  kit.figure(
      "fig10_overlap", overlap.svg(),
      "Success against overlap, all classes: Sec. 5.2 explains failures by \"excessive change of total shape\".");
  kit.data("fig10_printed", rows_json(printed, kit.methods(Variant::kPrinted), kit.options.times));
  kit.data("fig10_defaults", rows_json(ours, kit.methods(Variant::kOurs), kit.options.times));

  kit.report.heading("Table 2: accuracy");
  kit.report.table(accuracy_table2(run.outcomes, columns));
  kit.report.heading("The missing-data shortcut");
  kit.report.table(shortcut_table(run.outcomes, columns));
  if (kit.options.times) {
    kit.report.heading("Tables 3, 4: time");
    kit.report.table(step_time_table3(run.outcomes, columns));
    kit.report.table(scene_time_table4(run.outcomes, columns));
    kit.report.paragraph(
        fmt::format("One 128 x 128 real-to-complex float FFT took {} ms in the same process.", fixed(run.fft_ms, 4)));
  }

  for (const std::string& path : kit.options.pairs) {
    const BenchRun real = run_bench(file_source(path), columns.methods, settings);
    const std::string name = source_name(path);
    kit.report.heading("Fig. 10 and Table 2 on " + name);
    const bool any_truth =
        std::any_of(real.outcomes.begin(), real.outcomes.end(), [](const PairOutcome& o) { return o.has_truth; });
    if (!any_truth) {
      kit.report.paragraph("No pair of this file has a true pose: there is nothing to succeed at.");
      continue;
    }
    std::string file = "pairs_" + name;
    std::replace_if(
        file.begin(), file.end(),
        [](char c) { return !std::isalnum(static_cast<unsigned char>(c)) && c != '-' && c != '_'; }, '_');
    scene_figure(kit, real.outcomes, columns, file + "_success",
                 fmt::format("Success on {} pairs of {}.", real.pairs, name));
    kit.report.table(accuracy_table2(real.outcomes, columns));
    kit.data(file + "_printed", rows_json(only(real.outcomes, columns, Variant::kPrinted),
                                          kit.methods(Variant::kPrinted), kit.options.times));
    kit.data(file + "_defaults",
             rows_json(only(real.outcomes, columns, Variant::kOurs), kit.methods(Variant::kOurs), kit.options.times));
  }
}

}  // namespace phasescan
