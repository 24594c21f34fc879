#pragma once

#include "phasescan/core/options.hpp"

namespace phasescan {

/// Tracking of scans in a local map (section `odometry`).
struct OdometryOptions {
  bool use_wheels = true;
  bool deskew = true;
  bool standstill_lock = true;
  bool motion_habits = true;
  double keyframe_distance_m = 0.25;
  double keyframe_angle_deg = 15.0;
  int window_keyframes = 16;
  double map_range_m = 30.0;
  double cell_m = 0.1;
  double min_overlap = 0.35;
  int lost_after_scans = 8;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("use_wheels", self.use_wheels, OptionInfo{"", "listen to wheel odometry where the log has any"});
    v("deskew", self.deskew, OptionInfo{"", "take the motion during a turn out of the scan"});
    v("standstill_lock", self.standstill_lock, OptionInfo{"", "hold the pose while nothing moves"});
    v("motion_habits", self.motion_habits,
      OptionInfo{"", "along bare corridors, tell rest by the walls' relief and else assume the robot's usual motion"});
    v("keyframe_distance_m", self.keyframe_distance_m, OptionInfo{"m", "a new keyframe after so much way", 0.01, 10});
    v("keyframe_angle_deg", self.keyframe_angle_deg, OptionInfo{"deg", "a new keyframe after so much turn", 1, 180});
    v("window_keyframes", self.window_keyframes, OptionInfo{"", "keyframes in the local map", 1, 200});
    v("map_range_m", self.map_range_m, OptionInfo{"m", "hits farther away are left out of the local map", 1, 200});
    v("cell_m", self.cell_m, OptionInfo{"m", "cell of the local map; partners are found up to 3 cells away", 0.02, 1});
    v("min_overlap", self.min_overlap,
      OptionInfo{"", "share of the hits that must lie on the map for a scan to count as tracked", 0, 1});
    v("lost_after_scans", self.lost_after_scans,
      OptionInfo{"", "scans in a row without a match until a new local map is begun", 1, 1000});
  }
};

}  // namespace phasescan
