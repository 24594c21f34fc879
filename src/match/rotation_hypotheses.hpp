/// The rotations that the global search correlates at: all of them, or those that a cheaper source names.
#pragma once

#include <optional>
#include <vector>

#include "match/prepared_scan.hpp"
#include "phasescan/match/options.hpp"
#include "phasescan/match/result.hpp"

namespace phasescan {

struct RotationHypothesis {
  double theta = 0.0;  ///< [rad]
  RotationSource source = RotationSource::kSweep;
};

/// One object per thread.
class RotationHypotheses {
 public:
  explicit RotationHypotheses(const GlobalOptions& options) : options_(options) {}

  /// Rotations of the scan worth a correlation. With a guess those within guess_turn_deg of it, whatever the source;
  /// else the proposed ones, or, where that is null, those that the options name.
  void list(const PreparedScan& reference, const PreparedScan& scan, const std::optional<Pose2>& guess,
            const std::vector<RotationHypothesis>* proposed, std::vector<RotationHypothesis>& out);

  /// Every rotation of the complete sweep.
  void list_all(std::vector<RotationHypothesis>& out) const;

 private:
  void all(double centre, int steps_each_side, std::vector<RotationHypothesis>& out) const;

  GlobalOptions options_;
  std::vector<double> angles_;
};

}  // namespace phasescan
