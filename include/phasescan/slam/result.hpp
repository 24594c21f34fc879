/// What a scan brings at once, and what a run of SLAM leaves: poses, graph, map, and what was odd.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "phasescan/core/pose2.hpp"
#include "phasescan/core/time.hpp"
#include "phasescan/map/trinary_map.hpp"
#include "phasescan/odometry/odometry.hpp"

namespace phasescan {

/// Number of a measurement, from 0, in the order in which they were added.
using ScanId = std::int64_t;
/// Number of a keyframe, from 0, in the order in which tracking chose them.
using KeyframeId = std::int64_t;

/// Complete when `add` returns: nothing in it waits for the map.
struct ScanUpdate {
  Stamp stamp = 0;
  ScanId scan = 0;
  TrackingStatus status = TrackingStatus::kInitialising;
  bool repeated = false;  ///< the same message as the one before: it has that one's pose and counts for nothing else
  Pose2 T_odom_base;      ///< at the scan's stamp; continuous, drifts
  Eigen::Matrix3d odom_covariance = Eigen::Matrix3d::Zero();  ///< of T_odom_base, since the start [m^2, m rad, rad^2]
  Pose2 T_map_odom;               ///< correction by the map; changes when a result of loops and graph enters
  std::uint64_t map_version = 0;  ///< counts those results
  std::optional<Eigen::Matrix3d> map_covariance;  ///< of T_map_base(); empty before the first result
  Twist2 twist;                                   ///< of the base, 0 where time is unknown
  std::optional<KeyframeId> keyframe;             ///< the newest keyframe, if this scan brought one or made one final
  TrackingDiagnostics diagnostics;

  /// Where the base stands on the map, as far as is known now.
  Pose2 T_map_base() const { return T_map_odom * T_odom_base; }
};

/// What is odd about the input, by kind.
struct InputOddity {
  std::size_t count = 0;
  bool damage = false;  ///< the input is broken there, not only unusual
  ScanId first = 0;     ///< scan at which it was first seen
  std::string what;     ///< what it was there

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("count", self.count);
    v("damage", self.damage);
    v("first", self.first);
    v("what", self.what);
  }
};

/// How many loops there were.
struct LoopCounts {
  std::size_t compared = 0;               ///< pairs of visits that were matched
  std::size_t places = 0;                 ///< found by what they look like, before they were compared
  std::size_t found = 0;                  ///< matches good enough to be a loop
  std::size_t accepted = 0;               ///< and not undone since
  std::size_t undone = 0;                 ///< once accepted, taken out again because the graph contradicts them
  std::size_t rejected_inconsistent = 0;  ///< never found others that agree
  std::size_t rejected_beyond_drift = 0;  ///< asked for more than tracking and earlier loops leave open
  std::size_t rejected_alike = 0;         ///< several places far from each other look the same
  /// Loops of the graph now: at the end all keyframes are compared with their neighbours again, which is in none of the
  /// counts above.
  std::size_t in_graph = 0;

  /// All that were found and are not accepted.
  std::size_t rejected() const { return undone + rejected_inconsistent + rejected_beyond_drift + rejected_alike; }

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("compared", self.compared);
    v("places", self.places);
    v("found", self.found);
    v("accepted", self.accepted);
    v("undone", self.undone);
    v("rejected_inconsistent", self.rejected_inconsistent);
    v("rejected_beyond_drift", self.rejected_beyond_drift);
    v("rejected_alike", self.rejected_alike);
    v("in_graph", self.in_graph);
  }
};

/// A keyframe on the map: a node of the graph.
struct MapKeyframe {
  Pose2 T_map_base;  ///< in the middle of its scan's turn
  ScanId scan = 0;
  std::int32_t piece = 0;  ///< which of the map's pieces: nothing ties one to another
};

/// A tie between two keyframes.
struct MapEdge {
  std::int32_t from = 0, to = 0;  ///< indices of keyframes
  Pose2 T_from_to;
  Eigen::Matrix3d information = Eigen::Matrix3d::Identity();  ///< of (x, y, theta), frame of `to`
  bool loop = false;                                          ///< else a step of odometry
  bool enabled = true;                                        ///< false: a loop that was taken out again
};

/// One measurement in the end.
struct ScanResult {
  Stamp stamp = 0;
  TrackingStatus status = TrackingStatus::kInitialising;
  bool repeated = false;
  bool left_out = false;       ///< it fits neither the scans before nor those after it: its pose comes from theirs
  bool on_map = true;          ///< false: it stands in a piece that nothing ties to the map drawn
  std::int32_t keyframe = -1;  ///< the keyframe before it, -1: none yet
  Pose2 T_map_base;            ///< at its stamp
  Pose2 T_odom_base;           ///< as tracking alone saw it
  /// Of T_map_base as it was known when the scan came; of (x, y, theta). Empty in bounded-memory mode.
  std::optional<Eigen::Matrix3d> covariance;
};

/// Something that speaks against the finished map, or that was done to save it.
struct RunFinding {
  std::string kind;  ///< "bad_scans", "own_body", "aliasing", "wheels", "pieces", "doubled_walls", "contradiction",
                     ///< "gaps", "frames"
  std::size_t count = 0;
  Stamp first_stamp = 0;
  std::string what;  ///< for people
  ScanId scan = -1;  ///< where to look: the scan that stands there; -1: at no single place
};

enum class Verdict {
  kGood,      ///< probability >= 0.97
  kDoubtful,  ///< between
  kFailed,    ///< probability <= 0.2, or fewer than half of the scans with a return stand on one map
};
/// "good", "doubtful", "failed".
const char* to_string(Verdict verdict);

/// What a run says of itself. The reasons are the result's findings.
struct RunVerdict {
  Verdict verdict = Verdict::kFailed;
  /// That the trajectory's absolute error (root mean square) is within 0.2 m or 1 % of the way: calibrated on simulated
  /// runs, clean and dirty.
  double probability = 0.0;
  std::map<std::string, double> evidence;  ///< numbers that it rests on, by name
};

/// The finished run: all that outputs need.
struct SlamResult {
  std::vector<ScanResult> scans;  ///< one per measurement, in order
  std::vector<MapKeyframe> keyframes;
  std::vector<MapEdge> edges;
  std::vector<char> drawn;  ///< of each keyframe: whether the map is drawn from it
  std::int32_t pieces = 0;
  TrinaryMap map;  ///< sure glass is occupied in it (glass.block)
  std::vector<GlassPane> glass;
  LoopCounts loops;
  WheelCounts wheels;
  std::map<std::string, InputOddity> oddities;
  std::vector<RunFinding> findings;  ///< reasons of the verdict, strongest first
  RunVerdict verdict;
  /// Whether motion was taken out of the scans in the end: not where turns showed that the stated times are wrong.
  bool deskewed = true;
  /// Of each drive (Slam::begin_session) its first scan, and which of the parts it is in (0 where there are none).
  struct Session {
    ScanId first_scan = 0;
    std::int32_t part = 0;
  };
  std::vector<Session> sessions;
  /// Where nothing ties some drives to others: what hangs together, most keyframes first, each a result by itself; else
  /// empty. Its numbers of scans and keyframes are its own.
  std::vector<SlamResult> parts;

  std::size_t scans_left_out() const;              ///< left out as bad, or not on the map
  std::size_t scans_off_the_map() const;           ///< in pieces that nothing ties to the map drawn
  std::vector<Pose2> trajectory() const;           ///< T_map_base of each scan
  std::vector<Pose2> odometry_trajectory() const;  ///< T_odom_base of each scan
};

}  // namespace phasescan
