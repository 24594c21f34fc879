/// Options of the default matcher: the only home of their defaults.
#pragma once

#include "phasescan/core/options.hpp"

namespace phasescan {

/// What the answer must meet (section `match`).
struct MatchGeneralOptions {
  bool fast = false;
  double min_confidence = 0.9;
  int min_points = 10;
  double revolution_turn_deg = -1.0;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("fast", self.fast, OptionInfo{"", "trade a little robustness for time (global)"});
    v("min_confidence", self.min_confidence, OptionInfo{"", "usable above this probability (global)", 0, 1});
    v("min_points", self.min_points, OptionInfo{"", "fewer hits in either scan: no answer", 1, 1e6});
    v("revolution_turn_deg", self.revolution_turn_deg,
      OptionInfo{"deg", "whole revolutions turn by this (standard deviation); below 0: from the beams", -1, 10});
  }
};

/// Where rotation hypotheses come from. `sweep` is complete; `normals` names a few; `automatic` tries those of the
/// normals and sweeps where what they lead to does not convince.
enum class RotationSearch { kAutomatic, kSweep, kNormals };
template <>
std::span<const std::string_view> enum_names<RotationSearch>();

/// The search of the default matcher (section `global`).
struct GlobalOptions {
  RotationSearch rotations = RotationSearch::kAutomatic;
  int rotation_peaks = 8;
  double sweep_step_deg = 6.0;
  double guess_turn_deg = 45.0;
  int sparse_points = 64;
  int middle_points = 128;
  int candidates = 10;
  double coarse_share = 0.8;
  int finalists = 3;
  bool twins = true;
  bool free_space = true;
  bool missing_data = true;
  bool adaptive_scale = true;
  bool fine_refinement = true;
  bool refinement = true;
  bool both_ways = true;
  bool noise_weights = true;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("rotations", self.rotations,
      OptionInfo{"", "auto (normals, then sweep if in doubt), sweep (complete) or normals"});
    v("rotation_peaks", self.rotation_peaks, OptionInfo{"", "rotations taken from the normals", 1, 64});
    v("sweep_step_deg", self.sweep_step_deg,
      OptionInfo{"deg", "rotations of the coarse sweep are this far apart", 1, 30});
    v("guess_turn_deg", self.guess_turn_deg,
      OptionInfo{"deg", "with a guess, the sweep goes this far to either side", 0, 180});
    v("sparse_points", self.sparse_points, OptionInfo{"", "hits of the scan in the coarse sweep", 16, 4000});
    v("middle_points", self.middle_points,
      OptionInfo{"", "hits of each scan that are weighed as evidence", 16, 100000});
    v("candidates", self.candidates, OptionInfo{"", "poses of the sweep that are refined", 1, 1000});
    v("coarse_share", self.coarse_share,
      OptionInfo{"", "poses of the sweep below this share of the best sum are dropped", 0, 1});
    v("finalists", self.finalists, OptionInfo{"", "poses refined with more hits", 1, 100});
    v("twins", self.twins, OptionInfo{"", "look for the quarter and half turns of symmetric rooms, also far away"});
    v("free_space", self.free_space,
      OptionInfo{"", "hits where the other scan looked through, or behind its surfaces, count against a pose"});
    v("missing_data", self.missing_data, OptionInfo{"", "hits where the other scan saw nothing count against a pose"});
    v("adaptive_scale", self.adaptive_scale,
      OptionInfo{"", "cells and gates follow the size of the place; else as for 6 m"});
    v("fine_refinement", self.fine_refinement, OptionInfo{"", "refine the best pose with all hits"});
    v("refinement", self.refinement, OptionInfo{"", "refine poses at all; off: poses of the sweep as they are"});
    v("both_ways", self.both_ways,
      OptionInfo{"", "finalists are refined with the hits of both scans; off: with the scan's alone"});
    v("noise_weights", self.noise_weights,
      OptionInfo{"", "each hit weighs as its noise and incidence deserve; off: all alike"});
  }
};

/// All sections that the default matcher reads.
struct MatchOptions {
  MatchGeneralOptions match;
  GlobalOptions global;

  /// Calls v(section_name, section_struct) for each.
  template <class Self, class Visitor>
  static void visit_sections(Self& self, Visitor&& v) {
    v("match", self.match);
    v("global", self.global);
  }

  /// @throws std::invalid_argument naming section, field and bounds.
  void validate() const;
};

}  // namespace phasescan
