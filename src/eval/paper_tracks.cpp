#include "eval/paper_tracks.hpp"

#include <algorithm>
#include <cmath>

#include "methods/any_matcher.hpp"
#include "sim/drive.hpp"
#include "sim/pairs_spec.hpp"

namespace phasescan {

RecordedDrive drive_tour(std::uint64_t seed, double speed_mps, double turn_rate_dps, double length_m) {
  const sim::World world = sim::make_world(sim::WorldKind::kFlat, seed);
  sim::PathOptions way;
  way.speed_mps = speed_mps;
  way.turn_rate_dps = turn_rate_dps;
  way.jitter_m = 0.003;
  way.jitter_deg = 0.5;
  const sim::LidarOptions lidar = sim::read_lidar("rplidar-a1");
  sim::Drive drive(world, lidar, sim::Path(world, way, seed), {}, seed);
  RecordedDrive out{speed_mps, turn_rate_dps, {}, {}, {}};
  Pose2 T_first_world;
  double travelled = 0.0;
  while (travelled < length_m) {
    std::optional<sim::DriveScan> scan = drive.next();
    if (!scan) break;
    if (out.scans.empty()) T_first_world = scan->T_world_laser.inverse();
    out.seconds.push_back(static_cast<double>(out.scans.size()) / lidar.rate_hz);
    out.scans.push_back(std::move(scan->entry.scan));
    out.truth.push_back(T_first_world * scan->T_world_laser);
    travelled += std::abs(scan->twist.vx) / lidar.rate_hz;
  }
  return out;
}

Track chain_matches(const RecordedDrive& drive, const AnyMatchOptions& options, std::size_t stride, bool deskew) {
  AnyMatcher matcher(options);
  Track track;
  Pose2 pose;
  MatchHints hints;
  for (std::size_t i = 0; i < drive.scans.size(); i += stride) {
    if (i > 0) {
      const Pose2 T_before_now = matcher.match(drive.scans[i - stride], drive.scans[i], hints).T_ref_scan;
      pose = pose * T_before_now;
      if (deskew) {
        const Twist2 step = log_pose(T_before_now);
        const double seconds = drive.seconds[i] - drive.seconds[i - stride];
        hints.reference_twist = hints.scan_twist = {step.vx / seconds, step.vy / seconds, step.omega / seconds};
      }
    }
    track.seconds.push_back(drive.seconds[i]);
    track.estimate.push_back(pose);
    track.truth.push_back(drive.truth[i]);
  }
  return track;
}

std::vector<double> Track::position_errors() const {
  std::vector<double> out(estimate.size());
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = translation_distance(estimate[i], truth[i]);
  return out;
}

double Track::max_error() const {
  const std::vector<double> errors = position_errors();
  return errors.empty() ? 0.0 : *std::max_element(errors.begin(), errors.end());
}

double Track::roughness() const {
  double sum = 0.0;
  std::size_t n = 0;
  const auto error = [&](std::size_t i) { return (estimate[i].translation() - truth[i].translation()).eval(); };
  for (std::size_t i = 1; i + 1 < estimate.size(); ++i, ++n)
    sum += (error(i + 1) - 2.0 * error(i) + error(i - 1)).squaredNorm();
  return n > 0 ? std::sqrt(sum / static_cast<double>(n)) : 0.0;
}

}  // namespace phasescan
