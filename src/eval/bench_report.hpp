/// A bench run as results.json, results.md and figures.
#pragma once

#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "eval/bench.hpp"
#include "eval/pair_rows.hpp"
#include "report/chart.hpp"
#include "report/table.hpp"

namespace phasescan {

/// What a report says beside the numbers.
struct BenchInfo {
  std::string version;
  std::vector<std::string> sources;  ///< files or simulated sets, as named by the user
  bool times = true;                 ///< false: no time appears anywhere
  int repeat = 1;
  bool prepared = false;  ///< as in BenchSettings
};

/// Everything of the run, machine-readable (schema: docs/results/results-json.md).
std::string bench_json(const BenchRun& run, const std::vector<BenchMethod>& methods, const BenchInfo& info);

/// Success and honesty, errors, times and confidence as Markdown.
std::string bench_markdown(const BenchRun& run, const std::vector<BenchMethod>& methods, const BenchInfo& info);

/// File name (without folder) -> SVG.
std::map<std::string, std::string> bench_figures(const BenchRun& run, const std::vector<BenchMethod>& methods,
                                                 const BenchInfo& info);

/// Every name that `bench_figures` may give, whether a run has that figure or not.
std::span<const std::string_view> bench_figure_names();

/// What each confidence was computed from, a line per answer that has one, as CSV with a header: source, dataset,
/// class, id, method, right, usable, ambiguous, confidence, weak_sigma_m, across_m (see PairOutcome), and the features
/// by name. tools/fit_confidence.py reads it.
std::string bench_features(const BenchRun& run, const std::vector<BenchMethod>& methods);

/// The parts, for other reports.
Table success_table(const std::vector<BenchRow>& rows, const std::vector<BenchMethod>& methods);
Table error_table(const std::vector<BenchRow>& rows, const std::vector<BenchMethod>& methods);
Table time_table(const std::vector<BenchRow>& rows, const std::vector<BenchMethod>& methods, double fft_ms);
Chart success_chart(const std::vector<BenchRow>& rows, const std::vector<BenchMethod>& methods,
                    const std::string& title);
Chart overlap_chart(const std::vector<PairOutcome>& outcomes, const std::vector<BenchMethod>& methods,
                    const std::string& title);

}  // namespace phasescan
