#include "localize_output.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "io/tum.hpp"
#include "phasescan/core/time.hpp"
#include "report/localize_report.hpp"

namespace phasescan::app {
namespace {

using Json = nlohmann::ordered_json;

// Rules of the verdict, and what a probability must reach.
constexpr double kGood = 0.95, kFailed = 0.2, kLeastWithPose = 0.9;

std::string text_of(const Json& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::replace);
}

double rounded(double value, double per_unit) {
  return std::round(value * per_unit) / per_unit;
}

Json pose_json(const Pose2& p) {
  return {{"x", p.x}, {"y", p.y}, {"theta", p.theta}};
}

std::string lines_of(const LocalizeRun& run) {
  std::string text;
  for (std::size_t i = 0; i < run.updates.size(); ++i) {
    const LocalizationUpdate& u = run.updates[i];
    Json line{{"stamp", stamp_to_seconds(u.stamp)}, {"status", to_string(u.status)}};
    line["pose"] = u.T_map_base ? pose_json(*u.T_map_base) : Json(nullptr);
    if (u.T_map_base) {
      Json& numbers = line["covariance"] = Json::array();
      for (int k = 0; k < 9; ++k) numbers.push_back(u.covariance(k / 3, k % 3));
    } else {
      line["covariance"] = nullptr;
    }
    line["confidence"] = u.confidence;
    Json& hypotheses = line["hypotheses"] = Json::array();
    for (const PoseEstimate& h : u.hypotheses)
      hypotheses.push_back({{"pose", pose_json(h.T_map_base)}, {"confidence", h.confidence}});
    line["explained"] = rounded(u.fit.explained, 1e4);
    line["contradicting"] = rounded(u.fit.contradicting, 1e4);
    if (run.times) line["ms"] = rounded(static_cast<double>(run.cpu_ms[i]), 1e4);
    text += line.dump() + "\n";
  }
  return text;
}

double percentile(std::vector<float> values, double q) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  return rounded(static_cast<double>(values[static_cast<std::size_t>(q * static_cast<double>(values.size() - 1))]),
                 1e4);
}

Json reasons_json(const LocalizeVerdict& verdict) {
  Json list = Json::array();
  for (const LocalizeReason& r : verdict.reasons) {
    list.push_back(
        {{"kind", r.kind}, {"count", r.count}, {"first_stamp", stamp_to_seconds(r.first_stamp)}, {"what", r.what}});
  }
  return list;
}

Json summary_of(const LocalizeRun& run, const LocalizeVerdict& verdict) {
  Json statuses = Json::object();
  for (std::size_t k = 0; k < verdict.by_status.size(); ++k)
    statuses[to_string(static_cast<TrackingStatus>(k))] = verdict.by_status[k];
  Json warnings = Json::object();
  for (const auto& [kind, count] : run.damages) warnings[kind] = count;
  const auto is_ok = [](const LocalizationUpdate& u) { return u.status == TrackingStatus::kOk; };
  const auto first = std::find_if(run.updates.begin(), run.updates.end(), is_ok);
  std::size_t searches = 0;
  for (const LocalizationUpdate& u : run.updates) searches += u.searched;
  Json map{{"file", run.map_name},
           {"free_area_m2", rounded(run.free_area_m2, 10)},
           {"views", run.views},
           {"memory_mib", rounded(static_cast<double>(run.map_bytes) / (1 << 20), 100)}};
  if (run.times) map["preparation_ms"] = rounded(1e3 * run.prepare_cpu_s, 100);
  if (run.times && run.map_was_kept) map["was_kept"] = *run.map_was_kept;
  Json summary{{"log", std::filesystem::path(run.log).filename().string()},
               {"format", run.format},
               {"complete", run.complete},
               {"each", run.each},
               {"scans", run.updates.size()},
               {"verdict", verdict.word},
               {"verdict_probability", rounded(verdict.probability, 1e4)},
               {"reasons", reasons_json(verdict)},
               {"statuses", statuses},
               {"searches", searches},
               {"first_ok_scan", first == run.updates.end() ? Json(nullptr) : Json(first - run.updates.begin())},
               {"odometry", {{"used", run.odometry_used}, {"assumed", run.odometry_assumed}}},
               {"map", map},
               {"warnings", warnings}};
  if (run.times) {
    summary["ms"] = {{"p50", percentile(run.cpu_ms, 0.5)},
                     {"p95", percentile(run.cpu_ms, 0.95)},
                     {"p99", percentile(run.cpu_ms, 0.99)},
                     {"max", percentile(run.cpu_ms, 1.0)}};
  }
  return summary;
}

std::string verdict_text(const LocalizeVerdict& verdict) {
  return fmt::format("{} (probability {:.2f})", verdict.word, verdict.probability);
}

