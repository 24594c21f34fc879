/// All six methods behind one door, for what lets the user choose: `match`, `bench`, `paper`.
#pragma once

#include <memory>

#include "methods/any_options.hpp"
#include "phasescan/match/result.hpp"
#include "phasescan/scan/scan.hpp"

namespace phasescan {

/// A reference scan prepared by an AnyMatcher.
class AnyReference {
 public:
  struct Data;
  explicit AnyReference(std::shared_ptr<const Data> data) : data_(std::move(data)) {}
  const Data& data() const { return *data_; }

 private:
  std::shared_ptr<const Data> data_;
};

/// A matcher of the method that the options name. One object per thread.
class AnyMatcher {
 public:
  /// @throws std::invalid_argument naming the option that is out of bounds.
  explicit AnyMatcher(const AnyMatchOptions& options = {});
  ~AnyMatcher();
  AnyMatcher(AnyMatcher&&) noexcept;
  AnyMatcher& operator=(AnyMatcher&&) noexcept;

  /// As ScanMatcher's and FftIcpMatcher's.
  MatchResult match(const Scan& reference, const Scan& scan, const MatchHints& hints = {});
  AnyReference prepare(const Scan& reference, const Twist2& twist = {});
  /// @throws std::invalid_argument for a reference of another method's matcher.
  MatchResult match(const AnyReference& reference, const Scan& scan, const MatchHints& hints = {});

  const AnyMatchOptions& options() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// One match with the given options.
MatchResult match_any(const Scan& reference, const Scan& scan, const AnyMatchOptions& options = {},
                      const MatchHints& hints = {});

}  // namespace phasescan
