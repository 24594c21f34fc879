#include "ros2/diagnostics.hpp"

#include <utility>

namespace phasescan::ros2 {
namespace {

struct Kind {
  std::string_view name;
  DiagnosticStatus::Level level;
};

constexpr std::array<Kind, static_cast<std::size_t>(Trouble::kCount)> kKinds = {{
    {"scan_before_transform", DiagnosticStatus::kWarn},
    {"transform_gap", DiagnosticStatus::kWarn},
    {"queue_full", DiagnosticStatus::kWarn},
    {"clock_jumped_back", DiagnosticStatus::kWarn},
    {"out_of_order", DiagnosticStatus::kWarn},
    {"two_publishers", DiagnosticStatus::kError},
    {"beams_changed", DiagnosticStatus::kOk},
    {"no_beams", DiagnosticStatus::kError},
    {"no_returns", DiagnosticStatus::kWarn},
    {"bad_scan", DiagnosticStatus::kError},
    {"tilted_laser", DiagnosticStatus::kWarn},
    {"bad_transform", DiagnosticStatus::kError},
    {"odometry_conflict", DiagnosticStatus::kError},
    {"odometry_missing", DiagnosticStatus::kWarn},
    {"bad_pose", DiagnosticStatus::kWarn},
    {"bad_map", DiagnosticStatus::kError},
    {"no_map", DiagnosticStatus::kWarn},
    {"no_scans", DiagnosticStatus::kStale},
    {"lost", DiagnosticStatus::kError},
    {"reconfigured", DiagnosticStatus::kOk},
    {"save_failed", DiagnosticStatus::kError},
}};

}  // namespace

std::string_view name_of(Trouble trouble) {
  return kKinds[static_cast<std::size_t>(trouble)].name;
}

void Diagnostics::note(Trouble trouble, Stamp now, std::string what) {
  Entry& entry = entries_[static_cast<std::size_t>(trouble)];
  ++entry.count;
  entry.last = now;
  entry.what = std::move(what);
}

bool Diagnostics::is_recent(Trouble trouble, Stamp now) const {
  const Entry& entry = entries_[static_cast<std::size_t>(trouble)];
  return entry.count > 0 && stamp_to_seconds(now - entry.last) <= kRecent_s;
}

void Diagnostics::clock_jumped(Stamp now) {
  for (Entry& entry : entries_) {
    if (entry.last > now) entry.last = now;
  }
}

DiagnosticArray Diagnostics::report(Stamp now, std::string_view state, std::vector<KeyValue> values) const {
  DiagnosticStatus status;
  status.name = name_ + ": phasescan";
  status.message = state;
  status.values = std::move(values);
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    const Entry& entry = entries_[i];
    if (entry.count == 0) continue;
    status.values.push_back({std::string(kKinds[i].name), std::to_string(entry.count) + ", last: " + entry.what});
    if (!is_recent(static_cast<Trouble>(i), now) || kKinds[i].level <= status.level) continue;
    status.level = kKinds[i].level;
    status.message = std::string(kKinds[i].name) + ": " + entry.what;
  }
  return {{now, ""}, {std::move(status)}};
}

}  // namespace phasescan::ros2
