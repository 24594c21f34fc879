#include <fmt/format.h>

#include <cmath>

#include "eval/bench_report.hpp"

namespace phasescan {
namespace {

std::string count(std::size_t n) {
  return fmt::format("{}", n);
}

std::vector<std::string> row_names(const BenchRow& row, const std::vector<BenchMethod>& methods) {
  return {row.dataset, row.cls, methods[row.method].name};
}

Table confidence_table(const std::vector<BenchRow>& rows, const std::vector<BenchMethod>& methods) {
  Table table{
      "Confidence and covariance: AUC of confidence between right and wrong answers, expected calibration error (10 "
      "bins), "
      "share of e' C^-1 e below 7.81 among usable answers (95 % is consistent)",
      {"dataset", "class", "method", "n", "AUC", "ECE", "NEES < 7.81 [%]"},
      {},
      3};
  for (const BenchRow& row : rows) {
    std::vector<std::string> cells = row_names(row, methods);
    cells.insert(cells.end(),
                 {count(row.n), fixed(row.auc, 4), fixed(row.calibration_error, 4), percent(row.nees_below)});
    table.rows.push_back(std::move(cells));
  }
  return table;
}

Table bound_table(const std::vector<BenchRow>& rows, const std::vector<BenchMethod>& methods) {
  Table table{
      "Against what the ranges hold: sqrt(mean(e' J e) / 3) over the successes of pairs that are not weak (1 is the "
      "Cramer-Rao bound)",
      {"dataset", "class", "method", "n", "times the bound"},
      {},
      3};
  for (const BenchRow& row : rows) {
    if (!std::isfinite(row.efficiency)) continue;
    std::vector<std::string> cells = row_names(row, methods);
    cells.insert(cells.end(), {count(row.n), fixed(row.efficiency, 2)});
    table.rows.push_back(std::move(cells));
  }
  return table;
}

Table corridor_table(const std::vector<BenchRow>& rows, const std::vector<BenchMethod>& methods) {
  Table table{
      "Weak pairs: even the true pose leaves sigma > 0.05 m in some direction (a bare corridor). There `ambiguous` is the "
      "right answer, and the error across that direction must be small all the same; success is that of the other pairs",
      {"dataset", "class", "method", "weak", "called ambiguous [%]", "across < 0.1 m [%]", "others",
       "success of the others [%]", "95 % interval"},
      {},
      3};
  for (const BenchRow& row : rows) {
    if (row.weak == 0) continue;
    const double weak = static_cast<double>(row.weak);
    std::vector<std::string> cells = row_names(row, methods);
    cells.insert(
        cells.end(),
        {count(row.weak), percent(static_cast<double>(row.weak_ambiguous) / weak),
         percent(static_cast<double>(row.weak_across) / weak), count(row.known()), percent(row.known_success()),
         row.known() > 0 ? fmt::format("{} - {}", percent(row.known_interval.low), percent(row.known_interval.high))
                         : "-"});
    table.rows.push_back(std::move(cells));
  }
  return table;
}

Table shortcut_table(const std::vector<BenchRow>& rows, const std::vector<BenchMethod>& methods) {
  Table table{"Missing-data shortcut: how often the rotation came from it, and how often the match was then right",
              {"dataset", "class", "method", "n", "used [%]", "right when used [%]"},
              {},
              3};
  for (const BenchRow& row : rows) {
    const std::size_t used = row.rotation_sources[static_cast<std::size_t>(RotationSource::kMissingData)];
    if (used == 0) continue;
    std::vector<std::string> cells = row_names(row, methods);
    cells.insert(cells.end(), {count(row.n), percent(static_cast<double>(used) / static_cast<double>(row.n)),
                               percent(static_cast<double>(row.shortcut_right) / static_cast<double>(used))});
    table.rows.push_back(std::move(cells));
  }
  return table;
}

}  // namespace

Table success_table(const std::vector<BenchRow>& rows, const std::vector<BenchMethod>& methods) {
  Table table{
      "Success: pose within 0.1 m and 3 deg of the truth, whatever the method says of itself, with its 95 % Wilson "
      "interval; "
      "then what it said of itself",
      {"dataset", "class", "method", "n", "success [%]", "95 % interval", "right & usable", "right & refused",
       "wrong & refused", "wrong & usable"},
      {},
      3};
  for (const BenchRow& row : rows) {
    std::vector<std::string> cells = row_names(row, methods);
    const std::string interval =
        row.with_truth > 0 ? fmt::format("{} - {}", percent(row.interval.low), percent(row.interval.high)) : "-";
    cells.insert(cells.end(), {count(row.n), percent(row.success()), interval, count(row.right_usable),
                               count(row.right_refused), count(row.wrong_refused), count(row.wrong_usable)});
    table.rows.push_back(std::move(cells));
  }
  return table;
}

Table error_table(const std::vector<BenchRow>& rows, const std::vector<BenchMethod>& methods) {
  Table table{"Errors over the successes: mean of the absolute error, its variance, standard deviation and median",
              {"dataset", "class", "method", "x mean [m]", "x var", "x std", "x median", "y mean [m]", "y var", "y std",
               "y median", "rot mean [deg]", "rot var", "rot std", "rot median"},
              {},
              3};
  for (const BenchRow& row : rows) {
    std::vector<std::string> cells = row_names(row, methods);
    for (const Moments* m : {&row.x_m, &row.y_m}) {
      cells.insert(cells.end(), {fixed(m->mean, 4), fixed(m->variance, 6), fixed(m->std, 4), fixed(m->median, 4)});
    }
    const Moments& r = row.rotation_deg;
    cells.insert(cells.end(), {fixed(r.mean, 3), fixed(r.variance, 4), fixed(r.std, 3), fixed(r.median, 3)});
    table.rows.push_back(std::move(cells));
  }
  return table;
}

Table time_table(const std::vector<BenchRow>& rows, const std::vector<BenchMethod>& methods, const BenchInfo& info,
                 double fft_ms) {
  Table table{
      fmt::format("CPU time per match [ms], all threads, {}; one 128 x 128 float FFT took {} ms in the same "
                  "process",
                  info.prepared ? "against a prepared reference" : "from raw ranges of both scans", fixed(fft_ms, 4)),
      {"dataset", "class", "method", "mean", "p50", "p95", "p99", "p50 in FFTs", "image", "missing", "rotation",
       "translation", "refine"},
      {},
      3};
  for (const BenchRow& row : rows) {
    std::vector<std::string> cells = row_names(row, methods);
    const TimeRow& t = row.times[0];
    cells.insert(cells.end(),
                 {fixed(t.mean, 3), fixed(t.p50, 3), fixed(t.p95, 3), fixed(t.p99, 3), fixed(t.p50 / fft_ms, 1)});
    for (std::size_t s = 1; s < row.times.size(); ++s) cells.push_back(fixed(row.times[s].p50, 3));
    table.rows.push_back(std::move(cells));
  }
  table.caption += "; the steps are medians";
  return table;
}

std::string bench_markdown(const BenchRun& run, const std::vector<BenchMethod>& methods, const BenchInfo& info) {
  const std::vector<BenchRow> rows = pair_rows(run.outcomes);
  const std::vector<BenchRow> totals = pair_totals(run.outcomes);
  std::string out = fmt::format("# phasescan bench\n\nphasescan {}, {} pairs from:\n\n", info.version, run.pairs);
  for (const std::string& source : info.sources) out += fmt::format("- {}\n", source);
  const auto add = [&](const char* heading, const Table& table) {
    if (!table.rows.empty()) out += fmt::format("\n## {}\n\n{}", heading, table.markdown());
  };
  add("Success and honesty", success_table(rows, methods));
  add("Totals", success_table(totals, methods));
  add("Accuracy", error_table(rows, methods));
  if (info.times) add("Time", time_table(rows, methods, info, run.fft_ms));
  std::vector<BenchRow> calibrated;
  for (const BenchRow& row : totals) {
    if (row.with_confidence > 0) calibrated.push_back(row);
  }
  add("Confidence", confidence_table(calibrated, methods));
  add("Against the Cramer-Rao bound", bound_table(totals, methods));
  std::vector<BenchRow> with_totals = rows;
  with_totals.insert(with_totals.end(), totals.begin(), totals.end());
  add("Corridors", corridor_table(with_totals, methods));
  add("Missing-data shortcut", shortcut_table(totals, methods));
  return out;
}

}  // namespace phasescan
