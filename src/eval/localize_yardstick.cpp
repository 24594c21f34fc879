#include "eval/localize_yardstick.hpp"

#include <algorithm>

#include "localize/query_scan.hpp"
#include "localize/search_everywhere.hpp"
#include "phasescan/core/time.hpp"

namespace phasescan {

std::vector<YardstickRow> measure_all(const LocalizationMap& map, const std::vector<LocalizeCase>& cases,
                                      const LocalizeOptions& options, std::size_t most_steps,
                                      const std::function<void(std::size_t)>& progress) {
  std::vector<YardstickRow> rows;
  QueryWorkspace work;
  for (const LocalizeCase& one : cases) {
    YardstickRow row;
    row.mapped = one.mapped;
    const double cpu = thread_cpu_seconds();
    const QueryScan query = prepare_query(one.measurement, {}, options.view_range_m, true, work);
    if (one.mapped && query.usable()) {
      const auto [found, finished] = search_everywhere(map.data(), query, options.ambiguous_gap, most_steps);
      row.finished = finished;
      for (std::size_t i = 0; i < found.size(); ++i) {
        const bool right = is_right(map.data().T_map_grid * found[i].T_grid_base, one.T_map_base);
        row.truth_among |= right;
        row.best_right |= i == 0 && right;
      }
      row.ambiguous = found.size() != 1;
      if (!found.empty()) row.best_log_likelihood = found.front().fit.log_likelihood;
    }
    row.s = thread_cpu_seconds() - cpu;
    rows.push_back(row);
    progress(rows.size());
  }
  return rows;
}

YardstickScore compare(const std::vector<YardstickRow>& yardstick, const std::vector<LocalizeRow>& ours, double gap) {
  YardstickScore score;
  std::vector<double> seconds;
  for (std::size_t i = 0; i < yardstick.size() && i < ours.size(); ++i) {
    const YardstickRow& row = yardstick[i];
    const LocalizationUpdate& update = ours[i].update;
    if (!row.mapped) continue;
    seconds.push_back(row.s);
    if (!row.finished) {
      ++score.unfinished;
      continue;
    }
    ++score.n;
    const bool ok = update.status == TrackingStatus::kOk, right = ours[i].right();
    score.truth_among += row.truth_among;
    score.ambiguous += row.ambiguous;
    score.our_ambiguous += update.status == TrackingStatus::kAmbiguous;
    score.missed += !update.T_map_base || update.fit.log_likelihood < row.best_log_likelihood - gap;
    if (row.ambiguous) continue;
    ++score.clear;
    score.clear_right += row.best_right;
    score.clear_our_right += right;
    score.clear_our_right_ok += right && ok;
    score.clear_our_wrong_ok += !right && ok;
  }
  score.s_p50 = quantile(seconds, 0.5);
  score.s_most = quantile(seconds, 1.0);
  return score;
}

}  // namespace phasescan
