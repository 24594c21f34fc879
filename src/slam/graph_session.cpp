#include "slam/graph_session.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "odometry/information.hpp"
#include "slam/edge_information.hpp"

namespace phasescan {
namespace {

// When the graph is optimised.
constexpr int kNodesPerOptimize = 60;  // loops with a small error hardly move the map and can wait for so many nodes
constexpr int kIterations = 4, kLargeIterations = 15, kUndoIterations = 5, kWithoutKernelIterations = 25,
              kReplaceIterations = 30;

// Way that counts as travelled without confirmation.
constexpr double kMetresPerRad = 0.3;    // a turn of one radian
constexpr double kUsualSigmaM = 0.05;    // standard deviation of a step in its weakest direction that adds nothing
constexpr double kMetresPerSigma = 100;  // what lies above it: errors along one corridor are of one kind and add up

// Standard deviations that a step keeps whatever its match claims to know [m], [rad].
constexpr double kStepWeakM = 1.0, kStepWeakRad = 0.5;
constexpr double kBreakInformation =
    0.1;  // of the guess that ties a node to the one before a break, each of x, y, theta
// Of the place where a new session is put, each of x, y: it is kilometres off the one where it belongs.
constexpr double kBesideM = 1000.0, kSessionInformation = 1e-7;

constexpr double kOutOfReachM = 1.0;   // a loop that is off by more has no weight left under the robust kernel
constexpr double kNoKernel = 1e6;      // width of the kernel in standard deviations: no loop is that far off
constexpr double kMostStepChi2 = 6.0;  // mean over steps of three numbers each: twice what noise alone gives
constexpr double kTakeBack = 0.3;      // share of loops.undo_chi2 below which an undone loop is taken back

}  // namespace

KeyframeNumbers GraphSessionState::numbers() const {
  std::vector<std::int32_t> old;
  old.reserve(old_submitted.size());
  for (const OldKeyframe& keyframe : old_submitted) old.push_back(keyframe.number);
  return {std::move(old), first_submitted};
}

void GraphSessionState::count_kept() {
  std::vector<SubmittedKeyframe> kept;
  kept.reserve(old_submitted.size() + submitted.size());
  for (const OldKeyframe& keyframe : old_submitted) kept.push_back(keyframe.submitted);
  kept.insert(kept.end(), submitted.begin(), submitted.end());
  submitted = std::move(kept);
  old_submitted.clear();
  first_submitted = 0;
}

void GraphSession::keep_submitted(const std::vector<std::int32_t>& needed, std::int32_t recent) {
  if (state_.submitted.empty()) return;
  const auto last = static_cast<std::int32_t>(state_.submitted_count()) - 1;
  const std::int32_t first = std::clamp(recent, state_.first_submitted, last);
  for (std::int32_t k = state_.first_submitted; k < first; ++k)
    state_.old_submitted.push_back({k, state_.submitted[static_cast<std::size_t>(k - state_.first_submitted)]});
  state_.submitted.erase(state_.submitted.begin(), state_.submitted.begin() + (first - state_.first_submitted));
  state_.first_submitted = first;
  std::erase_if(state_.old_submitted, [&needed](const OldKeyframe& keyframe) {
    return !std::binary_search(needed.begin(), needed.end(), keyframe.number);
  });
}

GraphSession::GraphSession(const LoopOptions& options, GraphSessionState state)
    : options_(options), state_(std::move(state)) {}

/// Where a new session is put until it is known where it belongs: so far off that nothing there passes for near.
Pose2 GraphSession::beside_the_map() const {
  double right = poses().front().x;
  for (const Pose2& pose : poses()) right = std::max(right, pose.x);
  return {right + kBesideM, 0.0, 0.0};
}

Pose2 GraphSession::predict(const Keyframe& keyframe) const {
  if (begins_session(keyframe)) return beside_the_map() * keyframe.T_odom_base;
  const SubmittedKeyframe& last = state_.submitted.back();
  return poses()[static_cast<std::size_t>(last.node)] * last.T_node_keyframe() *
         (state_.T_odom_last.inverse() * keyframe.T_odom_base);
}

Pose2 GraphSession::T_map_odom() const {
  const SubmittedKeyframe& last = state_.submitted.back();
  return poses()[static_cast<std::size_t>(last.node)] * last.T_node_keyframe() * state_.T_odom_last.inverse();
}

void GraphSession::submit(const Keyframe& keyframe, int node, const Pose2& T_node_keyframe) {
  const Pose2& T_odom = keyframe.T_odom_base;
  state_.submitted.push_back({node, static_cast<float>(T_node_keyframe.x), static_cast<float>(T_node_keyframe.y),
                              static_cast<float>(T_node_keyframe.theta), static_cast<float>(T_odom.x),
                              static_cast<float>(T_odom.y), static_cast<float>(T_odom.theta)});
  state_.T_odom_last = T_odom;
  state_.last_session = keyframe.session;
}

int GraphSession::insert_node(Keyframe keyframe) {
  int node = 0;
  if (state_.keyframes.empty()) {
    node = state_.graph.add_node(keyframe.T_odom_base);
    state_.travelled_m.push_back(0.0);
  } else {
    const SubmittedKeyframe& last = state_.submitted.back();
    const Pose2 step = begins_session(keyframe)
                           ? poses()[static_cast<std::size_t>(last.node)].inverse() * predict(keyframe)
                           : last.T_node_keyframe() * (state_.T_odom_last.inverse() * keyframe.T_odom_base);
    node = state_.graph.add_node(poses()[static_cast<std::size_t>(last.node)] * step);
    add_step(keyframe, node, step);
  }
  submit(keyframe, node, {});
  state_.keyframes.push_back(std::move(keyframe));
  return node;
}

void GraphSession::add_step(const Keyframe& keyframe, int node, const Pose2& step) {
  const bool session = begins_session(keyframe);
  const double way = std::hypot(step.x, step.y) + kMetresPerRad * std::abs(step.theta) +
                     (session                ? kSessionM
                      : keyframe.new_segment ? kBreakM
                                             : 0.0);
  state_.unconfirmed_m += way;
  state_.travelled_m.push_back(state_.travelled_m.back() + way);
  PoseEdge edge;
  edge.from = state_.submitted.back().node;
  edge.to = node;
  edge.T_from_to = step;
  if (session) {
    edge.information = Eigen::Vector3d(kSessionInformation, kSessionInformation, kBreakInformation).asDiagonal();
  } else if (keyframe.new_segment) {
    edge.information = Eigen::Vector3d::Constant(kBreakInformation).asDiagonal();
  } else {
    edge.information = edge_information(keyframe.information, kStepWeakM, kStepWeakRad);
    state_.unconfirmed_m += kMetresPerSigma * std::max(0.0, largest_deviation(edge.information) - kUsualSigmaM);
  }
  state_.graph.add_edge(edge);
}

int GraphSession::append(GraphSessionState other) {
  const int first = last_node() + 1, edges = static_cast<int>(state_.graph.edges().size());
  if (other.keyframes.empty()) return first;
  if (first == 0) {
    state_ = std::move(other);
    return first;
  }
  const Pose2 beside = beside_the_map();
  for (const Pose2& pose : other.graph.poses()) state_.graph.add_node(beside * pose);
  other.keyframes.front().new_segment = true;
  PoseEdge guess;
  guess.from = state_.submitted.back().node;
  guess.to = first;
  guess.T_from_to = poses()[static_cast<std::size_t>(guess.from)].inverse() * poses()[static_cast<std::size_t>(first)];
  guess.information = Eigen::Vector3d(kSessionInformation, kSessionInformation, kBreakInformation).asDiagonal();
  state_.graph.add_edge(guess);
  for (PoseEdge edge : other.graph.edges()) {
    edge.from += first;
    edge.to += first;
    state_.graph.add_edge(edge);
  }
  const double way = state_.travelled_m.back() + kSessionM;
  for (const double travelled : other.travelled_m) state_.travelled_m.push_back(way + travelled);
  for (const int edge : other.large_loops) state_.large_loops.push_back(edges + 1 + edge);
  std::move(other.keyframes.begin(), other.keyframes.end(), std::back_inserter(state_.keyframes));
  for (SubmittedKeyframe keyframe : other.submitted) {
    keyframe.node += first;
    state_.submitted.push_back(keyframe);
  }
  state_.T_odom_last = other.T_odom_last;
  state_.last_session = other.last_session;
  state_.unconfirmed_m = other.unconfirmed_m;
  state_.optimisations += other.optimisations + 1;  // poses are others now
  state_.new_edges += other.new_edges;
  state_.large_correction = state_.large_correction || other.large_correction;
  return first;
}

void GraphSession::move_nodes(const std::vector<char>& moved, const Pose2& T_after_before) {
  for (std::size_t k = 0; k < moved.size(); ++k) {
    if (moved[k]) state_.graph.set_pose(static_cast<int>(k), T_after_before * poses()[k]);
  }
  ++state_.optimisations;
}

void GraphSession::attach_to_node(const Keyframe& keyframe, const Pose2& T_map_base) {
  const auto nearer = [&T_map_base](const Pose2& a, const Pose2& b) {
    return translation_distance(T_map_base, a) < translation_distance(T_map_base, b);
  };
  const auto nearest = std::min_element(poses().begin(), poses().end(), nearer);
  submit(keyframe, static_cast<int>(nearest - poses().begin()), nearest->inverse() * T_map_base);
}

namespace {

PoseEdge edge_of(const Loop& loop) {
  PoseEdge edge;
  edge.from = loop.from;
  edge.to = loop.to;
  edge.T_from_to = loop.T_from_to;
  edge.information = loop.information;
  edge.robust = true;
  return edge;
}

}  // namespace

void GraphSession::add_loop(const Loop& loop) {
  const Pose2 error = asked_correction(loop, poses());
  const double off = std::hypot(error.x, error.y);
  const int edge = state_.graph.add_edge(edge_of(loop));
  ++state_.new_edges;
  if (off > options_.small_error_m) {
    state_.large_correction = true;
    if (off > kOutOfReachM) state_.large_loops.push_back(edge);
  }
}

bool GraphSession::optimize_if_due() {
  const bool many = state_.new_edges > 0 && last_node() + 1 - state_.nodes_at_optimize >= kNodesPerOptimize;
  if (!state_.large_correction && !many) return false;
  optimize(state_.large_correction ? kLargeIterations : kIterations);
  return true;
}

void GraphSession::optimize(int max_iterations) {
  if (!state_.large_loops.empty()) optimise_without_kernel();
  state_.large_loops.clear();
  GraphOptions options;
  options.max_iterations = max_iterations;
  state_.graph.optimize(options);
  undo_contradicted();
  ++state_.optimisations;
  state_.nodes_at_optimize = last_node() + 1;
  state_.new_edges = 0;
  state_.large_correction = false;
}

void GraphSession::optimise_without_kernel() {
  PoseGraph& graph = state_.graph;
  const std::vector<Pose2> before = graph.poses();
  GraphOptions options;
  options.max_iterations = kWithoutKernelIterations;
  options.kernel_width = kNoKernel;
  graph.optimize(options);
  int first = static_cast<int>(before.size());
  for (const int i : state_.large_loops) first = std::min(first, graph.edges()[static_cast<std::size_t>(i)].from);
  double chi2 = 0.0;
  int steps = 0;
  for (std::size_t i = 0; i < graph.edges().size(); ++i) {
    const PoseEdge& edge = graph.edges()[i];
    if (edge.robust || edge.from < first) continue;
    chi2 += graph.edge_chi2(static_cast<int>(i));
    ++steps;
  }
  if (chi2 <= kMostStepChi2 * steps) return;
  for (std::size_t k = 0; k < before.size(); ++k) graph.set_pose(static_cast<int>(k), before[k]);
  for (const int i : state_.large_loops) graph.set_enabled(i, false);
}

void GraphSession::undo_contradicted() {
  PoseGraph& graph = state_.graph;
  bool changed = false;
  for (std::size_t i = 0; i < graph.edges().size(); ++i) {
    const PoseEdge& edge = graph.edges()[i];
    if (!edge.robust) continue;
    const double chi2 = graph.edge_chi2(static_cast<int>(i));
    const bool undo = edge.enabled && chi2 > options_.undo_chi2;
    const bool take_back = !edge.enabled && chi2 < kTakeBack * options_.undo_chi2;
    if (!undo && !take_back) continue;
    graph.set_enabled(static_cast<int>(i), take_back);
    changed = true;
  }
  if (!changed) return;
  GraphOptions options;
  options.max_iterations = kUndoIterations;
  graph.optimize(options);
}

void GraphSession::replace_loops(std::span<const Loop> loops) {
  PoseGraph& graph = state_.graph;
  std::vector<char> reached(state_.keyframes.size(), 0);
  for (const Loop& loop : loops) reached[static_cast<std::size_t>(loop.to)] = 1;
  std::vector<char> keep;
  keep.reserve(graph.edges().size());
  for (const PoseEdge& edge : graph.edges())
    keep.push_back(!edge.robust || (edge.enabled && !reached[static_cast<std::size_t>(edge.to)]));
  graph.keep_edges(keep);
  for (const Loop& loop : loops) graph.add_edge(edge_of(loop));
  state_.new_edges += loops.size();
  optimize(kReplaceIterations);
}

}  // namespace phasescan
