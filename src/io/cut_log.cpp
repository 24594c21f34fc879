#include "io/cut_log.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "phasescan/core/pose2.hpp"

namespace phasescan {
namespace {

/// From `from` counter-clockwise to `to`, both ends included.
bool lies_in(double angle, const Sector& sector) {
  constexpr double kRounding = 1e-6;
  const double from = sector.from - kRounding, width = wrap_positive(sector.to - sector.from) + 2.0 * kRounding;
  return sector.to - sector.from >= kTwoPi || wrap_positive(angle - from) <= width;
}

class CutLog final : public LogReader {
 public:
  CutLog(std::unique_ptr<LogReader> log, const LogOptions& options) : log_(std::move(log)), options_(options) {
    if (options.from) from_ = stamp_from_seconds(*options.from);
    if (options.to) to_ = stamp_from_seconds(*options.to);
  }

  std::optional<LogEntry> next() override {
    while (auto entry = log_->next()) {
      if (!first_) first_ = entry->scan.stamp;
      const Stamp after = entry->scan.stamp - *first_;
      if (after < from_ || after > to_) continue;
      entry->scan = cut_scan(entry->scan, options_);
      return entry;
    }
    return std::nullopt;
  }
  std::string format() const override { return log_->format(); }
  std::map<std::string, std::string> facts() const override { return log_->facts(); }
  std::vector<LogRemark> remarks() const override { return log_->remarks(); }
  const std::vector<LogDamage>& damages() const override { return log_->damages(); }
  std::size_t damage_count() const override { return log_->damage_count(); }

 private:
  std::unique_ptr<LogReader> log_;
  LogOptions options_;
  Stamp from_ = std::numeric_limits<Stamp>::min(), to_ = std::numeric_limits<Stamp>::max();
  std::optional<Stamp> first_;
};

}  // namespace

bool cuts_anything(const LogOptions& options) {
  return options.range_min > 0.0 || options.range_max > 0.0 || !options.masks.empty() || options.from || options.to;
}

std::unique_ptr<LogReader> cut_log(std::unique_ptr<LogReader> log, const LogOptions& options) {
  return std::make_unique<CutLog>(std::move(log), options);
}

Scan cut_scan(const Scan& scan, const LogOptions& options) {
  Scan out = scan;
  ScanGeometry& limits = out.geometry;
  limits.range_min = std::max(limits.range_min, options.range_min);
  if (options.range_max > 0.0)
    limits.range_max = limits.range_max > 0.0 ? std::min(limits.range_max, options.range_max) : options.range_max;
  for (std::size_t i = 0; i < out.size(); ++i) {
    if (out.is_hit(i) && out.ranges[i] < options.range_min) out.miss(i, BeamState::kTooNear);
    if (out.is_hit(i) && options.range_max > 0.0 && out.ranges[i] > options.range_max)
      out.miss(i, BeamState::kOutOfRange);
    const auto masked = [&](const Sector& sector) { return lies_in(out.angle(i), sector); };
    if (std::any_of(options.masks.begin(), options.masks.end(), masked)) out.miss(i, BeamState::kInvalid);
  }
  return out;
}

}  // namespace phasescan
