#include "slam_output.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "io/file.hpp"
#include "map/glass.hpp"
#include "output/g2o.hpp"
#include "output/map_file.hpp"
#include "io/tum.hpp"
#include "phasescan/map/trinary_map.hpp"
#include "report/slam_report.hpp"
#include "slam_summary.hpp"

namespace phasescan::app {
namespace {

using Json = nlohmann::ordered_json;

/// Names of files may hold bytes that are no UTF-8.
std::string text_of(const Json& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::replace);
}

/// Sure panes in their colour, possible ones half as strong.
std::vector<MapPaint> paints_of(const TrinaryMap& map, const std::vector<GlassPane>& panes) {
  std::vector<MapPaint> paints;
  for (const GlassPane& pane : panes) {
    std::array<std::uint8_t, 3> rgb{0x56, 0xb4, 0xe9};
    if (pane.kind == GlassKind::kBlack) rgb = {0xb2, 0x67, 0x9c};
    if (!pane.sure) {
      for (std::uint8_t& v : rgb) v = static_cast<std::uint8_t>(128 + v / 2);
    }
    paints.push_back({cells_of(map, pane), rgb});
  }
  return paints;
}

std::vector<std::string> warning_lines(const Json& summary, const SlamRun& run) {
  std::vector<std::string> lines;
  for (const auto& [kind, count] : summary["warnings"].items()) {
    const auto first = run.first_seen.find(kind);
    std::string line = fmt::format("{}: {}", kind, count.get<std::size_t>());
    if (first != run.first_seen.end()) line += ", first at " + first->second;
    lines.push_back(std::move(line));
  }
  return lines;
}

/// Why a scan counts for nothing.
Json left_out(const ScanResult& scan) {
  if (scan.repeated) return "repeated";
  if (scan.left_out) return "bad scan";
  return nullptr;
}

/// A line per scan: when, how it was tracked, where it stands.
std::string scan_lines(const SlamResult& result) {
  std::string text;
  const auto pose = [](const Pose2& p) { return Json{{"x", p.x}, {"y", p.y}, {"theta", p.theta}}; };
  for (const ScanResult& scan : result.scans) {
    Json line{{"stamp", stamp_to_seconds(scan.stamp)},
              {"status", to_string(scan.status)},
              {"left_out", left_out(scan)},
              {"odom_pose", pose(scan.T_odom_base)},
              {"pose", pose(scan.T_map_base)}};
    if (scan.covariance) {
      Json& numbers = line["covariance"] = Json::array();
      for (int i = 0; i < 9; ++i) numbers.push_back((*scan.covariance)(i / 3, i % 3));
    } else {
      line["covariance"] = nullptr;
    }
    text += line.dump() + "\n";
  }
  return text;
}

/// The verdict with its reasons, each with the place where the robot was when it was seen.
void add_verdict(const SlamResult& result, SlamReport& report) {
  report.verdict = fmt::format("{}: the trajectory is within 0.2 m or 1 % of its length with a probability of {:.1f} %",
                               to_string(result.verdict.verdict), 100.0 * result.verdict.probability);
  for (const RunFinding& finding : result.findings) {
    VerdictReason reason{finding.kind, finding.count, finding.first_stamp, finding.what, {}, {}};
    if (finding.scan >= 0 && static_cast<std::size_t>(finding.scan) < result.scans.size()) {
      const Pose2& pose = result.scans[static_cast<std::size_t>(finding.scan)].T_map_base;
      reason.x = pose.x, reason.y = pose.y;
    }
    report.reasons.push_back(std::move(reason));
  }
}

std::string report_of(const SlamResult& result, const SlamRun& run, const Json& summary) {
  SlamReport report;
  add_verdict(result, report);
  report.log_name = summary["log"];
  report.result = &result;
  report.overlap = run.overlap;
  report.complete = run.complete;
  report.shown = &run.shown;
  if (run.times) report.cpu_ms = run.cpu_ms;
  for (const char* key : {"format", "scans", "scans_tracked", "keyframes", "path_length_m"}) {
    report.facts.emplace_back(key, summary[key].is_string() ? summary[key].get<std::string>() : summary[key].dump());
  }
  for (const char* key : {"found", "accepted", "rejected"})
    report.facts.emplace_back(std::string("loops ") + key, summary["loops"][key].dump());
  report.facts.emplace_back("glass and black surfaces",
                            fmt::format("{}, {} m; {} more possible", summary["glass"]["count"].dump(),
                                        summary["glass"]["total_m"].dump(), summary["glass"]["possible_count"].dump()));
  report.facts.emplace_back("odometry", run.odometry_assumed);
  report.warnings = warning_lines(summary, run);
  return format_slam_report(report);
}

}  // namespace

