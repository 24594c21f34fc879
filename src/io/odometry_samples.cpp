#include "io/odometry_samples.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

namespace phasescan {
namespace {

constexpr std::size_t kMostSamples = 4096;
constexpr Stamp kSetBack = 1'000'000'000;
constexpr std::size_t kLeastScans = 5;  // without odometry, to say anything of the clock

Pose2 interpolate(const Pose2& a, const Pose2& b, double share) {
  return {a.x + share * (b.x - a.x), a.y + share * (b.y - a.y),
          wrap_angle(a.theta + share * wrap_angle(b.theta - a.theta))};
}

}  // namespace

void OdometrySamples::add(const Sample& sample) {
  if (!samples_.empty() && sample.stamp <= samples_.back().stamp) {
    if (samples_.back().stamp - sample.stamp < kSetBack) return;
    samples_.clear();  // what came before belongs to another time
  }
  samples_.push_back(sample);
  if (samples_.size() > kMostSamples) samples_.pop_front();
}

std::optional<Pose2> OdometrySamples::between(Stamp stamp) const {
  const auto after = std::lower_bound(samples_.begin(), samples_.end(), stamp,
                                      [](const Sample& sample, Stamp t) { return sample.stamp < t; });
  if (after == samples_.end()) return std::nullopt;
  if (after->stamp == stamp) return after->pose;
  if (after == samples_.begin()) return std::nullopt;
  const Sample& before = *std::prev(after);
  if (after->stamp - before.stamp > kLongestGap) return std::nullopt;
  const double share = static_cast<double>(stamp - before.stamp) / static_cast<double>(after->stamp - before.stamp);
  return interpolate(before.pose, after->pose, share);
}

std::optional<Pose2> OdometrySamples::near(Stamp stamp) const {
  if (const auto pose = between(stamp)) return pose;
  const Sample* nearest = nullptr;
  Stamp least = kNearest;
  const auto after = std::lower_bound(samples_.begin(), samples_.end(), stamp,
                                      [](const Sample& sample, Stamp t) { return sample.stamp < t; });
  if (after != samples_.begin() && stamp - std::prev(after)->stamp <= least) {
    nearest = &*std::prev(after);
    least = stamp - nearest->stamp - 1;  // of two as near the earlier one counts
  }
  if (after != samples_.end() && after->stamp - stamp <= least) nearest = &*after;
  return nearest == nullptr ? std::nullopt : std::optional(nearest->pose);
}

void ClockCheck::add(Stamp scan, bool has_odometry, const OdometrySamples& samples) {
  if (has_odometry) {
    ++with_;
  } else if (!samples.empty()) {
    ++without_;
    ahead_ = scan - samples.last_stamp();
  }
}

void ClockCheck::add_remarks(std::vector<LogRemark>& remarks) const {
  if (with_ > 0 || without_ < kLeastScans) return;
  const double away_s = stamp_to_seconds(ahead_);
  if (std::abs(away_s) <= stamp_to_seconds(OdometrySamples::kLongestGap)) return;  // only too rare
  remarks.push_back({"odometry of another clock",
                     fmt::format("the times of the odometry lie {:.1f} s {} those of the scans: none of it is used",
                                 std::abs(away_s), away_s > 0.0 ? "before" : "after")});
}

bool OdometryQueue::may_leave(const LogEntry& entry) const {
  if (entry.odometry || samples_.empty() || waiting_.size() >= kMostWaiting) return true;
  // What comes after the newest entry comes too late.
  return samples_.last_stamp() >= entry.scan.stamp ||
         waiting_.back().scan.stamp - samples_.last_stamp() > OdometrySamples::kLongestGap;
}

std::optional<LogEntry> OdometryQueue::take(bool ended) {
  if (waiting_.empty() || (!ended && !may_leave(waiting_.front()))) return std::nullopt;
  LogEntry entry = std::move(waiting_.front());
  waiting_.pop_front();
  const Stamp stamp = entry.scan.stamp;
  if (!entry.odometry) entry.odometry = outside_ == Outside::kNearest ? samples_.near(stamp) : samples_.between(stamp);
  clock_.add(stamp, entry.odometry.has_value(), samples_);
  return entry;
}

}  // namespace phasescan
