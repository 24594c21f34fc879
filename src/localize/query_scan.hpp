/// A scan made ready to be looked for in a map.
#pragma once

#include <vector>

#include "localize/view_table.hpp"
#include "odometry/map_points.hpp"
#include "phasescan/scan/scan.hpp"
#include "scan/surface.hpp"

namespace phasescan {

/// Hits that a pose is judged by: where they are and where their rays begin, frame of the base.
struct JudgedBeams {
  std::vector<float> x, y;      ///< of the hit [m]
  std::vector<float> dx, dy;    ///< unit vector of the ray
  std::vector<float> range;     ///< [m]
  std::vector<float> variance;  ///< of the hit in its worst direction, by the sensor's noise [m^2]
  float origin_x = 0, origin_y = 0;
  std::size_t size() const { return x.size(); }
};

struct QueryScan {
  MapPoints points;  ///< all hits, frame of the base at the scan's stamp
  MapPoints sparse;  ///< some of those that lie on lines
  JudgedBeams beams;
  ScanView view;  ///< frame of the laser
  Pose2 T_base_laser;

  bool usable() const;
};

struct QueryWorkspace {
  SurfaceWorkspace surface_work;
  SurfacePoints surface;
};

/// @param twist      of the laser during the scan; zero: it stood
/// @param with_view  whether the map is to be searched for it
QueryScan prepare_query(const RangeMeasurement& measurement, const Twist2& twist_base, double most_range_m,
                        bool with_view, QueryWorkspace& work);

}  // namespace phasescan
