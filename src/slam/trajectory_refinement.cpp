#include "slam/trajectory_refinement.hpp"

#include <algorithm>
#include <cmath>

#include "core/motion.hpp"
#include "odometry/registration.hpp"
#include "odometry/scan_clock.hpp"
#include "scan/surface.hpp"
#include "phasescan/slam/slam.hpp"

namespace phasescan {
namespace {

constexpr std::size_t kMaxKeyframes = 24;                  // that make the map of what is around one
constexpr double kLeastPeriods = 0.3, kMostPeriods = 3.0;  // between two scans that tell of the motion during a turn
constexpr double kMostM = 0.15, kMostRad = 0.06;           // a refinement moves a pose less than this

/// A message that was passed over because it is the one before once more.
bool repeats(const ScanRecord& before, const ScanRecord& now) {
  return before.stamp == now.stamp && before.keyframe == now.keyframe && before.x == now.x && before.y == now.y &&
         before.theta == now.theta;
}

}  // namespace

std::vector<Pose2> refine_trajectory(const Backend& backend, const ScanStore& scans, std::span<const Pose2> guess,
                                     std::span<const ScanRecord> records, const OdometryOptions& options) {
  std::vector<Pose2> out(guess.begin(), guess.end());
  LocalMap map;
  SurfaceWorkspace work;
  SurfacePoints surface;
  MapPoints points;
  ScanClock clock;
  int built_for = -1;
  std::size_t before = 0;  // the scan before that was no repetition
  for (std::size_t i = 0; i < records.size(); ++i) {
    const Scan scan = scans.scan(i);
    const ScanTiming timing = clock.add(scan);
    if (records[i].keyframe < 0) continue;
    if (i > 0 && repeats(records[i - 1], records[i])) {
      out[i] = out[i - 1];
      continue;
    }
    if (records[i].keyframe != built_for) {
      built_for = records[i].keyframe;
      backend.build_surroundings(built_for, kMaxKeyframes, map);
    }
    // The motion during this turn is the way to the next scan, or from the one before where beams are listed last to
    // first.
    std::size_t from = i, to = i;
    if (scan.time_increment < 0.0) {
      from = before;
    } else {
      do ++to;
      while (to < records.size() && repeats(records[to - 1], records[to]));
    }
    before = i;
    Twist2 twist;
    if (options.deskew && timing.duration_s > 0.0 && timing.period_s > 0.0 && to < records.size()) {
      const double step_s = stamp_to_seconds(records[to].stamp - records[from].stamp);
      if (step_s > kLeastPeriods * timing.period_s && step_s < kMostPeriods * timing.period_s) {
        const Twist2 t = log_pose(guess[from].inverse() * guess[to]);
        twist = {t.vx / step_s, t.vy / step_s, t.omega / step_s};
      }
    }
    const Pose2& T_base_laser = scans.T_base_laser(i);
    find_surface(scan, twist_of_frame(T_base_laser, twist), work, surface, kTrackingLines);
    to_map_points(surface, T_base_laser, options.map_range_m, points);
    PosePrior prior;
    prior.T_map_base = map.T_world_map().inverse() * guess[i];
    prior.information.diagonal() << 1.0 / (0.03 * 0.03), 1.0 / (0.03 * 0.03), 1.0 / (0.01 * 0.01);
    RegistrationOptions fine;
    fine.gate_start_m = 0.2;
    const Registration found = register_points(map, points, prior.T_map_base, fine, prior);
    const Pose2 moved = prior.T_map_base.inverse() * found.T_map_base;
    if (found.overlap < options.min_overlap || std::hypot(moved.x, moved.y) > kMostM ||
        std::abs(moved.theta) > kMostRad)
      continue;
    out[i] = map.T_world_map() * found.T_map_base;
  }
  return out;
}

}  // namespace phasescan
