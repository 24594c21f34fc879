/// The system of [Jiang19], whole: scan images, missing data, FFT and ICP, and the four methods it is compared with.
/// docs/fft_icp.md says how it works. The default matcher (phasescan/match/scan_matcher.hpp) is another one.
#pragma once

#include <memory>

#include "phasescan/fft_icp/options.hpp"
#include "phasescan/match/result.hpp"
#include "phasescan/scan/scan.hpp"

namespace phasescan {

/// A reference scan with all that a method prepares of it (points, image, spectrum, search structures). Copies share
/// it; any number of matchers may read one at the same time.
class FftIcpReference {
 public:
  struct Data;
  explicit FftIcpReference(std::shared_ptr<const Data> data) : data_(std::move(data)) {}
  const Data& data() const { return *data_; }

 private:
  std::shared_ptr<const Data> data_;
};

/// Matches scans with one of the five methods. Owns its buffers: one object per thread; nothing is shared but FFT
/// plans. `usable` is the method's own convergence test; `confidence` stays empty.
class FftIcpMatcher {
 public:
  /// @throws std::invalid_argument naming the option that is out of bounds.
  explicit FftIcpMatcher(const FftIcpOptions& options = {});
  ~FftIcpMatcher();
  FftIcpMatcher(FftIcpMatcher&&) noexcept;
  FftIcpMatcher& operator=(FftIcpMatcher&&) noexcept;

  /// Finds T_ref_scan. Never throws for what the world offers: a hopeless scan is a status in the result. The guess is
  /// where icp and ndt start (else from no motion); fft takes its rotation alone; fft-icp1 and fft-icp2 only refine it.
  MatchResult match(const Scan& reference, const Scan& scan, const MatchHints& hints = {});

  /// Prepares a reference once for many matches.
  FftIcpReference prepare(const Scan& reference, const Twist2& twist = {});
  /// The same answer as with the raw reference scan. @throws std::invalid_argument for a reference of another method's
  /// matcher.
  MatchResult match(const FftIcpReference& reference, const Scan& scan, const MatchHints& hints = {});

  const FftIcpOptions& options() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// One match with the given options.
MatchResult match_fft_icp(const Scan& reference, const Scan& scan, const FftIcpOptions& options = {},
                          const MatchHints& hints = {});

}  // namespace phasescan
