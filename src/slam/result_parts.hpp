/// Drives that nothing ties to each other, each group a result by itself.
#pragma once

#include <vector>

#include "slam/backend.hpp"
#include "slam/scan_ledger.hpp"

namespace phasescan {

/// Fills in `sessions` and, where there are several groups of them, `parts` of a result that is finished otherwise.
/// @param poses          of all scans, as they were given to make_result
/// @param frame_session  the drive whose part keeps the map's frame; each other part has the frame of its first drive
void make_parts(const Backend& backend, const ScanLedger& ledger, const std::vector<Pose2>& poses, bool refined,
                std::size_t frame_session, const SlamOptions& options, SlamResult& result);

}  // namespace phasescan
