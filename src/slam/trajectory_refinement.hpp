/// The last pass: every scan is matched once more, against the map that all visits made together.
#pragma once

#include <span>
#include <vector>

#include "phasescan/core/pose2.hpp"
#include "phasescan/match/scan_matcher.hpp"
#include "phasescan/odometry/options.hpp"
#include "slam/backend.hpp"
#include "slam/scan_store.hpp"

namespace phasescan {

struct ScanLedger;

/// How the scans fit the map in the last pass.
struct RefinementFit {
  std::size_t scans = 0;     ///< that were matched
  std::size_t kept = 0;      ///< whose match would have moved them far, or explained too little
  double overlap_sum = 0.0;  ///< of shares of hits that lie on the map

  double mean_overlap() const { return scans > 0 ? overlap_sum / static_cast<double>(scans) : 1.0; }
};

/// Without bounded memory only: every keyframe is a node, every scan is in the store.
/// @param fit    null, or where it goes
/// @param guess  pose of the base at each scan's stamp, on the map
/// @return the same, better: a scan whose match moves it far, or does not succeed, keeps its pose; one that tracking
///         had lost is led back from where it found its way again, if the map agrees
/// @cost one registration per scan, one local map per keyframe
std::vector<Pose2> refine_trajectory(const Backend& backend, const ScanStore& scans, std::span<const Pose2> guess,
                                     const ScanLedger& ledger, const OdometryOptions& options,
                                     const MatchOptions& match, RefinementFit* fit = nullptr);

}  // namespace phasescan
