#include "odometry/frame.hpp"

#include <algorithm>
#include <cmath>

#include "core/motion.hpp"

namespace phasescan {
namespace {

// A free-standing object this near [m] to a wall that faces as it does (cosine of the normals) is a piece of the wall,
// seen through a door.
constexpr float kPartOfWallM = 0.06F, kSameWay = 0.75F;
constexpr double kMostMoving = 0.3;  // share of the hits that may be left out of a match of two scans

}  // namespace

double middle_of_turn_s(const Scan& scan, double duration_s) {
  return scan.time_increment < 0.0 ? -0.5 * duration_s : 0.5 * duration_s;
}

Frame prepare_frame(const RangeMeasurement& measurement, const Twist2& twist, double duration_s,
                    const SearchPolicy& policy, const OdometryOptions& options, FrameWorkspace& work) {
  const Twist2 used = options.deskew && duration_s > 0.0 ? twist : Twist2{};
  const Pose2& T_base_laser = measurement.T_base_laser;
  find_surface(measurement.scan, twist_of_frame(T_base_laser, used), work.surface_work, work.surface, policy.lines);
  const Pose2 T_mid_laser = exp_twist(used, middle_of_turn_s(measurement.scan, duration_s)).inverse() * T_base_laser;
  const auto points = std::make_shared<MapPoints>();
  Frame frame;
  to_map_points(work.surface, T_mid_laser, options.map_range_m, *points, &frame.beams);
  if (!policy.filter_free_standing)
    std::fill(points->free_standing.begin(), points->free_standing.end(), std::uint8_t{0});
  frame.all_points = points;
  frame.points = points;
  return frame;
}

void select_static_points(const LocalMap& map, const Pose2& T_map_base, FrameWorkspace& work, Frame& frame) {
  const MapPoints& all = *frame.all_points;
  const auto c = static_cast<float>(std::cos(T_map_base.theta)), s = static_cast<float>(std::sin(T_map_base.theta));
  const auto tx = static_cast<float>(T_map_base.x), ty = static_cast<float>(T_map_base.y);
  const auto on_map = [&](std::size_t i) {
    if (map.empty()) return false;
    const float px = c * all.x[i] - s * all.y[i] + tx, py = s * all.x[i] + c * all.y[i] + ty;
    if (map.free_standing_at(px, py)) return true;
    const float nx = c * all.nx[i] - s * all.ny[i], ny = s * all.nx[i] + c * all.ny[i];
    const Surfel* wall = all.lone(i) ? map.find_lone(px, py) : map.find(px, py, nx, ny, kSameWay);
    return wall && std::hypot(px - wall->x, py - wall->y) < kPartOfWallM;
  };
  work.chosen.clear();
  frame.left_out.clear();
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (!all.free_standing[i] || on_map(i)) {
      work.chosen.push_back(i);
    } else {
      frame.left_out.push_back(frame.beams[i]);
    }
  }
  if (frame.left_out.empty()) {
    frame.points = frame.all_points;
    return;
  }
  const auto points = std::make_shared<MapPoints>();
  points->reserve(work.chosen.size());
  for (const std::size_t i : work.chosen) points->append(all, i);
  frame.points = points;
}

RangeMeasurement without_moving_objects(const RangeMeasurement& measurement, const Frame& frame) {
  RangeMeasurement left = measurement;
  if (static_cast<double>(frame.left_out.size()) > kMostMoving * static_cast<double>(frame.all_points->size()))
    return left;
  for (const int beam : frame.left_out) left.scan.miss(static_cast<std::size_t>(beam), BeamState::kInvalid);
  return left;
}

}  // namespace phasescan
