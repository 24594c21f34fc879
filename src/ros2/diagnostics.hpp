/// What is wrong with what a node gets, in words: counted by kind, told once a second as diagnostic_msgs.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "phasescan/core/time.hpp"
#include "ros2/messages.hpp"

namespace phasescan::ros2 {

enum class Trouble {
  kScanBeforeTransform,  ///< no transform leads from the laser to the base yet
  kTransformGap,         ///< transforms of the scan's time are missing
  kQueueFull,            ///< scans waited for transforms until newer ones pushed them out
  kClockJumpedBack,      ///< stamps went back: a bag that begins again
  kOutOfOrder,           ///< a scan older than the one before it
  kTwoPublishers,        ///< scans of two sources on one topic
  kBeamsChanged,         ///< another number of beams than before
  kNoBeams,              ///< a scan without a beam
  kNoReturns,            ///< a scan without one range
  kBadScan,              ///< a message that makes no scan
  kTiltedLaser,          ///< the scan plane is not the plane in which the robot drives
  kBadTransform,         ///< a transform that is none
  kOdometryConflict,     ///< somebody else publishes odom -> base too
  kOdometryMissing,      ///< odometry is asked for and not there
  kBadPose,              ///< an initial pose that cannot be used
  kBadMap,               ///< a map that cannot be used
  kNoMap,                ///< no map yet
  kNoScans,              ///< nothing comes on the scan topic
  kLost,                 ///< scans are not matched
  kReconfigured,         ///< parameters changed while scans come
  kSaveFailed,           ///< the state could not be saved or loaded
  kCount,                ///< how many kinds there are
};

/// "clock_jumped_back".
std::string_view name_of(Trouble trouble);

/// Counts troubles and says which there are now.
class Diagnostics {
 public:
  /// @param name  of the node, before ": phasescan"
  explicit Diagnostics(std::string name) : name_(std::move(name)) {}

  /// @param what  for people: what was met, and what helps
  void note(Trouble trouble, Stamp now, std::string what);
  std::uint64_t count(Trouble trouble) const { return entries_[static_cast<std::size_t>(trouble)].count; }
  /// What was met last.
  const std::string& what(Trouble trouble) const { return entries_[static_cast<std::size_t>(trouble)].what; }
  /// Whether it was met within the last `kRecent_s` seconds.
  bool is_recent(Trouble trouble, Stamp now) const;
  /// Clock of the node went back: what was met is as of now.
  void clock_jumped(Stamp now);

  /// The state now: the worst recent trouble gives level and message, each kind met so far a value "kind: count, what".
  /// @param state   what the node does, e.g. "ok"; the message where nothing is wrong
  /// @param values  more to tell, put first
  DiagnosticArray report(Stamp now, std::string_view state, std::vector<KeyValue> values) const;

  static constexpr double kRecent_s = 5.0;

 private:
  struct Entry {
    std::uint64_t count = 0;
    Stamp last = 0;
    std::string what;
  };
  std::string name_;
  std::array<Entry, static_cast<std::size_t>(Trouble::kCount)> entries_;
};

}  // namespace phasescan::ros2
