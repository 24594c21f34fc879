/// What stands behind ScanMatcher: one engine per family of methods.
#pragma once

#include <memory>

#include "phasescan/match/scan_matcher.hpp"

namespace phasescan {

/// Base of what an engine prepares of a reference scan. An engine derives its own.
struct Reference::Data {
  explicit Data(MatchMethod m) : method(m) {}
  virtual ~Data() = default;
  MatchMethod method;  ///< whose it is: an engine only reads references of its own method
};

/// A method at work: owns its buffers, used by one thread. Callers (ScanMatcher) have checked options, hints and that a
/// prepared reference is of the engine's own method; an engine never throws for what the world offers. Engines fill
/// every field of the result but `ms.total`, which ScanMatcher measures.
class MatchEngine {
 public:
  virtual ~MatchEngine() = default;
  virtual MatchResult match(const Scan& reference, const Scan& scan, const MatchHints& hints) = 0;
  virtual std::shared_ptr<const Reference::Data> prepare(const Scan& reference, const Twist2& twist) = 0;
  virtual MatchResult match(const Reference::Data& reference, const Scan& scan, const MatchHints& hints) = 0;
};

}  // namespace phasescan
