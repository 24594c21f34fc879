#include "slam/run_findings.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <utility>

namespace phasescan {
namespace {

constexpr double kSlippedShare = 0.1;    // of the wheels' steps: fewer is what any floor does
constexpr std::size_t kFewestSteps = 5;  // of wheels that say something
constexpr double kGapWayM = 0.5;         // way without a scan that matters
constexpr std::size_t kFewestScans = 3;  // that contradict: a person is not a wall

std::string number(double value, int digits) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%.*f", digits, value);
  return text.data();
}

std::string counted(std::size_t count, const char* one, const char* several) {
  return std::to_string(count) + " " + (count == 1 ? one : several);
}

/// The finding seen first at a scan of the result.
RunFinding at_scan(const SlamResult& result, RunFinding finding, ScanId scan) {
  if (scan < 0 || static_cast<std::size_t>(scan) >= result.scans.size()) return finding;
  finding.scan = scan;
  finding.first_stamp = result.scans[static_cast<std::size_t>(scan)].stamp;
  return finding;
}

RunFinding bad_scans(const SlamResult& result) {
  RunFinding finding{"bad_scans", 0, 0, "scans that fit neither the one before nor the one after were left out", -1};
  ScanId first = -1;
  for (std::size_t i = 0; i < result.scans.size(); ++i) {
    if (!result.scans[i].left_out) continue;
    if (finding.count++ == 0) first = static_cast<ScanId>(i);
  }
  return at_scan(result, std::move(finding), first);
}

RunFinding own_body(const OwnBodyState& body, const SlamResult& result, const InputCheckState& input) {
  RunFinding finding{"own_body", body.sectors.size(), 0, "", -1};
  if (body.sectors.empty()) return finding;
  finding.what = "the robot itself is seen in " + format_sectors(body.sectors) + "; left out";
  const auto oddity = input.oddities.find("own body");
  if (oddity != input.oddities.end() && static_cast<std::size_t>(oddity->second.first) < result.scans.size())
    finding.first_stamp = result.scans[static_cast<std::size_t>(oddity->second.first)].stamp;
  return finding;
}

/// Loops that were rejected since places look alike that are not the same.
RunFinding aliasing(const SlamResult& result, const RunEvidence& evidence) {
  return at_scan(result,
                 {"aliasing", result.loops.rejected_beyond_drift + result.loops.rejected_alike, 0,
                  "places look alike that are not the same; what they suggest was rejected", -1},
                 evidence.doubted_scan);
}

RunFinding wheels(const SlamResult& result, const RunEvidence& evidence) {
  const WheelCounts& counts = result.wheels;
  const std::size_t off = counts.slipped + counts.reversed + counts.jumped;
  RunFinding finding{"wheels", 0, 0, "", -1};
  if (off < kFewestSteps || static_cast<double>(off) < kSlippedShare * static_cast<double>(counts.steps))
    return finding;
  finding.count = off;
  finding.what =
      "wheels and scans disagree in " + std::to_string(off) + " of " + std::to_string(counts.steps) + " steps";
  if (evidence.wheels_went_on()) {
    finding.what = "the wheels drove " + number(evidence.wheels_way_m, 1) + " m where the scans show " +
                   number(evidence.wheels_seen_m, 1) + " m; is the robot in its own view?";
  }
  return at_scan(result, std::move(finding), evidence.wheels_scan);
}

RunFinding pieces(const SlamResult& result) {
  if (!result.parts.empty()) {
    return at_scan(
        result,
        {"pieces", result.parts.size(), 0,
         "nothing ties all drives to each other; they are in " + std::to_string(result.parts.size()) + " parts", -1},
        result.sessions.size() > 1 ? result.sessions[1].first_scan : -1);
  }
  const std::size_t off = result.scans_off_the_map();
  RunFinding finding{"pieces", 0, 0, "", -1};
  if (off == 0) return finding;
  finding.count = static_cast<std::size_t>(result.pieces);
  finding.what =
      "nothing ties " + counted(off, "scan", "scans") + " to the map: tracking broke and no place was seen again";
  const auto first =
      std::find_if(result.scans.begin(), result.scans.end(), [](const ScanResult& s) { return !s.on_map; });
  return at_scan(result, std::move(finding), first - result.scans.begin());
}

RunFinding doubled_walls(const SlamResult& result, const RunEvidence& evidence) {
  const VisitComparison& far = evidence.map.far;
  RunFinding finding{"doubled_walls", far.doubling < kFewestScans ? 0 : far.doubling, 0,
                     "walls stand twice: " + counted(far.doubling, "scan sees", "scans see") +
                         " them 25 to 60 cm from where other visits did",
                     -1};
  return at_scan(result, std::move(finding), evidence.contradicted_scan);
}

RunFinding contradiction(const SlamResult& result, const RunEvidence& evidence) {
  const VisitComparison& far = evidence.map.far;
  RunFinding finding{"contradiction", far.contradicting < kFewestScans ? 0 : far.contradicting, 0,
                     counted(far.contradicting, "scan sees", "scans see") +
                         " through walls of other visits, or walls where these saw none",
                     -1};
  return at_scan(result, std::move(finding), evidence.contradicted_scan);
}

RunFinding gaps(const SlamResult& result, const RunEvidence& evidence) {
  auto lost = static_cast<std::size_t>(std::lround(evidence.lost * evidence.scans));
  if (lost < kFewestScans) lost = 0;
  RunFinding finding{"gaps", lost, 0, counted(lost, "scan was", "scans were") + " not matched", -1};
  if (evidence.longest_gap_m > kGapWayM) {
    ++finding.count;
    finding.what += std::string(lost > 0 ? ", and" : ":") + " no scan shows a way of " +
                    number(evidence.longest_gap_m, 1) + " m in " + number(evidence.longest_gap_s, 1) + " s";
    if (lost == 0) finding.what = "no scan shows a way of " + number(evidence.longest_gap_m, 1) + " m";
  }
  return at_scan(result, std::move(finding), evidence.gap_scan);
}

/// Where none of the reasons by itself is one, the kind that weighs most still is.
RunFinding strongest(const SlamResult& result, const RunEvidence& evidence, const Judgement& judgement) {
  const std::string kind = judgement.weights.empty() ? "gaps" : judgement.weights.front().kind;
  RunFinding finding{kind, 1, 0, "", -1};
  if (kind == "contradiction" || kind == "doubled_walls") {
    finding.what = "visits of one place do not fit each other everywhere";
    return at_scan(result, std::move(finding), evidence.contradicted_scan);
  }
  if (kind == "aliasing") {
    finding.what = "loops contradict each other";
    return at_scan(result, std::move(finding), evidence.doubted_scan);
  }
  if (kind == "wheels")
    finding.what = "wheels and scans do not agree everywhere";
  else if (kind == "bad_scans")
    finding.what = "many scans do not fit the map well";
  else if (kind == "pieces")
    finding.what = "tracking began anew";
  else
    finding.what = "scans leave the way open by " + number(evidence.expected_m, 2) + " m, and no loop closes it";
  return kind == "gaps" ? at_scan(result, std::move(finding), evidence.gap_scan) : finding;
}

}  // namespace

