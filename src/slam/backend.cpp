#include "slam/backend.hpp"

#include "slam/visit_maps.hpp"
#include "slam/visit_match.hpp"

namespace phasescan {
namespace {

constexpr int kFinalIterations = 30;
constexpr int kFinalPasses = 2;  // the second finds what came near only by the first

}  // namespace

Backend::Backend(const SlamOptions& options, BackendState state)
    : options_(options),
      session_(options.loops, std::move(state.session)),
      places_(options.loops, options.match, std::move(state.places)),
      closer_(options, std::move(state.loops)),
      admission_(make_admission(options, std::move(state.admission))),
      covariance_(state.covariance),
      batches_(state.batches),
      counts_before_last_pass_(state.counts_before_last_pass) {
  connectivity_.rebuild(session_.keyframes(), session_.graph());
  publisher_.publish(batches_, session_, connectivity_, covariance());
}

BackendState Backend::state() const {
  return {session_.state(),    places_.state(), closer_.state(),         admission_->state(),
          covariance_.state(), batches_,        counts_before_last_pass_};
}

void Backend::add_batch(std::vector<Keyframe> batch) {
  closer_.begin_batch(session_);
  for (Keyframe& keyframe : batch) {
    admission_->submit(std::move(keyframe), session_, places_);
    place_admitted();
  }
  if (session_.optimize_if_due()) graph_changed();
  publisher_.publish(++batches_, session_, connectivity_, covariance());
}

void Backend::graph_changed() {
  connectivity_.rebuild(session_.keyframes(), session_.graph());
  covariance_.optimized(session_, connectivity_);
}

void Backend::place_admitted() {
  while (std::optional<Placement> placement = admission_->next(session_)) {
    if (placement->attach_at) {
      attach(*placement);
    } else {
      insert(std::move(*placement));
    }
  }
}

void Backend::attach(const Placement& placement) {
  const Pose2 before = submitted_pose(submitted() - 1);
  session_.attach_to_node(placement.keyframe, *placement.attach_at);
  if (placement.confirms_position) session_.confirm_position();
  covariance_.attached(session_, connectivity_, before, placement.keyframe.information, placement.match_information);
}

void Backend::insert(Placement placement) {
  const bool tied = session_.last_node() >= 0 && !placement.keyframe.new_segment;
  connectivity_.add_node(tied ? session_.submitted().back().node : -1);
  const Pose2 before = submitted() > 0 ? submitted_pose(submitted() - 1) : Pose2{};
  const int node = session_.insert_node(std::move(placement.keyframe));
  covariance_.inserted(session_, before);
  if (options_.loops.enabled) add_loops(closer_.search(node, session_, places_, connectivity_));
  for (Loop& loop : placement.recognised) {
    loop.to = node;
    add_loops(closer_.submit(loop, session_, connectivity_));
  }
}

void Backend::add_loops(std::span<const Loop> loops) {
  for (const Loop& loop : loops) {
    session_.add_loop(loop);
    if (holds_position(loop.information)) session_.confirm_position();
  }
}

KeyframeNumbers Backend::keep_keyframes(const std::vector<std::int32_t>& needed, std::int32_t recent) {
  session_.keep_submitted(needed, recent);
  return session_.state().numbers();
}

void Backend::close_admission() {
  admission_->close();
  place_admitted();
}

void Backend::finish() {
  close_admission();
  closer_.close();
  if (keyframes().size() >= 2) {
    session_.optimize(kFinalIterations);
    graph_changed();
    if (options_.loops.enabled) counts_before_last_pass_ = loop_counts();
    // What was matched while the map was still bent is matched anew.
    for (int pass = 0; pass < kFinalPasses && options_.loops.enabled; ++pass) {
      session_.replace_loops(closer_.search_all(session_, connectivity_));
      graph_changed();
    }
  }
  publisher_.publish(++batches_, session_, connectivity_, covariance());
}

LoopCounts Backend::loop_counts() const {
  const LoopCloserState closer = closer_.state();
  LoopCounts counts;
  counts.compared = closer.compared;
  counts.places = closer.places;
  counts.found = closer.found;
  counts.rejected_inconsistent = closer_.rejected_inconsistent();
  counts.rejected_beyond_drift = closer.beyond;
  counts.rejected_alike = closer.alike;
  for (const PoseEdge& edge : graph().edges()) {
    if (edge.robust) ++(edge.enabled ? counts.accepted : counts.undone);
  }
  const std::size_t in_graph = counts.accepted;
  if (counts_before_last_pass_) counts = *counts_before_last_pass_;
  counts.in_graph = in_graph;
  return counts;
}

std::vector<Pose2> Backend::submitted_poses(bool odometry) const {
  std::vector<Pose2> out;
  out.reserve(submitted());
  for (std::size_t k = 0; k < submitted(); ++k)
    out.push_back(odometry ? session_.submitted()[k].T_odom_base() : submitted_pose(k));
  return out;
}

void Backend::build_surroundings(int node, std::size_t max_keyframes, LocalMap& map) const {
  phasescan::build_surroundings(session_, node, options_.loops.near_radius_m, max_keyframes, options_.odometry, map);
}

}  // namespace phasescan
