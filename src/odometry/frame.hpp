/// One scan made ready to be matched: its surface, once, as points in the frame of the base at mid-scan.
#pragma once

#include <memory>
#include <vector>

#include "odometry/local_map.hpp"
#include "odometry/map_points.hpp"
#include "odometry/search_policy.hpp"
#include "phasescan/core/pose2.hpp"
#include "phasescan/odometry/options.hpp"
#include "phasescan/scan/scan.hpp"
#include "scan/surface.hpp"

namespace phasescan {

/// A scan with too few hits that lie on lines is not matched.
inline constexpr std::size_t kLeastLinePoints = 12;

/// Points are shared, so that keyframes cost no copy.
struct Frame {
  std::shared_ptr<const MapPoints> all_points;  ///< in the frame of the base at mid-scan
  std::vector<int> beams;                       ///< of all points
  std::shared_ptr<const MapPoints> points;      ///< those that the pose is found by: see select_static_points
  std::vector<int> left_out;                    ///< beams of the others

  bool has_enough_points() const { return points->with_normal >= kLeastLinePoints; }
};

/// Buffers of prepare_frame, and the surface that it found last.
struct FrameWorkspace {
  SurfaceWorkspace surface_work;
  SurfacePoints surface;
  std::vector<std::size_t> chosen;
};

/// The middle of a scan's turn after its stamp [s]: before it where beams are listed last to first.
double middle_of_turn_s(const Scan& scan, double duration_s);

/// Finds the surface of a scan and takes it into the frame of the base at mid-scan: where an error of the twist matters
/// least. `points` are all of them; work.surface stays.
/// @param twist       of the base during the scan
/// @param duration_s  of the scan's turn, 0 = unknown: it is not deskewed
Frame prepare_frame(const RangeMeasurement& measurement, const Twist2& twist, double duration_s,
                    const SearchPolicy& policy, const OdometryOptions& options, FrameWorkspace& work);

/// Leaves out free-standing objects that may be people: those that the map does not hold where they are expected.
/// @param T_map_base  where the base is expected
void select_static_points(const LocalMap& map, const Pose2& T_map_base, FrameWorkspace& work, Frame& frame);

/// The scan without the beams that were left out, as it is matched against another scan. Where they are much of what
/// there is they are furniture, and stay.
RangeMeasurement without_moving_objects(const RangeMeasurement& measurement, const Frame& frame);

}  // namespace phasescan
