/// The default matcher, `global`: two scans in, a pose with its trustworthiness out. No first guess is needed.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "phasescan/match/result.hpp"
#include "phasescan/match/options.hpp"
#include "phasescan/scan/scan.hpp"

namespace phasescan {

/// A reference scan with all that is prepared of it (surfaces, score table, search structures). Copies share it; any
/// number of matchers may read one at the same time.
class Reference {
 public:
  struct Data;
  explicit Reference(std::shared_ptr<const Data> data) : data_(std::move(data)) {}
  const Data& data() const { return *data_; }

 private:
  std::shared_ptr<const Data> data_;
};

/// Matches scans. Owns its buffers: one object per thread; nothing is shared. @cost docs/results/time.md: 0.1 ms
class ScanMatcher {
 public:
  /// @throws std::invalid_argument naming the option that is out of bounds.
  explicit ScanMatcher(const MatchOptions& options = {});
  ~ScanMatcher();
  ScanMatcher(ScanMatcher&&) noexcept;
  ScanMatcher& operator=(ScanMatcher&&) noexcept;

  /// Finds T_ref_scan. Never throws for what the world offers: a hopeless scan is a status in the result.
  MatchResult match(const Scan& reference, const Scan& scan, const MatchHints& hints = {});

  /// Prepares a reference once for many matches.
  Reference prepare(const Scan& reference, const Twist2& twist = {});
  /// The same answer as with the raw reference scan. @pre the reference was prepared with the same options
  MatchResult match(const Reference& reference, const Scan& scan, const MatchHints& hints = {});

  const MatchOptions& options() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// One match with the given options. @throws std::invalid_argument naming the option that is out of bounds
MatchResult match_scans(const Scan& reference, const Scan& scan, const MatchOptions& options = {},
                        const MatchHints& hints = {});

/// Many scans against one reference, on `threads` threads; the same answers for any number of them. @throws as above
std::vector<MatchResult> match_many(const Scan& reference, std::span<const Scan> scans,
                                    const MatchOptions& options = {}, int threads = 1);

}  // namespace phasescan
