/// Everything the global search wants to know of one scan, found once: reference and scan are prepared alike.
#pragma once

#include <vector>

#include "match/score_table.hpp"
#include "refine/nearest_grid.hpp"
#include "refine/point_to_line.hpp"
#include "match/from_normals.hpp"
#include "scan/bearing_table.hpp"
#include "scan/surface.hpp"

namespace phasescan {

/// Values all stages share; lengths that must fit the place follow from `scale_m`.
struct PreparedScan {
  SurfacePoints surface;
  BearingTable bearings;
  NearestGrid nearest;
  ScoreTable table;
  NormalHistogram normals;
  SurfaceBatch sparse;         ///< hits evenly spaced along the surfaces, for the coarse sweep
  SurfaceBatch middle;         ///< the same, more of them, for refinement and evidence
  SurfaceBatch all;            ///< every hit
  double scale_m = 0.0;        ///< size of the place in the eyes of the sensor: sets cells and gates
  double range_max_m = 0.0;    ///< effective reach of the sensor
  double turn_variance = 0.0;  ///< of the revolution as a whole against where it says it points [rad^2]

  SurfaceModel model() const { return {surface, nearest, all}; }
  std::size_t size() const { return surface.size(); }
};

/// What of a scan is prepared.
struct PrepareOptions {
  int sparse_points = 64;
  int middle_points = 128;
  double min_empty_run_rad = 0.0873;
  bool with_table = true;  ///< the coarse table is needed of the reference only
  bool adaptive_scale = true;
  bool noise_weights = true;          ///< off: every hit gets the mean variance
  double revolution_turn_deg = -1.0;  ///< standard deviation of a revolution's turn; below 0: from the beams
  ScoreTableValues values;
};

struct PrepareWorkspace {
  SurfaceWorkspace surface;
  BearingWorkspace bearings;
  std::vector<int> sparse, middle;
  std::vector<float> lengths, turns;
};

/// @cost about 50 us for 360 beams, linear in beams
void prepare_scan(const Scan& scan, const Twist2& twist, const PrepareOptions& options, PrepareWorkspace& work,
                  PreparedScan& out);

}  // namespace phasescan
