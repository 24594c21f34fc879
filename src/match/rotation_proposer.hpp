/// Rotations for the global search from outside, in place of its own: how it is compared with other sources.
#pragma once

#include <memory>
#include <vector>

#include "match/prepared_scan.hpp"
#include "match/rotation_hypotheses.hpp"

namespace phasescan {

/// One object per matcher.
class RotationProposer {
 public:
  /// What a proposer keeps of one scan.
  struct Cue {
    virtual ~Cue() = default;
  };

  virtual ~RotationProposer() = default;
  virtual std::unique_ptr<Cue> make_cue() const = 0;
  /// Fills a cue of its own making.
  virtual void describe(const Scan& scan, Cue& out) = 0;
  /// Rotations of the scan worth a correlation; none: every rotation is tried.
  virtual void propose(const PreparedScan& reference, const Cue& of_reference, const PreparedScan& scan,
                       const Cue& of_scan, std::vector<RotationHypothesis>& out) = 0;
};

}  // namespace phasescan
