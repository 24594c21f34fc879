#include "io/odometry_source.hpp"

#include <cmath>

namespace phasescan {
namespace {

constexpr double kSameM = 1e-6, kSameRad = 1e-6;
/// Where scans of other kinds stand between those that decide.
constexpr std::size_t kMostWaiting = 10 * OdometryJudge::kFirstScans;

bool left_by_mapping(const LogReader& log) {
  for (const auto& [name, value] : log.facts()) {
    if (name.find("NEFF") != std::string::npos || name.find("SM_UPDATE") != std::string::npos) return true;
  }
  return false;
}

}  // namespace

void OdometryJudge::add(const LogEntry& entry, const LogReader& log) {
  ++scans_;
  with_odometry_ += entry.odometry.has_value();
  if (!entry.odometry || !entry.corrected) return;
  ++with_both_;
  const Pose2 off = (*entry.odometry * entry.T_base_laser).inverse() * *entry.corrected;
  if (std::hypot(off.x, off.y) < kSameM && std::abs(off.theta) < kSameRad) {
    ++same_;
    if (is_open() && with_both_ >= kFirstScans) decide(log);
    return;
  }
  if (first_different_ == 0) first_different_ = scans_;
  if (is_open()) usable_ = true;
}

void OdometryJudge::decide(const LogReader& log) {
  by_same_poses_ = true;
  usable_ = !left_by_mapping(log);
}

void OdometryJudge::finish(const LogReader& log) {
  if (is_open() && with_both_ > 0) decide(log);
  if (is_open()) usable_ = with_odometry_ > 0;
  marks_late_ = by_same_poses_ && *usable_ && first_different_ == 0 && left_by_mapping(log);
}

OdometrySource OdometryJudge::source() const {
  if (scans_ > 0 && with_odometry_ == 0) return {false, "the log holds no odometry"};
  if (!by_same_poses_) return {true, "the log's odometry is used"};
  const bool usable = usable_.value_or(true);
  std::string text = "odometry and corrected pose are the same in every scan";
  if (first_different_ > 0) {
    text = "odometry and corrected pose are the same up to scan " + std::to_string(first_different_ - 1) +
           " (which decided)";
  }
  text += usable ? ", with no mark of a mapping program: taken as odometry"
                 : " and a mapping program has left its marks: counted as no odometry";
  if (marks_late_) text += " (marks came later, when that was decided)";
  return {usable, text};
}

OdometryJudge JudgedLog::judge() const {
  OdometryJudge judge = judge_;
  if (judge.with_both_ == 0) judge.usable_.reset();
  return judge;
}

std::optional<LogEntry> JudgedLog::next() {
  if (!interpolates_) return next_judged();
  for (bool ended = false;;) {
    if (auto entry = between_.take(ended)) return entry;
    if (ended) return std::nullopt;
    std::optional<LogEntry> entry = next_judged();
    ended = !entry.has_value();
    if (ended) continue;
    if (entry->odometry) between_.add_sample({entry->scan.stamp, *entry->odometry});
    between_.add(std::move(*entry));
  }
}

std::optional<LogEntry> JudgedLog::next_judged() {
  while (!ended_ && (waiting_.empty() || judge_.is_open())) {
    std::optional<LogEntry> entry = first_ ? std::exchange(first_, std::nullopt) : log_.next();
    if (!entry) {
      ended_ = true;
      judge_.finish(log_);
      break;
    }
    judge_.add(*entry, log_);
    // Without a corrected pose it is what it says, and it waits only for those before it.
    const bool plain = !entry->odometry || !entry->corrected;
    if (plain && judge_.is_open() && waiting_.empty()) return entry;
    waiting_.push_back(std::move(*entry));
    if (waiting_.size() >= kMostWaiting) break;
  }
  if (waiting_.empty()) return std::nullopt;
  std::optional<LogEntry> entry = std::move(waiting_.front());
  waiting_.pop_front();
  if (!judge_.source().usable) entry->odometry.reset();
  return entry;
}

}  // namespace phasescan
