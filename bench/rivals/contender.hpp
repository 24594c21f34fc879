/// A matcher in the comparison, ours or another's, behind one door.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "phasescan/core/pose2.hpp"
#include "phasescan/scan/scan.hpp"

namespace phasescan::rivals {

struct Contender {
  std::string name;      ///< row of the tables
  std::string settings;  ///< what it is and how it is set, one sentence
  /// T_ref_scan from raw ranges, with no first guess; keeps its buffers between calls. Each scan's own beam directions
  /// count: every contender starts from the Cartesian points of scan_to_points.
  std::function<Pose2(const Scan& reference, const Scan& scan)> match;
};

/// Two contenders that do the same, so that one can be held against the other.
struct Duel {
  std::string caption;
  std::string ours;
  std::vector<std::string>
      theirs;  ///< settings of one rival: the one with the most successes in the whole run is taken
};

/// Gate of the ICP comparison, in both programs from the first to the last iteration [m].
inline constexpr double kDuelGate_m = 0.5;
/// Iterations at most, as in [Jiang19] Sec. 5.2.
inline constexpr int kIterations = 200;

std::vector<Contender> own_contenders();
// Each defined where its library was found.
std::vector<Contender> pcl_contenders();
std::vector<Contender> mrpt_contenders();
std::vector<Contender> opencv_contenders();

/// The duels that all of `contenders` allow.
std::vector<Duel> duels(const std::vector<Contender>& contenders);

}  // namespace phasescan::rivals
