/// A sensor plugged in, to poses as they come: ports, threads, reconnecting. This part of the library starts threads
/// and looks at the clock; what lies below it does neither.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "phasescan/live/decoder.hpp"
#include "phasescan/localize/localizer.hpp"
#include "phasescan/map/trinary_map.hpp"
#include "phasescan/scan/scan.hpp"
#include "phasescan/slam/slam.hpp"

namespace phasescan::live {

/// A scan on its way, and when it was whole: by the steady clock [ns].
struct LiveScan {
  RangeMeasurement measurement;
  std::int64_t arrived_ns = 0;
  bool restarts = false;  ///< a log begins again: what came before is void
  double lost = 0.0;      ///< share of its beams that were lost on the line, 0..1
};

/// Where scans come from. Runs in a thread of its own.
class LiveSource {
 public:
  virtual ~LiveSource() = default;
  /// Hands out scans until `stop` says so or there are no more. `tell` takes what people should know, a line each.
  /// @throws SystemError, InputError where it cannot begin
  virtual void run(const std::function<bool()>& stop, const std::function<void(LiveScan)>& hand,
                   const std::function<void(const std::string&)>& tell) = 0;
  /// Whether it can wait until a scan is used, as a log can and a sensor cannot: then no scan is left out.
  virtual bool can_wait() const { return false; }
};

/// A sensor at a port: "auto", a device, "tcp:HOST:PORT", "udp:HOST:PORT", or a file that `raw` wrote.
/// Unplugged, it waits and goes on. @param sensor  empty: found by asking and listening
/// @param raw  file for the bytes as they come; empty: none
/// @throws SystemError with one line that says what to do, std::invalid_argument for a name that is none
std::unique_ptr<LiveSource> open_sensor(const std::string& port, const std::string& sensor, const std::string& raw);

/// A loop that entered the graph, or left it again.
struct LiveLoop {
  std::int32_t from = 0, to = 0;  ///< indices of keyframes
  bool accepted = true;
};

/// What one scan brought, and how long that took.
struct LiveUpdate {
  ScanUpdate update;
  /// 0..1. SLAM: share of the hits that the map explains, 0 where the scan was not matched. In a known map: the
  /// calibrated probability that the pose is within 0.1 m and 3 deg
  double confidence = 0.0;
  double latency_ms = 0.0;                              ///< from the last byte of the scan to this
  std::uint64_t dropped = 0;                            ///< scans so far that came faster than they were used
  std::shared_ptr<const RangeMeasurement> measurement;  ///< the scan itself; never null
  std::shared_ptr<const MapSnapshot> map;               ///< as the last result left it; never null
  std::vector<LiveLoop> loops;                          ///< that entered or left with this scan
  std::vector<std::string> warnings;                    ///< what was odd about this scan, for people
  bool restarted = false;                               ///< all began anew with this scan
  /// False: of a drive that nothing ties to the map yet; its pose is what a person told, or a guess
  bool on_map = true;
  std::optional<LocalizationUpdate> located;  ///< in a map that is known: what was found there; empty: the map grows

  /// Whether the pose is one to go by. In a known map an ambiguous one may be of another place altogether.
  bool has_pose() const { return located ? located->has_pose() : is_tracked(update.status); }
};

/// What makes poses of scans: SLAM, or a search on a map that is known. One thread uses it.
class LiveEngine {
 public:
  virtual ~LiveEngine() = default;
  /// Fills `update` to `warnings` of the answer but for `latency_ms` and `dropped`.
  virtual LiveUpdate add(std::shared_ptr<const RangeMeasurement> measurement) = 0;
  /// Where the robot stands, as a person says. Gives the line that answers him. @throws std::invalid_argument for a
  /// pose that is not finite
  virtual std::string set_pose(const Pose2& T_map_base) = 0;
  /// The robot may be anywhere. Gives the line that answers who asked.
  virtual std::string relocalise() = 0;
  /// All begins anew, as if nothing had come before.
  virtual void restart() = 0;
};

/// Poses that a run of bounded memory keeps of its way: half an hour and more; those of longer ago are thinned.
constexpr std::size_t kPathScans = 16384;

/// @param slam        must outlive the engine, which is its observer
/// @param renew       makes the run that follows a restart
/// @param path_scans  given to Slam::set_path_limit
std::unique_ptr<LiveEngine> slam_engine(Slam& slam, std::function<Slam()> renew, std::size_t path_scans = kPathScans);

/// Finds the robot on a map that is known, with no guess, and follows it there.
/// @param begin  makes the localizer, now and after each restart
/// @param drawn  the map, for those who are shown it
std::unique_ptr<LiveEngine> localize_engine(std::function<Localizer()> begin, TrinaryMap drawn);

/// Who is shown what came to pass. Each has a thread and a bounded queue of its own: what it takes long for is left out
/// from the oldest on, and never holds back tracking.
class LiveSink {
 public:
  virtual ~LiveSink() = default;
  virtual void take(const LiveUpdate& update) = 0;
};

/// Work that must not run beside tracking: done between two scans, by the thread that tracks.
class LiveTasks {
 public:
  LiveTasks();
  ~LiveTasks();
  LiveTasks(const LiveTasks&) = delete;
  LiveTasks& operator=(const LiveTasks&) = delete;
  /// By any thread. False where too many wait, or where the run is over: the task is not done then.
  bool post(std::function<void()> task);

 private:
  friend class LiveRunAccess;
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// What came to pass in all.
struct LiveSummary {
  std::uint64_t scans = 0, dropped = 0;
  double worst_latency_ms = 0.0;
  std::vector<std::uint64_t> not_shown;  ///< of each sink: updates that it was too slow for
};

/// Source, engine and each sink, all in their own threads with bounded queues between them: where one is too slow the
/// oldest scan is left out and counted. Returns when the source ends or `stop` says so, all threads joined and every
/// scan that was in a queue done.
/// @param tasks    null: none; they wait for the first scan
/// @param between  by the thread that tracks, after a scan where no other waits: may read the run, as Slam::checkpoint
///                 does. What it takes longer than to the next scan makes that one late. Empty: nothing
/// @throws what the source, the engine, a task or a sink throws
LiveSummary run_live(LiveSource& source, LiveEngine& engine, const std::vector<LiveSink*>& sinks, LiveTasks* tasks,
                     const std::function<bool()>& stop, const std::function<void(const std::string&)>& tell,
                     const std::function<void()>& between = {});

/// The same for SLAM with one sink, which nobody asks for anything while it goes on.
LiveSummary run_live(LiveSource& source, Slam& slam, const std::function<bool()>& stop,
                     const std::function<void(const LiveUpdate&)>& sink,
                     const std::function<void(const std::string&)>& tell);

}  // namespace phasescan::live
