/// The last pass: every scan is matched once more, against the map that all visits made together.
#pragma once

#include <span>
#include <vector>

#include "phasescan/core/pose2.hpp"
#include "phasescan/odometry/options.hpp"
#include "slam/backend.hpp"
#include "slam/scan_store.hpp"

namespace phasescan {

struct ScanLedger;

/// Without bounded memory only: every keyframe is a node, every scan is in the store.
/// @param guess  pose of the base at each scan's stamp, on the map
/// @return the same, better: a scan whose match moves it far, or does not succeed, keeps its pose
/// @cost one registration per scan, one local map per keyframe
std::vector<Pose2> refine_trajectory(const Backend& backend, const ScanStore& scans, std::span<const Pose2> guess,
                                     const ScanLedger& ledger, const OdometryOptions& options);

}  // namespace phasescan