std::string verdict_text(const SlamResult& result) {
  std::string text = to_string(result.verdict.verdict);
  if (!result.findings.empty()) text += ": " + result.findings.front().kind + ": " + result.findings.front().what;
  return text;
}

FileSet slam_output(const std::string& folder, const SlamResult& result, const SlamRun& run) {
  make_folder(folder);
  FileSet files(folder);
  std::vector<StampedPose> stamped;
  stamped.reserve(result.scans.size());
  for (const ScanResult& scan : result.scans) stamped.push_back({scan.stamp, scan.T_map_base});
  files.add("trajectory.tum", format_tum(stamped));
  stamped = {};
  files.add("scans.jsonl", scan_lines(result));
  files.add("graph.g2o", format_g2o(result.keyframes, result.edges));
  files.add("map.pgm", format_pgm(result.map));
  files.add("map.yaml", format_map_yaml(result.map, "map.pgm"));
  files.add("map.png", format_png(result.map, paints_of(result.map, result.glass)));
  const Json summary = summary_of(result, run);
  files.add("report.html", report_of(result, run, summary));
  if (run.times) {
    files.add("timing.json", text_of(timing_of(run)) + "\n");
  } else {
    files.leave_out("timing.json");
  }
  files.add("summary.json", text_of(summary) + "\n");  // put in place last: beside a new summary all is new
  return files;
}

namespace {

/// What the run knows of the drives of one part.
SlamRun run_of_part(const SlamResult& result, const SlamRun& run, std::int32_t part) {
  SlamRun out;
  out.format = run.format;
  out.source = run.source;
  out.odometry_assumed = run.odometry_assumed;
  out.odometry_used = run.odometry_used;
  out.complete = run.complete;
  out.glass_blocks = run.glass_blocks;
  out.deskew_asked = run.deskew_asked;
  out.T_base_laser = run.T_base_laser;
  out.flipped = run.flipped;
  out.times = false;
  for (SlamInput input : run.inputs) {
    const auto session = static_cast<std::size_t>(input.session);
    if (session >= result.sessions.size() || result.sessions[session].part != part) continue;
    const auto begin = run.overlap.begin() + input.first_scan;
    out.overlap.insert(out.overlap.end(), begin, begin + input.scans);
    out.tracked += input.tracked;
    out.usable += input.usable;
    out.new_segments += input.new_segments;
    for (const auto& [kind, count] : input.damages) out.damages[kind] += count;
    if (out.log.empty()) out.log = input.log;
    out.inputs.push_back(std::move(input));
  }
  return out;
}

}  // namespace

void write_parts(const std::string& folder, const SlamResult& result, const SlamRun& run) {
  for (std::size_t k = 0; k < result.parts.size(); ++k) {
    slam_output(folder + "/" + std::to_string(k + 1), result.parts[k],
                run_of_part(result, run, static_cast<std::int32_t>(k)))
        .commit();
  }
  for (std::size_t k = result.parts.size() + 1;; ++k) {
    const std::string older = folder + "/" + std::to_string(k);
    if (!std::filesystem::exists(older + "/summary.json")) return;
    FileSet files(older);
    for (const char* name : {"summary.json", "report.html", "map.png", "map.yaml", "map.pgm", "graph.g2o",
                             "scans.jsonl", "trajectory.tum", "timing.json"})
      files.leave_out(name);
    files.commit();
  }
}

}  // namespace phasescan::app
