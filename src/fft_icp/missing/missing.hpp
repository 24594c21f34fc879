/// Missing-data features: wide runs of beams without a return ([Jiang19] Sec. 2.3).
#pragma once

#include <vector>

#include "phasescan/fft_icp/options.hpp"
#include "phasescan/scan/scan.hpp"

namespace phasescan {

/// A run of missing beams: beta and phi of the paper are centre() and width.
struct MissingRun {
  double start = 0.0;  ///< [rad] in (-pi, pi], counter-clockwise end first
  double width = 0.0;  ///< [rad] in (0, 2 pi]
  double centre() const;
};

/// All wide runs of a scan.
struct MissingFeatures {
  std::vector<MissingRun> runs;  ///< counter-clockwise
  double size = 0.0;             ///< |f|: sum of the widths [rad]
  bool full_turn = false;        ///< the beams cover the whole circle; else nothing is known outside the field of view
};

/// Finds runs in scans of any beam layout. One object per thread; allocates nothing once its buffers have their size.
class MissingFinder {
 public:
  /// Every beam stands for the angles halfway to its neighbours. Runs continue across the +-180 degree seam of a full
  /// turn; the space outside a smaller field of view belongs to no run. Beams beyond the first full turn are ignored.
  ///
  /// @param dmax_m  a return farther than this is missing; 0 = never
  /// @cost O(n), O(n log n) for beams with angles of their own
  void find(const Scan& scan, double dmax_m, double min_width_rad, MissingFeatures& out);

 private:
  struct Cell {
    double start, end;  ///< counter-clockwise
    bool missing;
  };
  void lay_out(const Scan& scan, double dmax_m);

  std::vector<Cell> cells_;
  std::vector<std::size_t> order_;
  std::vector<double> angles_;
  bool full_turn_ = false;
};

}  // namespace phasescan
