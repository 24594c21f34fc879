#pragma once

#include "phasescan/core/options.hpp"

namespace phasescan {

/// Where a robot is in a map that is known (section `localize`).
struct LocalizeOptions {
  double min_confidence = 0.95;
  double ambiguous_gap = 6.0;
  double view_spacing_m = 0.35;
  double view_range_m = 30.0;
  int candidates = 300;
  int finalists = 10;
  int max_hypotheses = 12;
  double search_every_m = 0.5;
  double revolution_turn_deg = -1.0;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("min_confidence", self.min_confidence,
      OptionInfo{"", "a pose is ok above this probability of being within 0.1 m and 3 deg of the truth", 0, 1});
    v("ambiguous_gap", self.ambiguous_gap,
      OptionInfo{"", "another pose explains a scan as well where its log-likelihood is within this", 0, 1000});
    v("view_spacing_m", self.view_spacing_m,
      OptionInfo{"m", "the map's views are made from places so far apart", 0.1, 5});
    v("view_range_m", self.view_range_m, OptionInfo{"m", "nothing farther away is in a view", 1, 200});
    v("candidates", self.candidates, OptionInfo{"", "views that a scan is compared with more closely", 1, 100000});
    v("finalists", self.finalists, OptionInfo{"", "poses that are matched to the end", 1, 1000});
    v("max_hypotheses", self.max_hypotheses,
      OptionInfo{"", "poses that are followed while a place is ambiguous", 1, 200});
    v("search_every_m", self.search_every_m,
      OptionInfo{"m", "way after which the whole map is searched again while the pose is not sure", 0.05, 100});
    v("revolution_turn_deg", self.revolution_turn_deg,
      OptionInfo{"deg",
                 "whole revolutions turn by this (standard deviation), which widens covariances; below 0: not known",
                 -1, 10});
  }
};

}  // namespace phasescan
