/// Missing-data features: wide runs of beams without a return ([Jiang19] Sec. 2.3).
#pragma once

#include <vector>

#include "phasescan/core/options.hpp"
#include "phasescan/scan/scan.hpp"

namespace phasescan {

/// Section `missing`. Gates are set so that the shortcut never costs a match (docs/method.md).
struct MissingOptions {
  double min_width_deg = 8.0;
  bool beyond_dmax = true;
  double min_size_deg = 30.0;
  double max_error = 0.3;
  double min_margin = 0.2;
  double verify_score = 0.3;
  double verify_overlap = 0.8;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("min_width_deg", self.min_width_deg, OptionInfo{"deg", "narrower runs of missing beams are dropped", 0, 360});
    v("beyond_dmax", self.beyond_dmax,
      OptionInfo{"", "a return beyond the image's dmax is missing too, as in the paper"});
    v("min_size_deg", self.min_size_deg, OptionInfo{"deg", "Th1: both scans' runs must add up to this", 0, 360});
    v("max_error", self.max_error, OptionInfo{"", "the rotation is accepted below this error of Eq. 7", 0, 1});
    v("min_margin", self.min_margin,
      OptionInfo{"", "and if every rotation more than 15 degrees away has an error larger by this", 0, 1});
    v("verify_score", self.verify_score,
      OptionInfo{"", "a translation peak below this at that rotation: go on with the spectrum; 0: no check", 0, 1});
    v("verify_overlap", self.verify_overlap,
      OptionInfo{"", "a match with a smaller overlap at that rotation: start again with the spectrum; 0: no check", 0,
                 1});
  }
};

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
