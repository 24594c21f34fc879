#include <nlohmann/json.hpp>

#include "eval/bench_report.hpp"

namespace phasescan {
namespace {

using Json = nlohmann::ordered_json;

/// Section -> option -> value in force.
Json options_json(const AnyMatchOptions& options) {
  Json out;
  AnyMatchOptions::visit_sections(options, [&](std::string_view section, const auto& values) {
    using Section = std::decay_t<decltype(values)>;
    Json& at = out[std::string(section)];
    Section::visit(values, [&](std::string_view name, const auto& value, const OptionInfo&) {
      using T = std::decay_t<decltype(value)>;
      if constexpr (std::is_enum_v<T>) {
        at[std::string(name)] = std::string(to_string(value));
      } else {
        at[std::string(name)] = value;
      }
    });
  });
  return out;
}

Json moments_json(const Moments& m) {
  return {{"mean", m.mean}, {"variance", m.variance}, {"std", m.std}, {"median", m.median}};
}

Json success_json(std::size_t n, std::size_t count, double share, const Interval& interval) {
  if (n == 0) return nullptr;
  return {{"n", n}, {"count", count}, {"share", share}, {"low", interval.low}, {"high", interval.high}};
}

Json row_json(const BenchRow& row, const std::vector<BenchMethod>& methods, const BenchInfo& info, double fft_ms) {
  Json out{{"dataset", row.dataset}, {"class", row.cls}, {"method", methods[row.method].name}, {"n", row.n}};
  out["success"] = success_json(row.with_truth, row.right, row.success(), row.interval);
  out["honesty"] = {{"right_usable", row.right_usable},
                    {"right_refused", row.right_refused},
                    {"wrong_refused", row.wrong_refused},
                    {"wrong_usable", row.wrong_usable}};
  out["ambiguous"] = row.ambiguous;
  out["errors"] = {
      {"x_m", moments_json(row.x_m)}, {"y_m", moments_json(row.y_m)}, {"rotation_deg", moments_json(row.rotation_deg)}};
  out["nees_below_7_81"] = row.nees_below;
  out["times_the_bound"] = row.efficiency;
  out["weak"] = {{"n", row.weak}, {"ambiguous", row.weak_ambiguous}, {"across_below_0_1_m", row.weak_across}};
  out["success_without_weak"] = success_json(row.known(), row.known_right(), row.known_success(), row.known_interval);
  if (row.with_confidence > 0) {
    out["confidence"] = {{"n", row.with_confidence}, {"auc", row.auc}, {"calibration_error", row.calibration_error}};
  } else {
    out["confidence"] = nullptr;
  }
  Json sources;
  const auto names = enum_names<RotationSource>();
  for (std::size_t s = 0; s < names.size(); ++s) sources[std::string(names[s])] = row.rotation_sources[s];
  out["rotation_source"] = sources;
  out["missing_data_right"] = row.shortcut_right;
  if (info.times) {
    Json& ms = out["ms"];
    for (std::size_t s = 0; s < row.times.size(); ++s) {
      const TimeRow& t = row.times[s];
      ms[kTimedSteps[s]] = {{"mean", t.mean}, {"p50", t.p50}, {"p95", t.p95}, {"p99", t.p99}};
    }
    ms["p50_in_ffts"] = row.times[0].p50 / fft_ms;
  }
  return out;
}

}  // namespace

std::string bench_json(const BenchRun& run, const std::vector<BenchMethod>& methods, const BenchInfo& info) {
  Json out{{"phasescan", info.version}, {"command", "bench"}, {"sources", info.sources}, {"pairs", run.pairs}};
  out["success_limits"] = {{"translation_m", kSuccessTranslation_m}, {"rotation_deg", kSuccessRotation_deg}};
  if (info.times)
    out["timing"] = {{"fft_128_r2c_ms", run.fft_ms},
                     {"repeat", info.repeat},
                     {"clock", "CPU time of all threads"},
                     {"reference_prepared", info.prepared}};
  for (const BenchMethod& method : methods) out["options"][method.name] = options_json(method.options);
  out["rows"] = Json::array();
  for (const BenchRow& row : pair_rows(run.outcomes)) out["rows"].push_back(row_json(row, methods, info, run.fft_ms));
  out["totals"] = Json::array();
  for (const BenchRow& row : pair_totals(run.outcomes))
    out["totals"].push_back(row_json(row, methods, info, run.fft_ms));
  return out.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace phasescan
