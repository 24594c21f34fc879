/// What a run knows of itself, as plain numbers: what its verdict rests on.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "phasescan/slam/result.hpp"
#include "slam/backend.hpp"
#include "slam/map_check.hpp"
#include "slam/trajectory_refinement.hpp"

namespace phasescan {

/// All shares are 0 to 1; what cannot be told is 0.
struct RunEvidence {
  // How much there is.
  double scans = 0, keyframes = 0, way_m = 0, duration_s = 0;
  double points = 0;  ///< on surfaces, of a keyframe in the middle
  // Scans, of those with a return.
  double on_map = 0;         ///< matched, on the map drawn, not left out: share
  double lost = 0;           ///< not matched
  double lost_unaided = 0;   ///< and with no wheels that agree elsewhere
  double degraded = 0;       ///< matched, but only by a wide search or with much unexplained
  double ambiguous = 0;      ///< matched, with a direction open
  double left_out = 0;       ///< fits neither neighbour
  double off_map = 0;        ///< in a piece that nothing ties to the map
  double off_map_ratio = 0;  ///< error of the run if these stand 1 m off, by what a right map may be off
  double repeated = 0;       ///< of all messages
  // Time without a scan that says anything, and what the robot did then, as the map has it.
  double gaps = 0;              ///< share of the time in steps of more than 1.8 periods
  double longest_gap_s = 0;     ///< between two scans that were matched
  double longest_gap_m = 0;     ///< farthest way over such a step of more than 1.8 periods
  double longest_gap_turn = 0;  ///< [rad]
  double unseen_ratio = 0;  ///< way that the robot makes in longest_gap_s, by what a right map may be off; no wheels
  double jump = 0;          ///< fastest step of the way, times that speed which one step in twenty is over
  double jump_ratio = 0;    ///< way by which a step is longer than any robot's, by what a right map may be off
  double turn_jump = 0;     ///< the same of turning
  // The graph.
  double pieces = 0, breaks = 0, loops_per_keyframe = 0;
  double step_chi2 = 0;                           ///< how far the graph bends steps of tracking: mean
  double step_chi2_tail = 0, loop_chi2_tail = 0;  ///< mean of the twentieth of them that is worst
  double step_bend_m = 0, step_bend_turn = 0;     ///< largest [m], [rad]
  double bend_ratio = 0;         ///< step_bend_m by what a right map may be off: 0.2 m or 1 % of the way
  double loop_chi2 = 0;          ///< how badly loops of the graph fit
  double refined_m = 0;          ///< by how much the last pass moved keyframes: root mean square
  double no_overlap = 0;         ///< 1 - overlap
  double overlap = 1, kept = 0;  ///< of the scans with the map in the last pass: mean; share that it kept
  double expected_m = 0;         ///< standard deviation of keyframes' positions, from steps and loops
  double expected_ratio = 0;     ///< expected_m by what a right map may be off
  double moved_m = 0;            ///< farthest that loops moved a scan from where tracking had it
  // Loops that were found, by what became of them: share.
  double loops_found = 0;  ///< their number
  double undone = 0, beyond_drift = 0, alike = 0, inconsistent = 0;
  double doubted = 0;               ///< the last three: places look like others here
  double unseen_doubted = 0;        ///< times unseen_ratio: what brings the way back together may be another place
  double open_doubted = 0;          ///< doubted times expected_ratio: scans leave the way open, and so do loops
  double degraded_unconfirmed = 0;  ///< degraded, no wheels, and few loops
  double degraded_bent = 0;  ///< degraded times step_chi2_tail, no wheels: the graph bends what wide searches found
  // Wheels: way while they turned, by their account and by the scans; steps for each scan, and shares of the steps.
  double wheels_way_m = 0, wheels_seen_m = 0;
  double wheels = 0, wheels_agreed = 0, wheels_slipped = 0, wheels_reversed = 0, wheels_jumped = 0;
  // The map against its own scans.
  MapCheck map;
  VisitShares excess;  ///< means of visits far on the way above those of near ones: what sensor and people leave open
  double body_sectors = 0;  ///< in which the robot itself was found
  // Where to look: scans of the result, -1: nowhere. No part of the evidence.
  ScanId contradicted_scan = -1, gap_scan = -1, wheels_scan = -1, doubted_scan = -1;

  /// Wheels turned for twice the way on the map and a metre more. They may have slipped all the time; but a robot that
  /// is in its own view, or sees what moves along with it, stands still on its map as well.
  bool wheels_went_on() const {
    constexpr double kTimes = 2.0, kMoreM = 1.0;
    return wheels_way_m > kTimes * wheels_seen_m + kMoreM;
  }

