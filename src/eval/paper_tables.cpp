#include "eval/paper_tables.hpp"

#include <fmt/format.h>

#include "eval/bench_report.hpp"

namespace phasescan {
namespace {

/// What the paper prints, in its own order. [Jiang19] Tables 2, 3, 4.
struct Table2Line {
  const char* method;
  std::array<double, 6> mean_and_variance;  ///< x [m], y [m], rotation [deg]
};
constexpr std::array<Table2Line, 5> kPaperTable2{{{"ndt", {0.041, 0.027, 0.043, 0.022, 0.78, 0.32}},
                                                  {"icp", {0.043, 0.033, 0.034, 0.024, 0.81, 0.31}},
                                                  {"fft", {0.052, 0.058, 0.047, 0.045, 1.02, 0.67}},
                                                  {"fft-icp1", {0.033, 0.019, 0.034, 0.020, 0.64, 0.29}},
                                                  {"fft-icp2", {0.040, 0.021, 0.037, 0.023, 0.75, 0.28}}}};
struct Table3Line {
  const char* step;
  std::size_t index;  ///< in kTimedSteps
  double paper_ms;
};
constexpr std::array<Table3Line, 5> kPaperTable3{{{"scan images", 1, 10.0},
                                                  {"missing data", 2, 5.0},
                                                  {"rotation by FFT", 3, 103.0},
                                                  {"translation by FFT", 4, 82.0},
                                                  {"ICP", 5, 11.0}}};
struct Table4Line {
  const char* scene;
  const char* dataset;
  std::array<double, 5> paper_ms;  ///< icp, ndt, fft, fft-icp1, fft-icp2
};
constexpr std::array<Table4Line, 3> kPaperTable4{{{"room", "sim-room", {23, 108, 355, 198, 201}},
                                                  {"office", "sim-office", {27, 127, 367, 201, 134}},
                                                  {"corridor", "sim-corridor", {26, 120, 365, 197, 101}}}};

std::size_t find_method(const Columns& columns, Variant variant, std::string_view name) {
  for (const std::size_t m : columns.of(variant)) {
    if (columns.methods[m].name == name) return m;
  }
  return columns.methods.size();
}

/// Mean of one step's time over the outcomes of a method in which the step ran.
double mean_step_ms(const std::vector<PairOutcome>& outcomes, std::size_t method, std::size_t step,
                    const char* dataset = nullptr) {
  std::vector<double> ms;
  for (const PairOutcome& o : outcomes) {
    if (o.method != method || (dataset && o.dataset != dataset)) continue;
    const double value = step_ms(o.ms)[step];
    if (value > 0.0) ms.push_back(value);
  }
  return moments(ms).mean;
}

}  // namespace

Table accuracy_table2(const std::vector<PairOutcome>& outcomes, const Columns& columns) {
  Table table{
      "Table 2: errors over the successes of the classes small, middle and large. The paper's \"variance\" can only be "
      "a standard "
      "deviation or worse; both are printed here.",
      {"method", "", "n", "x mean [m]", "x var [m2]", "x std [m]", "y mean [m]", "y var [m2]", "y std [m]",
       "rot mean [deg]", "rot var [deg2]", "rot std [deg]"},
      {},
      2};
  for (const Table2Line& line : kPaperTable2) {
    const auto& p = line.mean_and_variance;
    table.rows.push_back({line.method, "paper", "", fixed(p[0], 3), fixed(p[1], 3), "", fixed(p[2], 3), fixed(p[3], 3),
                          "", fixed(p[4], 2), fixed(p[5], 2), ""});
    for (const Variant variant : kBoth) {
      for (const std::size_t m : columns.of(variant)) {
        if (columns.methods[m].name != line.method) continue;
        std::vector<const PairOutcome*> box;
        for (const PairOutcome& o : outcomes) {
          if (o.method == m && (o.cls == "small" || o.cls == "middle" || o.cls == "large")) box.push_back(&o);
        }
        const BenchRow row = sum_up(box);
        table.rows.push_back({line.method, variant_name(variant), fmt::format("{}", row.right), fixed(row.x_m.mean, 4),
                              fixed(row.x_m.variance, 6), fixed(row.x_m.std, 4), fixed(row.y_m.mean, 4),
                              fixed(row.y_m.variance, 6), fixed(row.y_m.std, 4), fixed(row.rotation_deg.mean, 3),
                              fixed(row.rotation_deg.variance, 4), fixed(row.rotation_deg.std, 3)});
      }
    }
  }
  return table;
}

Table step_time_table3(const std::vector<PairOutcome>& outcomes, const Columns& columns) {
  Table table{"Table 3: mean CPU time per step of fft-icp2 [ms], where the step runs (the paper: a laptop with an i3)",
              {"step", "paper", "as printed", "this project's defaults"},
              {},
              1};
  for (const Table3Line& line : kPaperTable3) {
    std::vector<std::string> cells{line.step, fixed(line.paper_ms, 0)};
    for (const Variant variant : kBoth) {
      cells.push_back(fixed(mean_step_ms(outcomes, find_method(columns, variant, "fft-icp2"), line.index), 4));
    }
    table.rows.push_back(std::move(cells));
  }
  return table;
}

Table scene_time_table4(const std::vector<PairOutcome>& outcomes, const Columns& columns) {
  Table table{"Table 4: mean CPU time per match [ms]",
              {"scene", "", "icp", "ndt", "fft", "fft-icp1", "fft-icp2", "global"},
              {},
              2};
  for (const Table4Line& line : kPaperTable4) {
    std::vector<std::string> paper{line.scene, "paper"};
    for (const double ms : line.paper_ms) paper.push_back(fixed(ms, 0));
    table.rows.push_back(std::move(paper));
    for (const Variant variant : kBoth) {
      std::vector<std::string> cells{line.scene, variant_name(variant)};
      for (const std::size_t m : columns.of(variant))
        cells.push_back(fixed(mean_step_ms(outcomes, m, 0, line.dataset), 3));
      table.rows.push_back(std::move(cells));
    }
  }
  return table;
}

Table shortcut_table(const std::vector<PairOutcome>& outcomes, const Columns& columns) {
  Table table{
      "The missing-data shortcut of fft-icp2: how often the rotation came from it, how often the match was then right, "
      "and "
      "success beside fft-icp1, which never takes it",
      {"scene", "", "n", "used [%]", "right when used [%]", "fft-icp2 [%]", "fft-icp1 [%]"},
      {},
      2};
  for (const std::string& dataset : datasets_in_order(outcomes)) {
    for (const Variant variant : kBoth) {
      std::vector<const PairOutcome*> two, one;
      for (const PairOutcome& o : outcomes) {
        if (o.dataset != dataset) continue;
        if (o.method == find_method(columns, variant, "fft-icp2")) two.push_back(&o);
        if (o.method == find_method(columns, variant, "fft-icp1")) one.push_back(&o);
      }
      const BenchRow row = sum_up(two);
      const auto used =
          static_cast<double>(row.rotation_sources[static_cast<std::size_t>(RotationSource::kMissingData)]);
      table.rows.push_back({dataset, variant_name(variant), fmt::format("{}", row.n),
                            percent(used / static_cast<double>(row.n)),
                            percent(static_cast<double>(row.shortcut_right) / used), percent(row.success()),
                            percent(sum_up(one).success())});
    }
  }
  return table;
}

}  // namespace phasescan
