/// Two scans drawn over each other, before and after a match.
#pragma once

#include <optional>
#include <string>

#include "phasescan/match/result.hpp"
#include "report/chart.hpp"
#include "phasescan/scan/scan.hpp"

namespace phasescan {

/// One chart with the reference's hits and the scan's hits taken into the reference frame by `T_ref_scan`, both sensors
/// marked.
Chart scan_pair_chart(const Scan& reference, const Scan& scan, const Pose2& T_ref_scan, const std::string& title);

/// The whole figure: the pair as it came (at `guess`, identity without one), at the pose found, and at up to two
/// alternatives. Under each panel's title stand confidence and pose, or, with `truth`, the error. Works for empty scans
/// and answers that are not usable.
std::string scan_pair_svg(const Scan& reference, const Scan& scan, const MatchResult& result,
                          const std::optional<Pose2>& truth = {}, const Pose2& guess = {},
                          const std::string& title = {});

/// How far a pose is from the truth: "error 0.041 m, 0.23 deg".
std::string error_text(const Pose2& T_ref_scan, const Pose2& truth);

/// "x 0.412 m, y -0.103 m, 20.4 deg".
std::string pose_text(const Pose2& pose);

}  // namespace phasescan
