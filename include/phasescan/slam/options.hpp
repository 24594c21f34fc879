#pragma once

#include "phasescan/core/options.hpp"
#include "phasescan/map/trinary_map.hpp"
#include "phasescan/match/options.hpp"
#include "phasescan/odometry/options.hpp"

namespace phasescan {

/// Loops: which places are compared and what it takes to believe one (section `loops`).
struct LoopOptions {
  bool enabled = true;
  double near_radius_m = 3.0;
  int min_nodes_apart = 20;
  int clusters_per_node = 2;
  double min_overlap = 0.55;
  double small_error_m = 0.25;
  double small_error_deg = 3.0;
  int votes = 3;
  double agree_m = 0.2;
  double agree_deg = 2.5;
  double undo_chi2 = 30.0;
  bool places = true;
  double places_after_m = 5.0;
  int place_candidates = 2;
  double most_drift = 0.2;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("enabled", self.enabled, OptionInfo{"", "look for places seen before"});
    v("near_radius_m", self.near_radius_m, OptionInfo{"m", "places nearer than this on the map are compared", 0.1, 50});
    v("min_nodes_apart", self.min_nodes_apart, OptionInfo{"", "keyframes between two visits of a place", 2, 1e6});
    v("clusters_per_node", self.clusters_per_node,
      OptionInfo{"", "earlier visits that a new keyframe is compared with", 1, 20});
    v("min_overlap", self.min_overlap,
      OptionInfo{"", "share of the hits that must lie on the other visit's surfaces", 0, 1});
    v("small_error_m", self.small_error_m,
      OptionInfo{"m", "a loop that moves the map less is believed by itself", 0, 10});
    v("small_error_deg", self.small_error_deg, OptionInfo{"deg", "the same for its turn", 0, 90});
    v("votes", self.votes, OptionInfo{"", "loops that must agree before they move the map farther", 1, 20});
    v("agree_m", self.agree_m, OptionInfo{"m", "loops agree when they differ by less", 0, 5});
    v("agree_deg", self.agree_deg, OptionInfo{"deg", "the same for their turn", 0, 45});
    v("undo_chi2", self.undo_chi2,
      OptionInfo{"", "a loop that fits the graph worse than this is taken out again", 1, 1e6});
    v("places", self.places,
      OptionInfo{"", "look for places seen before by what they look like as well, wherever the map has them"});
    v("places_after_m", self.places_after_m,
      OptionInfo{"m", "way since a place last looked as the map has it after which that is done", 0, 1e6});
    v("place_candidates", self.place_candidates,
      OptionInfo{"", "earlier places that a new keyframe is matched with, no guess given", 1, 20});
    v("most_drift", self.most_drift,
      OptionInfo{"", "metres by which a place found so may move the map, for each metre of the way since", 0, 10});
  }
};

/// What belongs to no single part (section `slam`).
struct SlamGeneralOptions {
  int batch_nodes = 10;
  bool polish = true;
  bool bounded_memory = false;
  bool largest_piece = true;
  double session_gap_s = 60.0;
  double autosave_s = 4.0;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("batch_nodes", self.batch_nodes,
      OptionInfo{"", "keyframes after which loops and graph are worked on; a result enters one batch later", 1, 1000});
    v("polish", self.polish, OptionInfo{"", "match every scan once more against the finished map"});
    v("bounded_memory", self.bounded_memory,
      OptionInfo{"", "forget scans and redundant keyframes: memory grows with the area, not with time"});
    v("largest_piece", self.largest_piece,
      OptionInfo{
          "", "where tracking broke and no loop ties the pieces, draw the largest alone: where others lie is a guess"});
    v("session_gap_s", self.session_gap_s,
      OptionInfo{"s", "a log that begins at most so long after the end of the one before goes on with it", 0, 1e9});
    v("autosave_s", self.autosave_s,
      OptionInfo{"s", "with --save, the state is written this often while scans come; 0: at the end alone", 0, 1e9});
  }
};

/// All sections of `slam`.
struct SlamOptions {
  SlamGeneralOptions slam;
  OdometryOptions odometry;
  LoopOptions loops;
  OccupancyOptions map;
  GlassOptions glass;
  /// Of matches without a guess: each scan with the last one, and places seen before. Sections `match` and `global`,
  /// which a configuration holds once for all commands; `visit_sections` leaves them out.
  MatchOptions match;

  template <class Self, class Visitor>
  static void visit_sections(Self& self, Visitor&& v) {
    v("slam", self.slam);
    v("odometry", self.odometry);
    v("loops", self.loops);
    v("map", self.map);
    v("glass", self.glass);
  }
  /// @throws std::invalid_argument naming section, field and bounds.
  void validate() const {
    visit_sections(*this, [](std::string_view name, const auto& section) { validate_options(name, section); });
    match.validate();
  }
};

}  // namespace phasescan