std::string report_of(const TrinaryMap& map, const LocalizeRun& run, const LocalizeVerdict& verdict,
                      const Json& summary) {
  LocalizeReport report;
  report.log_name = summary["log"];
  report.map = &map;
  report.updates = &run.updates;
  report.each = run.each;
  report.min_confidence = run.min_confidence;
  report.verdict = verdict_text(verdict);
  for (const LocalizeReason& r : verdict.reasons) report.reasons.push_back(r.kind + ": " + r.what);
  report.facts = {{"scans", summary["scans"].dump()}};
  for (const auto& [name, count] : summary["statuses"].items()) report.facts.emplace_back(name, count.dump());
  report.facts.emplace_back("searches of the whole map", summary["searches"].dump());
  report.facts.emplace_back("odometry", run.odometry_assumed);
  report.facts.emplace_back("free area of the map [m2]", summary["map"]["free_area_m2"].dump());
  report.facts.emplace_back("places that it is described from", summary["map"]["views"].dump());
  for (const auto& [kind, count] : run.damages) report.warnings.push_back(fmt::format("{}: {}", kind, count));
  if (run.times) {
    report.times = {{"preparation of the map [ms]", summary["map"]["preparation_ms"].dump()}};
    for (const auto& [name, ms] : summary["ms"].items())
      report.times.emplace_back("CPU of a scan, " + name + " [ms]", ms.dump());
  }
  return format_localize_report(report);
}

/// Scans of a status as a reason.
void add_reason(const LocalizeRun& run, TrackingStatus status, const char* kind, const char* text,
                LocalizeVerdict& verdict) {
  LocalizeReason reason;
  reason.kind = kind;
  for (const LocalizationUpdate& u : run.updates) {
    if (u.status != status) continue;
    if (reason.count++ == 0) reason.first_stamp = u.stamp;
  }
  if (reason.count == 0) return;
  reason.what = fmt::format("{} of {} scans {}", reason.count, run.updates.size(), text);
  verdict.reasons.push_back(std::move(reason));
}

}  // namespace

LocalizeVerdict judge_run(const LocalizeRun& run) {
  LocalizeVerdict verdict;
  std::size_t after = 0, with_pose = 0;
  double sum = 0.0;
  bool located = false;
  for (const LocalizationUpdate& u : run.updates) {
    ++verdict.by_status[static_cast<std::size_t>(u.status)];
    located |= u.status == TrackingStatus::kOk;
    if (!located) continue;
    ++after;
    with_pose += u.has_pose();
    if (u.has_pose()) sum += u.confidence;
  }
  const double share = after > 0 ? static_cast<double>(with_pose) / static_cast<double>(after) : 0.0;
  verdict.probability = with_pose > 0 ? share * sum / static_cast<double>(with_pose) : 0.0;
  add_reason(run, TrackingStatus::kLost, "contradiction", "are on no place of the map that explains them", verdict);
  add_reason(run, TrackingStatus::kAmbiguous, "aliasing", "are explained by several places of the map", verdict);
  add_reason(run, TrackingStatus::kInitialising, "bad_scans", "have too few returns to be looked for", verdict);
  std::stable_sort(verdict.reasons.begin(), verdict.reasons.end(),
                   [](const LocalizeReason& a, const LocalizeReason& b) { return a.count > b.count; });
  if (!located || verdict.probability <= kFailed) {
    verdict.word = "failed";
  } else {
    verdict.word = share >= kLeastWithPose && verdict.probability >= kGood ? "good" : "doubtful";
  }
  if (verdict.word == "good") verdict.reasons.clear();
  return verdict;
}

FileSet localize_output(const std::string& folder, const TrinaryMap& map, const LocalizeRun& run,
                        const LocalizeVerdict& verdict) {
  FileSet files(folder);
  std::vector<StampedPose> poses;
  for (const LocalizationUpdate& u : run.updates) {
    if (u.has_pose()) poses.push_back({u.stamp, *u.T_map_base});
  }
  files.add("trajectory.tum", format_tum(poses));
  files.add("localization.jsonl", lines_of(run));
  const Json summary = summary_of(run, verdict);
  files.add("report.html", report_of(map, run, verdict, summary));
  files.add("summary.json", text_of(summary) + "\n");  // put in place last: beside a new summary all is new
  return files;
}

std::vector<EndingLine> localize_ending(const LocalizeRun& run, const LocalizeVerdict& verdict,
                                        const std::string& folder) {
  std::string scans = std::to_string(run.updates.size());
  for (const TrackingStatus status : {TrackingStatus::kOk, TrackingStatus::kDegraded, TrackingStatus::kAmbiguous,
                                      TrackingStatus::kLost, TrackingStatus::kInitialising}) {
    if (const std::size_t n = verdict.by_status[static_cast<std::size_t>(status)]; n > 0)
      scans += fmt::format(", {} {}", n, to_string(status));
  }
  if (!run.complete) scans += " (stopped before the end of the log)";
  std::string word = verdict_text(verdict);
  if (!verdict.reasons.empty()) word += ": " + verdict.reasons.front().what;
  return {{"scans", scans},
          {"map", fmt::format("{:.0f} m2 free, described from {} places", run.free_area_m2, run.views)},
          {"verdict", word},
          {"open", (std::filesystem::path(folder) / "report.html").string()}};
}

}  // namespace phasescan::app
