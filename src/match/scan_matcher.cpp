#include "phasescan/match/scan_matcher.hpp"

#include <algorithm>
#include <atomic>
#include <exception>
#include <stdexcept>
#include <string>
#include <thread>

#include "match/engine.hpp"
#include "match/mh_engine.hpp"
#include "match/paper_engine.hpp"
#include "match/stage_clock.hpp"

namespace phasescan {
namespace {

std::unique_ptr<MatchEngine> make_engine(const MatchOptions& options) {
  options.validate();
  switch (options.match.method) {
    case MatchMethod::kIcp:
    case MatchMethod::kNdt:
    case MatchMethod::kFft:
    case MatchMethod::kFftIcp1:
    case MatchMethod::kFftIcp2:
      return make_paper_engine(options);
    case MatchMethod::kFftMh:
      return make_mh_engine(options);
  }
  throw std::invalid_argument("match.method: not a method");
}

void check_twist(const char* name, const Twist2& twist) {
  if (!std::isfinite(twist.vx) || !std::isfinite(twist.vy) || !std::isfinite(twist.omega)) {
    throw std::invalid_argument(std::string(name) + ": not finite");
  }
}

void check_hints(const MatchHints& hints) {
  if (hints.guess && !hints.guess->is_finite()) throw std::invalid_argument("hints.guess: not finite");
  check_twist("hints.reference_twist", hints.reference_twist);
  check_twist("hints.scan_twist", hints.scan_twist);
}

}  // namespace

struct ScanMatcher::Impl {
  explicit Impl(const MatchOptions& o) : options(o), engine(make_engine(o)) {}

  /// Runs one match under the clock.
  template <class Match>
  MatchResult timed(Match&& match) {
    StageClock clock;
    MatchResult result = match();
    result.ms.total = 0.0;
    clock.add_to(result.ms.total);
    return result;
  }

  MatchOptions options;
  std::unique_ptr<MatchEngine> engine;
};

ScanMatcher::ScanMatcher(const MatchOptions& options) : impl_(std::make_unique<Impl>(options)) {}
ScanMatcher::~ScanMatcher() = default;
ScanMatcher::ScanMatcher(ScanMatcher&&) noexcept = default;
ScanMatcher& ScanMatcher::operator=(ScanMatcher&&) noexcept = default;

MatchResult ScanMatcher::match(const Scan& reference, const Scan& scan, const MatchHints& hints) {
  check_hints(hints);
  return impl_->timed([&] { return impl_->engine->match(reference, scan, hints); });
}

Reference ScanMatcher::prepare(const Scan& reference, const Twist2& twist) {
  check_twist("twist", twist);
  return Reference(impl_->engine->prepare(reference, twist));
}

MatchResult ScanMatcher::match(const Reference& reference, const Scan& scan, const MatchHints& hints) {
  check_hints(hints);
  if (reference.data().method != impl_->options.match.method) {
    throw std::invalid_argument("reference: prepared for " + std::string(to_string(reference.data().method)) +
                                ", this matcher runs " + std::string(to_string(impl_->options.match.method)));
  }
  return impl_->timed([&] { return impl_->engine->match(reference.data(), scan, hints); });
}

const MatchOptions& ScanMatcher::options() const {
  return impl_->options;
}

MatchResult match_scans(const Scan& reference, const Scan& scan, const MatchOptions& options, const MatchHints& hints) {
  return ScanMatcher(options).match(reference, scan, hints);
}

std::vector<MatchResult> match_many(const Scan& reference, std::span<const Scan> scans, const MatchOptions& options,
                                    int threads) {
  if (threads < 1) throw std::invalid_argument("threads: must be 1 or more");
  ScanMatcher first(options);
  const Reference prepared = first.prepare(reference);
  std::vector<MatchResult> results(scans.size());
  std::atomic<std::size_t> next{0};
  // Each scan is matched alone, so which thread takes it cannot change its answer.
  const auto work = [&](ScanMatcher& matcher) {
    for (std::size_t i = next++; i < scans.size(); i = next++) results[i] = matcher.match(prepared, scans[i]);
  };
  const auto extra = std::min(static_cast<std::size_t>(threads), std::max<std::size_t>(scans.size(), 1)) - 1;
  std::vector<std::exception_ptr> failures(extra);
  std::vector<std::thread> pool;
  pool.reserve(extra);
  for (std::size_t t = 0; t < extra; ++t) {
    pool.emplace_back([&, t] {
      try {
        ScanMatcher matcher(options);
        work(matcher);
      } catch (...) {
        failures[t] = std::current_exception();
      }
    });
  }
  std::exception_ptr own;
  try {
    work(first);
  } catch (...) {
    own = std::current_exception();
  }
  for (std::thread& thread : pool) thread.join();
  if (own) std::rethrow_exception(own);
  for (const std::exception_ptr& failure : failures) {
    if (failure) std::rethrow_exception(failure);
  }
  return results;
}

}  // namespace phasescan
