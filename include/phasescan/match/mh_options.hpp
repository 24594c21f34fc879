/// Options of fft-mh, the multi-hypothesis matcher (section `mh`).
#pragma once

#include "phasescan/core/options.hpp"

namespace phasescan {

struct MhOptions {
  double sweep_step_deg = 6.0;
  int sparse_points = 64;
  int middle_points = 128;
  int candidates = 10;
  int finalists = 3;
  double coarse_share = 0.8;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("sweep_step_deg", self.sweep_step_deg, OptionInfo{"deg", "rotations of the coarse sweep are this far apart", 1, 30});
    v("sparse_points", self.sparse_points, OptionInfo{"", "hits of the scan in the coarse sweep", 16, 4096});
    v("middle_points", self.middle_points, OptionInfo{"", "hits of each scan that are weighed as evidence", 16, 4096});
    v("candidates", self.candidates, OptionInfo{"", "poses of the sweep that are refined", 1, 1000});
    v("coarse_share", self.coarse_share, OptionInfo{"", "poses of the sweep below this share of the best sum are dropped", 0, 1});
    v("finalists", self.finalists, OptionInfo{"", "poses refined with many points", 1, 100});
  }
};

}  // namespace phasescan