  /// Calls v(name, number) for each.
  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    visit_scans(self, v);
    visit_graph(self, v);
    visit_comparison("near", self.map.near, v);
    visit_comparison("far", self.map.far, v);
    visit_shares("excess", self.excess, v);
    v("body_sectors", self.body_sectors);
  }

 private:
  template <class Self, class Visitor>
  static void visit_scans(Self& self, Visitor& v) {
    v("scans", self.scans);
    v("keyframes", self.keyframes);
    v("way_m", self.way_m);
    v("duration_s", self.duration_s);
    v("points", self.points);
    v("on_map", self.on_map);
    v("lost", self.lost);
    v("lost_unaided", self.lost_unaided);
    v("degraded", self.degraded);
    v("ambiguous", self.ambiguous);
    v("left_out", self.left_out);
    v("off_map", self.off_map);
    v("off_map_ratio", self.off_map_ratio);
    v("repeated", self.repeated);
    v("gaps", self.gaps);
    v("longest_gap_s", self.longest_gap_s);
    v("longest_gap_m", self.longest_gap_m);
    v("longest_gap_turn", self.longest_gap_turn);
    v("unseen_ratio", self.unseen_ratio);
    v("jump", self.jump);
    v("jump_ratio", self.jump_ratio);
    v("turn_jump", self.turn_jump);
    v("wheels_way_m", self.wheels_way_m);
    v("wheels_seen_m", self.wheels_seen_m);
    v("wheels", self.wheels);
    v("wheels_agreed", self.wheels_agreed);
    v("wheels_slipped", self.wheels_slipped);
    v("wheels_reversed", self.wheels_reversed);
    v("wheels_jumped", self.wheels_jumped);
  }
  template <class Self, class Visitor>
  static void visit_graph(Self& self, Visitor& v) {
    v("pieces", self.pieces);
    v("breaks", self.breaks);
    v("loops_per_keyframe", self.loops_per_keyframe);
    v("step_chi2", self.step_chi2);
    v("step_chi2_tail", self.step_chi2_tail);
    v("loop_chi2_tail", self.loop_chi2_tail);
    v("bend_ratio", self.bend_ratio);
    v("step_bend_m", self.step_bend_m);
    v("step_bend_turn", self.step_bend_turn);
    v("loop_chi2", self.loop_chi2);
    v("refined_m", self.refined_m);
    v("overlap", self.overlap);
    v("no_overlap", self.no_overlap);
    v("kept", self.kept);
    v("expected_m", self.expected_m);
    v("expected_ratio", self.expected_ratio);
    v("moved_m", self.moved_m);
    v("loops_found", self.loops_found);
    v("undone", self.undone);
    v("beyond_drift", self.beyond_drift);
    v("alike", self.alike);
    v("inconsistent", self.inconsistent);
    v("doubted", self.doubted);
    v("unseen_doubted", self.unseen_doubted);
    v("open_doubted", self.open_doubted);
    v("degraded_unconfirmed", self.degraded_unconfirmed);
    v("degraded_bent", self.degraded_bent);
  }
  template <class Comparison, class Visitor>
  static void visit_comparison(const std::string& name, Comparison& c, Visitor& v) {
    v(name + "_scans", static_cast<double>(c.scans));
    v(name + "_contradicting", static_cast<double>(c.contradicting));
    v(name + "_doubling", static_cast<double>(c.doubling));
    visit_shares(name, c.mean, v);
    visit_shares(name + "_tail", c.tail, v);
  }
  template <class Shares, class Visitor>
  static void visit_shares(const std::string& name, Shares& shares, Visitor& v) {
    v(name + "_crossed", shares.crossed);
    v(name + "_doubled", shares.doubled);
    v(name + "_in_free", shares.in_free);
    v(name + "_against", shares.against());
  }
};

/// What is judged: a finished run, or a part of one.
struct FinishedRun {
  const SlamResult* result = nullptr;  ///< scans, loops, wheels, oddities are there
  const Backend* backend = nullptr;
  std::vector<int> nodes;          ///< of the back end that the map is drawn from, in order
  std::vector<Pose2> T_map_stamp;  ///< of each of these as it is drawn; all in one frame
  std::vector<ScanId> scans;       ///< of each of these, as the result counts them
  bool deskew = true;
  RefinementFit fit;
  std::size_t body_sectors = 0;
  ScanId wheels_scan = -1;   ///< of the result: the first at which wheels disagreed, -1: none
  ScanId doubted_scan = -1;  ///< and at which a loop was rejected as one of places that look alike
};

/// @cost the map check, and O(scans + nodes + edges)
RunEvidence gather_evidence(const FinishedRun& run);

}  // namespace phasescan
