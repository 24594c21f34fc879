/// Rotation between two scans from their missing-data features ([Jiang19] Sec. 2.3, Eq. 7).
#pragma once

#include <vector>

#include "fft_icp/missing/missing.hpp"

namespace phasescan {

/// The best rotation by Eq. 7.
struct MissingRotation {
  bool accepted = false;  ///< passed the size and error gates
  double theta = 0.0;     ///< [rad], middle of the best plateau
  double error = 1.0;     ///< e(theta), 0..1
  double margin = 0.0;    ///< by how much every rotation more than 15 degrees from the plateau is worse
};

/// Minimises e(alpha) = |f1 - rotate(f2, alpha)| / (|f1| + |f2|), read as the width of the symmetric difference of the
/// angle sets, so that 0 <= e <= 1. One object per thread; allocates nothing once its buffers have their size.
class MissingMatcher {
 public:
  /// The exact minimum on the whole circle: the overlap of two intervals is piecewise linear in alpha and bends where
  /// two ends meet, so e is read at the differences of the runs' ends only. Where the best is a plateau, its middle is
  /// the answer.
  ///
  /// Never accepted where either scan covers less than the full circle: there a run ends at the border of the view
  /// rather than at a thing in the world.
  /// @cost O(m log m), m = 4 runs1 runs2
  MissingRotation match(const MissingFeatures& reference, const MissingFeatures& scan, const MissingOptions& options);

 private:
  struct Bend {
    double alpha;  ///< [0, 2 pi)
    double slope;  ///< change of the slope of the overlap
  };
  std::vector<Bend> bends_;
  std::vector<double> overlap_;  ///< at each bend
};

/// e(alpha) itself. @cost O(runs1 runs2)
double missing_error(const MissingFeatures& reference, const MissingFeatures& scan, double alpha);

}  // namespace phasescan
