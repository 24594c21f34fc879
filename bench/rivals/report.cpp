#include "report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "eval/pair_rows.hpp"
#include "report/table.hpp"

namespace phasescan::rivals {
namespace {

using Json = nlohmann::ordered_json;

/// Rows of one dataset x class of a duel.
struct DuelRow {
  const PairRow* ours;
  const PairRow* theirs;
};

struct DuelResult {
  Duel duel;
  std::string theirs;  ///< the rival that was taken
  std::vector<DuelRow> rows;
};

const PairRow* find_row(const std::vector<PairRow>& rows, const std::string& dataset, const std::string& cls,
                        std::size_t method) {
  const auto at = std::find_if(rows.begin(), rows.end(), [&](const PairRow& row) {
    return row.dataset == dataset && row.cls == cls && row.method == method;
  });
  return at == rows.end() ? nullptr : &*at;
}

std::size_t index_of(const std::vector<Contender>& contenders, const std::string& name) {
  return static_cast<std::size_t>(
      std::find_if(contenders.begin(), contenders.end(), [&](const Contender& c) { return c.name == name; }) -
      contenders.begin());
}

std::vector<DuelResult> fight(const std::vector<PairRow>& rows, const std::vector<PairRow>& totals,
                              const std::vector<Contender>& contenders) {
  std::vector<DuelResult> results;
  for (const Duel& duel : duels(contenders)) {
    std::size_t best = 0, most = 0;
    for (const std::string& name : duel.theirs) {
      const std::size_t method = index_of(contenders, name);
      const PairRow* total = find_row(totals, "all", "all", method);
      if (total == nullptr) continue;
      if (name == duel.theirs.front() || total->right > most) {
        best = method;
        most = total->right;
      }
    }
    DuelResult result{duel, contenders[best].name, {}};
    const std::size_t ours = index_of(contenders, duel.ours);
    for (const PairRow& row : rows) {
      if (row.method == ours) result.rows.push_back({&row, find_row(rows, row.dataset, row.cls, best)});
    }
    results.push_back(std::move(result));
  }
  return results;
}

std::string share_cell(const PairRow& row) {
  return fmt::format("{} ({} - {})", percent(row.success()), percent(row.interval.low), percent(row.interval.high));
}

/// "worse" or "better" only where the 95 % intervals do not touch.
const char* verdict(const DuelRow& row) {
  if (row.ours->interval.high < row.theirs->interval.low) return "worse";
  if (row.ours->interval.low > row.theirs->interval.high) return "better";
  return "not worse";
}

Table dataset_table(const std::string& dataset, const std::vector<std::string>& classes,
                    const std::vector<PairRow>& rows, const std::vector<Contender>& contenders) {
  Table table;
  table.header = {"matcher"};
  for (const std::string& cls : classes) {
    const PairRow* row = find_row(rows, dataset, cls, 0);
    table.header.push_back(fmt::format("{}, n = {} [%]", cls, row ? row->n : 0));
    table.header.push_back("[ms]");
  }
  for (std::size_t m = 0; m < contenders.size(); ++m) {
    std::vector<std::string> cells{contenders[m].name};
    for (const std::string& cls : classes) {
      const PairRow* row = find_row(rows, dataset, cls, m);
      cells.push_back(row ? share_cell(*row) : "-");
      cells.push_back(row ? fixed(row->times[0].p50, 3) : "-");
    }
    table.rows.push_back(std::move(cells));
  }
  return table;
}

Table duel_table(const DuelResult& result) {
  Table table{fmt::format("{}. Here: {}", result.duel.caption, result.theirs),
              {"dataset", "class", "ours [%]", "theirs [%]", "success", "ours [ms]", "theirs [ms]", "theirs / ours"},
              {},
              2};
  for (const DuelRow& row : result.rows) {
    const double ours = row.ours->times[0].p50, theirs = row.theirs->times[0].p50;
    table.rows.push_back({row.ours->dataset, row.ours->cls, share_cell(*row.ours), share_cell(*row.theirs),
                          verdict(row), fixed(ours, 3), fixed(theirs, 3), fixed(theirs / ours, 1)});
  }
  return table;
}

Json row_json(const PairRow& row, const std::vector<Contender>& contenders) {
  return {
      {"dataset", row.dataset},
      {"class", row.cls},
      {"matcher", contenders[row.method].name},
      {"n", row.n},
      {"success",
       {{"count", row.right}, {"share", row.success()}, {"low", row.interval.low}, {"high", row.interval.high}}},
      {"errors", {{"x_m", row.x_m.median}, {"y_m", row.y_m.median}, {"rotation_deg", row.rotation_deg.median}}},
      {"ms",
       {{"mean", row.times[0].mean}, {"p50", row.times[0].p50}, {"p95", row.times[0].p95}, {"p99", row.times[0].p99}}}};
}

}  // namespace

std::string markdown(const std::vector<PairOutcome>& outcomes, const std::vector<Contender>& contenders,
                     const ReportInfo& info) {
  const std::vector<PairRow> rows = pair_rows(outcomes), totals = pair_totals(outcomes);
  const std::vector<std::string> classes = classes_in_order(outcomes);
  std::string out = fmt::format("# Rivals side by side\n\nphasescan {}", info.version);
  if (!info.note.empty()) out += ", " + info.note;
  out += fmt::format(". {} pairs", info.pairs);
  if (info.without_truth > 0) out += fmt::format(" ({} more without a truth were left out)", info.without_truth);
  out += fmt::format(
      ", no first guess. Success: within {} m and {} deg of the truth, with its 95 % Wilson interval. Time: median CPU "
      "time of all threads from raw ranges of both scans to the pose{}; one 128 x 128 float FFT took {} ms in the same "
      "process. Sources:\n\n",
      kSuccessTranslation_m, kSuccessRotation_deg, info.repeat > 1 ? fmt::format(", best of {} runs", info.repeat) : "",
      fixed(info.fft_ms, 4));
  for (const std::string& source : info.sources) out += fmt::format("- {}\n", source);
  for (const std::string& dataset : datasets_in_order(outcomes)) {
    out += fmt::format("\n## {}\n\n{}", dataset, dataset_table(dataset, classes, rows, contenders).markdown());
  }
  out += fmt::format("\n## All datasets\n\n{}", dataset_table("all", classes, totals, contenders).markdown());
  for (const DuelResult& result : fight(rows, totals, contenders)) {
    out += fmt::format("\n## {} against {}\n\n{}", result.duel.ours, result.theirs, duel_table(result).markdown());
  }
  out += "\n## What ran\n\n";
  for (const Contender& c : contenders) out += fmt::format("- **{}**: {}\n", c.name, c.settings);
  return out;
}

std::string json(const std::vector<PairOutcome>& outcomes, const std::vector<Contender>& contenders,
                 const ReportInfo& info) {
  const std::vector<PairRow> rows = pair_rows(outcomes), totals = pair_totals(outcomes);
  Json out{{"phasescan", info.version},
           {"command", "rivals"},
           {"note", info.note},
           {"sources", info.sources},
           {"pairs", info.pairs}};
  out["timing"] = {{"fft_128_r2c_ms", info.fft_ms}, {"repeat", info.repeat}, {"clock", "CPU time of all threads"}};
  out["success_limits"] = {{"translation_m", kSuccessTranslation_m}, {"rotation_deg", kSuccessRotation_deg}};
  out["contenders"] = Json::array();
  for (const Contender& c : contenders) out["contenders"].push_back({{"name", c.name}, {"settings", c.settings}});
  for (const auto& [name, list] : {std::pair{"rows", &rows}, std::pair{"totals", &totals}}) {
    out[name] = Json::array();
    for (const PairRow& row : *list) out[name].push_back(row_json(row, contenders));
  }
  out["duels"] = Json::array();
  for (const DuelResult& result : fight(rows, totals, contenders)) {
    Json duel{{"ours", result.duel.ours}, {"theirs", result.theirs}, {"rows", Json::array()}};
    for (const DuelRow& row : result.rows) {
      duel["rows"].push_back({{"dataset", row.ours->dataset},
                              {"class", row.ours->cls},
                              {"success", verdict(row)},
                              {"time_ratio", row.theirs->times[0].p50 / row.ours->times[0].p50}});
    }
    out["duels"].push_back(std::move(duel));
  }
  return out.dump(1) + "\n";
}

}  // namespace phasescan::rivals
