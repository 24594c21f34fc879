/// SLAM: scans in, a trajectory and a map out.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include "phasescan/core/pose2.hpp"
#include "phasescan/core/time.hpp"
#include "map/glass.hpp"
#include "map/occupancy_grid.hpp"
#include "odometry/tracker.hpp"
#include "slam/backend.hpp"
#include "phasescan/slam/options.hpp"
#include "slam/scan_store.hpp"

namespace phasescan {

/// What is kept of every scan: where it stands relative to a keyframe. Small, since there may be many.
struct ScanRecord {
  Stamp stamp = 0;
  std::int32_t keyframe = -1;     ///< -1: before the first keyframe
  float x = 0, y = 0, theta = 0;  ///< T_keyframe_stamp: the base at the scan's first beam
};

/// Tracks, finds loops and keeps the map's poses straight. The tracker never waits for the map but at fixed scan
/// counts, so that the same scans give the same answer with any number of threads.
class Slam {
 public:
  /// @param threads  1: loops and graph are worked on between scans; more: beside the tracker
  /// @throws std::invalid_argument naming the option out of bounds.
  explicit Slam(const SlamOptions& options = {}, int threads = 1);
  ~Slam();

  /// The next laser message.
  TrackerStep add(const RangeMeasurement& measurement);

  /// A message that repeats the one before: it gets that one's pose and counts for nothing else.
  void repeat(const RangeMeasurement& measurement);

  /// Ends the run: last loops, the full graph, and every scan matched once more against the finished map.
  void finish();

  // What follows waits for the batch in work: it is the same with any number of threads.

  /// One pose of the base per scan that was added, in that order. Before finish() as far as is known.
  std::vector<Pose2> trajectory() const;
  /// The pose of one scan as the map has it now; empty while its keyframe waits to be handed to the backend.
  std::optional<Pose2> pose_on_map(std::size_t scan) const;
  /// Keyframes that the map is drawn from: all, or those of the largest piece (slam.largest_piece).
  std::vector<std::size_t> drawn_keyframes() const;
  /// Of each scan: 0 where it stands in no part of the map, since nothing ties its piece to it; else 1.
  std::vector<char> on_map() const;
  /// How many stand in no part of it.
  std::size_t scans_left_out() const;
  /// The map that these keyframes' scans draw from their poses as they stand.
  OccupancyGrid render_map() const;
  /// Glass and black surfaces that the same scans show, none where the robot drove. @param grid  the rendered map
  std::vector<GlassPane> find_glass_panes(const OccupancyGrid& grid) const;
  /// The trajectory as laser odometry alone saw it.
  std::vector<Pose2> odometry_trajectory() const;
  /// CPU time of this thread that the last add() spent on loops and graph [s]; the rest of it was tracking.
  double last_backend_cpu_s() const { return backend_cpu_s_; }
  const std::vector<ScanRecord>& records() const { return records_; }
  const Backend& backend() const;
  const Tracker& tracker() const { return tracker_; }
  /// Scans kept: all, or those of keyframes without polish; none in bounded-memory mode.
  const ScanStore& scans() const { return store_; }

 private:
  struct Worker;
  void take(std::vector<TrackedKeyframe> keyframes);
  void hand_over();
  PlacedScan placed_keyframe(std::size_t i) const;
  std::vector<Pose2> anchored(const std::vector<Pose2>& keyframe_poses) const;

  SlamOptions options_;
  int threads_;
  Tracker tracker_;
  std::unique_ptr<Backend> backend_;
  std::unique_ptr<Worker> worker_;
  ScanStore store_;
  std::vector<ScanRecord> records_;
  std::vector<Pose2> polished_;  // T_map_base at the stamp, when polish has run
  struct KeyframeScan {
    std::int64_t scan = 0;                     // its record
    std::shared_ptr<const StoredScan> stored;  // its scan
    std::shared_ptr<const Scan> own;           // the same in bounded-memory mode
  };
  std::deque<KeyframeScan> keyframe_scans_;  // of keyframes that the tracker has not handed out yet
  std::vector<Keyframe> batch_;
  Pose2 T_odom_keyframe_;
  std::int32_t keyframes_ = 0;
  std::vector<std::int32_t> breaks_;  // keyframes at which a new local map was begun
  double backend_cpu_s_ = 0.0;
};

}  // namespace phasescan
