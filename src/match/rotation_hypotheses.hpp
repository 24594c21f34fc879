/// The rotations fft-mh correlates at: all of them, or those that a cheaper source names.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "match/mh_options.hpp"
#include "match/prepared_scan.hpp"
#include "phasescan/match/result.hpp"

namespace phasescan {

struct RotationHypothesis {
  double theta = 0.0;  ///< [rad]
  RotationSource source = RotationSource::kSweep;
};

/// One object per thread.
class RotationHypotheses {
 public:
  explicit RotationHypotheses(const MhOptions& options);
  ~RotationHypotheses();

  /// Rotations of the scan worth a correlation. With a guess those within guess_turn_deg of it, whatever the source.
  void list(const PreparedScan& reference, const PreparedScan& scan, const std::optional<Pose2>& guess,
            std::vector<RotationHypothesis>& out);

  /// Every rotation of the complete sweep.
  void list_all(std::vector<RotationHypothesis>& out) const;

 private:
  struct Spectral;
  void all(double centre, int steps_each_side, std::vector<RotationHypothesis>& out) const;

  MhOptions options_;
  std::vector<double> angles_;
  std::unique_ptr<Spectral> spectral_;  // only where asked for
};

}  // namespace phasescan
