#include "slam/run_judge.hpp"

#include <algorithm>
#include <utility>

#include "slam/run_evidence.hpp"
#include "slam/run_findings.hpp"
#include "slam/verdict.hpp"

namespace phasescan {
namespace {

/// The scan of a result with the stamp that a scan of the whole run has.
ScanId scan_of_result(const SlamResult& result, const SlamResult& whole, ScanId scan) {
  if (scan < 0 || &result == &whole) return scan;
  const Stamp stamp = whole.scans[static_cast<std::size_t>(scan)].stamp;
  const auto found =
      std::find_if(result.scans.begin(), result.scans.end(), [stamp](const ScanResult& s) { return s.stamp == stamp; });
  return found == result.scans.end() ? -1 : found - result.scans.begin();
}

/// Nodes that a result is drawn from, with their scans' poses in the frame of the whole run.
/// @param part  -1: the whole run
FinishedRun finished_run(const Backend& backend, const ScanLedger& ledger, bool refined, const SlamResult& whole,
                         int part) {
  const SlamResult& result = part < 0 ? whole : whole.parts[static_cast<std::size_t>(part)];
  FinishedRun run;
  run.result = &result;
  run.backend = &backend;
  run.deskew = whole.deskewed;
  run.wheels_scan = scan_of_result(result, whole, ledger.wheels_off);
  if (const int node = backend.doubted_node(); node >= 0)
    run.doubted_scan = scan_of_result(result, whole, backend.keyframes()[static_cast<std::size_t>(node)].scan);
  std::size_t of_result = 0;
  for (std::size_t i = 0; i < backend.keyframes().size(); ++i) {
    const Keyframe& keyframe = backend.keyframes()[i];
    if (part >= 0 && whole.sessions[static_cast<std::size_t>(keyframe.session)].part != part) continue;
    const std::size_t k = of_result++;
    if (!result.drawn[k]) continue;
    run.nodes.push_back(static_cast<int>(i));
    run.scans.push_back(result.keyframes[k].scan);
    run.T_map_stamp.push_back(refined ? whole.scans[static_cast<std::size_t>(keyframe.scan)].T_map_base
                                      : backend.poses()[i] * keyframe.T_mid_stamp);
  }
  return run;
}

/// Whether there is one map of all that was driven.
bool in_parts(const SlamResult& result) {
  return !result.parts.empty();
}

void judge_result(FinishedRun run, const RefinementFit& fit, const std::map<LaserId, OwnBodyState>& bodies,
                  const InputCheckState& input, SlamResult& result) {
  run.fit = fit;
  for (const auto& [laser, body] : bodies) run.body_sectors += body.sectors.size();
  const RunEvidence evidence = gather_evidence(run);
  Judgement judgement = judge_run(evidence, in_parts(result));
  result.findings = run_findings(result, evidence, judgement, bodies, input);
  result.verdict = std::move(judgement.verdict);
}

}  // namespace

void judge(const Backend& backend, const ScanLedger& ledger, const RefinementFit& fit, bool refined,
           const std::map<LaserId, OwnBodyState>& bodies, const InputCheckState& input, SlamResult& result) {
  for (std::size_t k = 0; k < result.parts.size(); ++k)
    judge_result(finished_run(backend, ledger, refined, result, static_cast<int>(k)), fit, bodies, input,
                 result.parts[k]);
  judge_result(finished_run(backend, ledger, refined, result, -1), fit, bodies, input, result);
}

}  // namespace phasescan