std::vector<RunFinding> run_findings(const SlamResult& result, const RunEvidence& evidence, const Judgement& judgement,
                                     const std::map<LaserId, OwnBodyState>& bodies, const InputCheckState& input) {
  std::vector<RunFinding> findings;
  const auto add = [&findings](RunFinding finding) {
    if (finding.count > 0) findings.push_back(std::move(finding));
  };
  add(pieces(result));
  add(contradiction(result, evidence));
  add(doubled_walls(result, evidence));
  add(gaps(result, evidence));
  add(wheels(result, evidence));
  add(aliasing(result, evidence));
  add(bad_scans(result));
  for (const auto& [laser, body] : bodies) add(own_body(body, result, input));
  const auto against = [&](const RunFinding& finding) {
    if (finding.kind == "pieces" && !result.parts.empty()) return 1e9;  // then there is no one map
    for (const ReasonWeight& weight : judgement.weights) {
      if (weight.kind == finding.kind) return weight.against;
    }
    return 0.0;
  };
  std::stable_sort(findings.begin(), findings.end(),
                   [&](const RunFinding& a, const RunFinding& b) { return against(a) > against(b); });
  if (findings.empty() && judgement.verdict.verdict != Verdict::kGood)
    findings.push_back(strongest(result, evidence, judgement));
  return findings;
}

}  // namespace phasescan
