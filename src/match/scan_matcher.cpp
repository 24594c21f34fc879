#include "phasescan/match/scan_matcher.hpp"

#include <algorithm>
#include <stdexcept>

#include "core/parallel.hpp"
#include "match/global_matcher.hpp"

namespace phasescan {

struct ScanMatcher::Impl {
  GlobalMatcher matcher;
};

ScanMatcher::ScanMatcher(const MatchOptions& options) : impl_(new Impl{GlobalMatcher(options)}) {}
ScanMatcher::~ScanMatcher() = default;
ScanMatcher::ScanMatcher(ScanMatcher&&) noexcept = default;
ScanMatcher& ScanMatcher::operator=(ScanMatcher&&) noexcept = default;

MatchResult ScanMatcher::match(const Scan& reference, const Scan& scan, const MatchHints& hints) {
  return impl_->matcher.match(reference, scan, hints);
}

Reference ScanMatcher::prepare(const Scan& reference, const Twist2& twist) {
  return impl_->matcher.prepare(reference, twist);
}

MatchResult ScanMatcher::match(const Reference& reference, const Scan& scan, const MatchHints& hints) {
  return impl_->matcher.match(reference, scan, hints);
}

const MatchOptions& ScanMatcher::options() const {
  return impl_->matcher.options();
}

MatchResult match_scans(const Scan& reference, const Scan& scan, const MatchOptions& options, const MatchHints& hints) {
  return ScanMatcher(options).match(reference, scan, hints);
}

std::vector<MatchResult> match_many(const Scan& reference, std::span<const Scan> scans, const MatchOptions& options,
                                    int threads) {
  if (threads < 1) throw std::invalid_argument("threads: must be 1 or more");
  std::vector<ScanMatcher> matchers;
  const std::size_t workers = std::min(static_cast<std::size_t>(threads), std::max<std::size_t>(scans.size(), 1));
  for (std::size_t k = 0; k < workers; ++k) matchers.emplace_back(options);
  const Reference prepared = matchers.front().prepare(reference);
  std::vector<MatchResult> results(scans.size());
  // Each scan is matched alone, so which thread takes it cannot change its answer.
  parallel_for(scans.size(), workers,
               [&](std::size_t i, std::size_t worker) { results[i] = matchers[worker].match(prepared, scans[i]); });
  return results;
}

}  // namespace phasescan
