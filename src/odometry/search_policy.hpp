/// How poses are looked for: one set of rules where scans follow each other closely, one where they stand far apart.
#pragma once

#include "odometry/map_points.hpp"
#include "odometry/motion_variability.hpp"
#include "odometry/scan_clock.hpp"
#include "phasescan/odometry/options.hpp"

namespace phasescan {

/// The rules of one scan.
struct SearchPolicy {
  /// How walls are followed. Scans that stand far apart meet as two scans do, and not as a scan meets the map of those
  /// just before it.
  WallLines lines = kTrackingLines;
  /// Objects that stand free are left out until they are known to be static. Where scans stand far apart nothing is
  /// seen often enough to show that.
  bool filter_free_standing = true;
  /// A laser heard for the first time is placed by the motion alone.
  bool place_new_laser_by_motion = true;
  /// What a certain match against the last scan says counts as a prior of the match against the map.
  bool fuse_last_scan = true;
  /// The direction that a match leaves open is looked along; it looks no farther than scans that follow each other
  /// closely can be apart.
  bool resolve_degenerate = true;
  /// The match against the last scan is tried as a start every time, else only where the scan is badly explained.
  bool always_try_last_scan = false;
  /// A match against the last scan that is not usable is tried as a start as well, if it explains enough.
  bool try_doubtful_last_scan = false;
  /// By so much of its score the pose from a usable match against the last scan must be better to be taken instead; the
  /// other is for one in doubt.
  double last_scan_gain = 0.04, doubtful_gain = 0.0;
  /// How far from what is expected a match against the last scan may lie if it is in doubt [rad], [m]. One beyond half
  /// of that counts as in doubt where scans were lost: it is no prior, and must explain the scan clearly better.
  double most_doubtful_turn = 1.2, most_doubtful_m = 1e9;
  /// Scans are missing before this one, or may be: a match against the last scan that lies far from what is expected is
  /// no prior; a pose that explains the scan by `alone_share` of the usual score needs no match that is in doubt.
  bool scans_missing = false;
  double alone_share = 0.75;
  /// A pose that no match against the last scan led to must explain that share as well, or tracking begins anew.
  bool must_explain = false;
  /// What the motion per scan may change by beside what the model has [m], [rad].
  double change_m = 0.0, change_rad = 0.0;
  /// Scans in a row without a match until a new local map is begun.
  int lost_after_scans = 8;
};

/// Dense or sparse rules, by how much the motion varies from scan to scan.
/// @param lost_s  scans are missing before this one, and so much time has passed [s]; 0 = none is. In a dense log the
///                match against the last scan, which needs no guess, then counts as in a sparse one
/// @param timing  unsteady: scans may be missing at any time; the match against the last scan is asked for where the
///                time since then is long
SearchPolicy search_policy(const MotionVariability& variability, const OdometryOptions& options,
                           const ScanTiming& timing = {});

}  // namespace phasescan
