#include "slam/backend.hpp"

#include <algorithm>
#include <cmath>

#include "edge_information.hpp"
#include "odometry/information.hpp"
#include "odometry/registration.hpp"

namespace phasescan {
namespace {

constexpr int kNodesPerOptimize = 60;  // small loops can wait: they hardly move the map
// Doubt of a step beyond the usual counts as so much way.
constexpr double kSmallDoubtM = 0.05, kWayPerDoubt = 100.0;
constexpr int kFinalRounds = 2;        // the second finds what came near only by the first
constexpr double kMetresPerRad = 0.3;  // way that a turn counts as
constexpr double kTakeBack = 0.3;  // of undo_chi2: a loop that fits this well again is taken back; between, all stays
constexpr double kNoKernel = 1e6;  // standard deviations: no loop is that far off
constexpr double kMostStepChi2 = 6.0;  // of three numbers: twice what noise alone gives a step

}  // namespace

Backend::Backend(const SlamOptions& options) : options_(options), judge_(options.loops), places_(options.loops) {}

void Backend::add_batch(std::vector<Keyframe> batch) {
  for (Keyframe& keyframe : batch) {
    if (options_.slam.bounded_memory) {
      settle(std::move(keyframe));
    } else {
      take(std::move(keyframe));
    }
  }
  const int n = static_cast<int>(keyframes_.size());
  if (large_correction_ || (new_edges_ > 0 && n - nodes_at_optimize_ >= kNodesPerOptimize))
    optimize(large_correction_ ? 15 : 4);
}

void Backend::take(Keyframe keyframe) {
  const Pose2 T_odom = keyframe.T_odom_base;
  add_keyframe(std::move(keyframe));
  const int node = static_cast<int>(keyframes_.size()) - 1;
  hand_in(node, {}, T_odom);
  if (options_.loops.enabled) find_loops(node);
}

void Backend::hand_in(int node, const Pose2& T_node_keyframe, const Pose2& T_odom) {
  handed_.push_back({node, static_cast<float>(T_node_keyframe.x), static_cast<float>(T_node_keyframe.y),
                     static_cast<float>(T_node_keyframe.theta), static_cast<float>(T_odom.x),
                     static_cast<float>(T_odom.y), static_cast<float>(T_odom.theta)});
  T_odom_last_ = T_odom;
}

void Backend::add_keyframe(Keyframe keyframe) {
  if (keyframes_.empty() || keyframe.new_segment) piece_.push_back(static_cast<int>(piece_.size()));
  segment_.push_back(static_cast<int>(piece_.size()) - 1);
  if (keyframes_.empty()) {
    graph_.add_node(keyframe.T_odom_base);
    way_m_.push_back(0.0);
    keyframes_.push_back(std::move(keyframe));
    return;
  }
  const Handed& last = handed_.back();
  const Pose2 step = last.T_node_keyframe() * (T_odom_last_.inverse() * keyframe.T_odom_base);
  const int node = graph_.add_node(graph_.poses()[static_cast<std::size_t>(last.node)] * step);
  const double distance = std::hypot(step.x, step.y);
  const double way = distance + kMetresPerRad * std::abs(step.theta) + (keyframe.new_segment ? kBreakM : 0.0);
  since_loop_m_ += way;
  way_m_.push_back(way_m_.back() + way);
  PoseEdge edge;
  edge.from = last.node;
  edge.to = node;
  edge.T_from_to = step;
  if (keyframe.new_segment) {
    edge.information = Eigen::Vector3d(0.1, 0.1, 0.1).asDiagonal();
  } else {
    edge.information = edge_information(keyframe.information, 1.0, 0.5);
    // What was driven unseen along a corridor may be off by all that the edge leaves open: errors of one kind add up.
    since_loop_m_ += kWayPerDoubt * std::max(0.0, largest_deviation(edge.information) - kSmallDoubtM);
  }
  graph_.add_edge(edge);
  keyframes_.push_back(std::move(keyframe));
}

std::vector<Pose2> Backend::handed_in_poses(bool odometry) const {
  std::vector<Pose2> out;
  out.reserve(handed_.size());
  for (const Handed& h : handed_) {
    out.push_back(odometry ? Pose2{static_cast<double>(h.odom_x), static_cast<double>(h.odom_y),
                                   static_cast<double>(h.odom_theta)}
                           : graph_.poses()[static_cast<std::size_t>(h.node)] * h.T_node_keyframe());
  }
  return out;
}

void Backend::bend_to_large_loops() {
  const std::vector<Pose2> before = graph_.poses();
  GraphOptions options;
  options.max_iterations = 25;
  options.kernel_width = kNoKernel;
  graph_.optimize(options);
  int first = static_cast<int>(before.size());
  for (const int i : large_loops_) first = std::min(first, graph_.edges()[static_cast<std::size_t>(i)].from);
  double chi2 = 0.0;
  int steps = 0;
  for (std::size_t i = 0; i < graph_.edges().size(); ++i) {
    const PoseEdge& edge = graph_.edges()[i];
    if (edge.robust || edge.from < first) continue;
    chi2 += graph_.edge_chi2(static_cast<int>(i));
    ++steps;
  }
  if (chi2 <= kMostStepChi2 * steps) return;
  for (std::size_t k = 0; k < before.size(); ++k) graph_.set_pose(static_cast<int>(k), before[k]);
  for (const int i : large_loops_) graph_.set_enabled(i, false);
}

void Backend::optimize(int max_iterations) {
  if (!large_loops_.empty()) bend_to_large_loops();
  large_loops_.clear();
  GraphOptions options;
  options.max_iterations = max_iterations;
  graph_.optimize(options);
  undo_contradicted();
  map_cache_.clear();
  surroundings_of_ = -1;
  next_cached_ = 0;
  nodes_at_optimize_ = static_cast<int>(keyframes_.size());
  new_edges_ = 0;
  large_correction_ = false;
}

void Backend::undo_contradicted() {
  bool changed = false;
  for (std::size_t i = 0; i < graph_.edges().size(); ++i) {
    const PoseEdge& edge = graph_.edges()[i];
    if (!edge.robust) continue;
    const double chi2 = graph_.edge_chi2(static_cast<int>(i));
    if (edge.enabled && chi2 > options_.loops.undo_chi2) {
      graph_.set_enabled(static_cast<int>(i), false);
      changed = true;
    } else if (!edge.enabled && chi2 < kTakeBack * options_.loops.undo_chi2) {
      graph_.set_enabled(static_cast<int>(i), true);
      changed = true;
    }
  }
  if (changed) {
    GraphOptions options;
    options.max_iterations = 5;
    graph_.optimize(options);
  }
}

void Backend::finish() {
  settle_waiting();
  judge_.close();
  if (keyframes_.size() < 2) return;
  optimize(30);
  if (!options_.loops.enabled) return;
  counts_before_rematch_ = loop_counts();
  // With the map in place every keyframe meets its neighbours of all times, the later ones too; what was matched while
  // the map was still bent is matched anew.
  for (int round = 0; round < kFinalRounds; ++round) rematch_all();
}

LoopCounts Backend::loop_counts() const {
  LoopCounts counts = counts_;
  counts.outvoted += judge_.dropped();
  for (const PoseEdge& edge : graph_.edges()) {
    if (edge.robust) ++(edge.enabled ? counts.accepted : counts.undone);
  }
  const std::size_t in_graph = counts.accepted;
  if (counts_before_rematch_) counts = *counts_before_rematch_;
  counts.in_graph = in_graph;
  return counts;
}

void Backend::build_surroundings(int node, std::size_t max_keyframes, LocalMap& map) const {
  const auto& poses = graph_.poses();
  const Pose2& here = poses[static_cast<std::size_t>(node)];
  const Eigen::Vector2d centre = here * keyframes_[static_cast<std::size_t>(node)].centre;
  std::vector<std::pair<double, int>> near;
  for (std::size_t k = 0; k < keyframes_.size(); ++k) {
    const double distance = translation_distance(here, poses[k]);
    if (distance > options_.loops.near_radius_m) continue;
    near.emplace_back(distance + 0.5 * (poses[k] * keyframes_[k].centre - centre).norm(), static_cast<int>(k));
  }
  if (near.size() > max_keyframes) {
    std::nth_element(near.begin(), near.begin() + static_cast<std::ptrdiff_t>(max_keyframes), near.end());
    near.resize(max_keyframes);
  }
  std::sort(near.begin(), near.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  map.reset(here, options_.odometry.map_range_m + 5.0, options_.odometry.cell_m);
  for (const auto& [far, k] : near)
    map.add(*keyframes_[static_cast<std::size_t>(k)].points, poses[static_cast<std::size_t>(k)]);
  map.finish();
}

}  // namespace phasescan
