/// The default matcher, `global`: prepares scans, runs the search and says what the outcome is worth.
#pragma once

#include <memory>

#include "match/global_search.hpp"
#include "match/rotation_proposer.hpp"
#include "match/stage_clock.hpp"
#include "phasescan/match/scan_matcher.hpp"

namespace phasescan {

/// What is kept of a reference scan.
struct Reference::Data {
  PreparedScan prepared;
  std::unique_ptr<RotationProposer::Cue> cue;  ///< only for a matcher with a proposer
};

/// What stands behind ScanMatcher. Owns its buffers: one object per thread.
class GlobalMatcher {
 public:
  /// @param proposer  names the rotations in place of the options; null: none does
  /// @throws std::invalid_argument naming the option that is out of bounds.
  explicit GlobalMatcher(const MatchOptions& options, std::unique_ptr<RotationProposer> proposer = nullptr);

  /// As ScanMatcher's.
  MatchResult match(const Scan& reference, const Scan& scan, const MatchHints& hints);
  Reference prepare(const Scan& reference, const Twist2& twist);
  /// @throws std::invalid_argument for a reference that a matcher without a proposer prepared for one with it.
  MatchResult match(const Reference& reference, const Scan& scan, const MatchHints& hints);

  const MatchOptions& options() const { return options_; }

 private:
  void prepare_into(const Scan& reference, const Twist2& twist, Reference::Data& out);
  PrepareOptions prepare_options(bool reference) const;
  MatchResult match_prepared(const Reference::Data& reference, const Scan& scan, const MatchHints& hints,
                             MatchTimer& timer);
  void search(const Reference::Data& reference, const Scan& scan, const MatchHints& hints, MatchTimer& timer);

  MatchOptions options_;
  std::unique_ptr<RotationProposer> proposer_;
  GlobalSearch search_;
  PrepareWorkspace work_;
  Reference::Data own_;
  PreparedScan scan_;
  std::unique_ptr<RotationProposer::Cue> scan_cue_;
  std::vector<RotationHypothesis> proposed_;
  SearchOutcome outcome_;
};

}  // namespace phasescan
