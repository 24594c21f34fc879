#include "slam/run_findings.hpp"

#include <cstddef>
#include <utility>

namespace phasescan {
namespace {

RunFinding bad_scans(const SlamResult& result) {
  RunFinding finding{"bad_scans", 0, 0, "scans that fit neither the one before nor the one after were left out"};
  for (const ScanResult& scan : result.scans) {
    if (!scan.left_out) continue;
    if (finding.count++ == 0) finding.first_stamp = scan.stamp;
  }
  return finding;
}

RunFinding own_body(const OwnBodyState& body, const SlamResult& result, const InputCheckState& input) {
  RunFinding finding{"own_body", body.sectors.size(), 0, ""};
  if (body.sectors.empty()) return finding;
  finding.what = "the robot itself is seen in " + format_sectors(body.sectors) + "; left out";
  const auto oddity = input.oddities.find("own body");
  if (oddity != input.oddities.end() && static_cast<std::size_t>(oddity->second.first) < result.scans.size())
    finding.first_stamp = result.scans[static_cast<std::size_t>(oddity->second.first)].stamp;
  return finding;
}

/// Loops that were rejected since places look alike that are not the same.
RunFinding aliasing(const SlamResult& result) {
  return {"aliasing", result.loops.rejected_beyond_drift + result.loops.rejected_alike, 0,
          "places look alike that are not the same; what they suggest was rejected"};
}

}  // namespace

std::vector<RunFinding> run_findings(const SlamResult& result, const std::map<LaserId, OwnBodyState>& bodies,
                                     const InputCheckState& input) {
  std::vector<RunFinding> findings;
  const auto add = [&findings](RunFinding finding) {
    if (finding.count > 0) findings.push_back(std::move(finding));
  };
  add(bad_scans(result));
  for (const auto& [laser, body] : bodies) add(own_body(body, result, input));
  add(aliasing(result));
  return findings;
}

}  // namespace phasescan
