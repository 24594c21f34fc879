#include "slam/bounded_admission.hpp"

#include <algorithm>
#include <cmath>

#include "odometry/information.hpp"
#include "odometry/registration.hpp"
#include "slam/edge_information.hpp"
#include "slam/visit_maps.hpp"

namespace phasescan {
namespace {

// A place is shown well enough when so many keyframes look at it from so near, and a scan there fits so well.
constexpr int kShownKeyframes = 2, kMostKeyframes = 8;
constexpr double kShownM = 0.8, kShownViewM = 1.5, kShownOverlap = 0.7, kShownByOneOverlap = 0.9;
constexpr double kKnownM = 0.1;            // standard deviation of a pose that is known in every direction
constexpr std::size_t kSurroundings = 16;  // keyframes
constexpr std::size_t kMostWaiting = 8;    // about 2 m: by then loops.votes candidates have been seen, or none will be

// Standard deviations that a loop keeps whatever its match claims to know [m], [rad].
constexpr double kLoopWeakM = 3.0, kLoopWeakRad = 0.5;

}  // namespace

BoundedAdmission::BoundedAdmission(const SlamOptions& options, AdmissionState state)
    : options_(options), state_(std::move(state)) {}

const LocalMap& BoundedAdmission::surroundings(int node, const GraphSession& session) {
  Surroundings& kept = surroundings_;
  const std::size_t nodes = session.keyframes().size();
  if (node != kept.node || nodes != kept.nodes || session.optimisations() != kept.optimisations) {
    build_surroundings(session, node, options_.loops.near_radius_m, kSurroundings, options_.odometry, kept.map);
    kept.node = node;
    kept.nodes = nodes;
    kept.optimisations = session.optimisations();
  }
  return kept.map;
}

BoundedAdmission::MapMatch BoundedAdmission::match_map(const Keyframe& keyframe, const Pose2& predicted,
                                                       const GraphSession& session) {
  const auto& poses = session.poses();
  const auto& keyframes = session.keyframes();
  const Eigen::Vector2d centre = predicted * keyframe.centre;
  MapMatch match{0, predicted, 0.0, {}};
  int nearest = -1;
  double least = kShownM;
  for (std::size_t k = 0; k < poses.size(); ++k) {
    const double distance = translation_distance(predicted, poses[k]);
    // A full turn looks at the same whatever its heading; half of one does not.
    if (distance > kShownM || (poses[k] * keyframes[k].centre - centre).norm() > kShownViewM) continue;
    ++match.around;
    if (distance <= least) least = distance, nearest = static_cast<int>(k);
  }
  if (nearest < 0) return match;
  const LocalMap& map = surroundings(nearest, session);
  keyframe.points->unpack(points_);
  const Registration found = register_points(map, points_, map.T_world_map().inverse() * predicted);
  const Pose2 pose = map.T_world_map() * found.T_map_base;
  // A match that still moves by a millimetre after all its steps is as good as one that came to rest.
  if (translation_distance(pose, predicted) > options_.loops.small_error_m) return match;
  match.overlap = found.overlap;
  if (found.overlap <= options_.odometry.min_overlap) return match;
  match.pose = pose;
  match.information = kMatchTrust * rotate_information(found.information, -found.T_map_base.theta);
  return match;
}

void BoundedAdmission::lose(const GraphSession& session, bool new_session) {
  state_.unfit_m = new_session ? GraphSession::kSessionM : GraphSession::kBreakM;
  state_.sure_nodes = session.keyframes().size();
}

void BoundedAdmission::submit(Keyframe keyframe, const GraphSession& session, PlaceSearch& places) {
  if (session.submitted().empty()) {
    decided_.push_back({std::move(keyframe), Decision::kInsert, {}});
    return;
  }
  const Pose2 predicted = session.predict(keyframe);
  const MapMatch match = match_map(keyframe, predicted, session);
  const bool new_session = session.begins_session(keyframe);
  // What waits of another session has no more to wait for.
  if (!state_.waiting.empty() && state_.waiting.back().session != keyframe.session) admit_waiting();
  if (new_session || (keyframe.new_segment && !lost())) lose(session, new_session);
  const bool shown = match.overlap > (match.around >= kShownKeyframes ? kShownOverlap : kShownByOneOverlap);
  if (lost() || !shown) return defer(std::move(keyframe), match, predicted, session, places);
  // The way here was right: what waits stands where it was thought to.
  admit_waiting();
  decided_.push_back({std::move(keyframe), Decision::kAttach, match, true});
  state_.unfit_m = 0.0;
}

void BoundedAdmission::defer(Keyframe keyframe, const MapMatch& match, const Pose2& predicted,
                             const GraphSession& session, PlaceSearch& places) {
  const Keyframe& before = state_.waiting.empty() ? keyframe : state_.waiting.back();
  state_.unfit_m += translation_distance(before.T_odom_base, keyframe.T_odom_base);
  state_.waiting.push_back(std::move(keyframe));
  bool known = match.around > 0;
  if (options_.loops.enabled && options_.loops.places) {
    if (const auto other = recognise(state_.waiting.back(), predicted, session, places)) {
      const double off = translation_distance(other->pose, predicted);
      if (off < options_.loops.small_error_m) {
        state_.unfit_m = 0.0;
        return admit_waiting();
      }
      state_.candidates.push_back(*other);
      // Rooms look alike; but the way here is known too.
      if (off < options_.loops.near_radius_m + options_.loops.most_drift * state_.unfit_m && correct(session)) return;
    }
    known = known || !state_.candidates.empty();
  }
  if (known && state_.waiting.size() <= kMostWaiting) return;
  // It may be another place: what comes now hangs on what was before by no more than a guess, until loops tell.
  if (!state_.candidates.empty() && !lost()) {
    state_.waiting.front().new_segment = true;
    lose(session, false);
  }
  admit_waiting();
}

void BoundedAdmission::admit_waiting() {
  for (Keyframe& keyframe : state_.waiting) decided_.push_back({std::move(keyframe), Decision::kAttachOrInsert, {}});
  state_.waiting.clear();
  state_.candidates.clear();
}

std::optional<Placement> BoundedAdmission::next(const GraphSession& session) {
  if (decided_.empty()) return std::nullopt;
  Decision decision = std::move(decided_.front());
  decided_.pop_front();
  if (decision.kind == Decision::kAttachOrInsert) return attach_or_insert(std::move(decision.keyframe), session);
  Placement placement{std::move(decision.keyframe), std::nullopt, decision.confirms_position,
                      std::move(decision.recognised)};
  if (decision.kind == Decision::kAttach) {
    placement.attach_at = decision.match.pose;
    placement.match_information = decision.match.information;
  }
  return placement;
}

Placement BoundedAdmission::attach_or_insert(Keyframe keyframe, const GraphSession& session) {
  const MapMatch match = match_map(keyframe, session.predict(keyframe), session);
  const double enough = match.around > kMostKeyframes / 2 ? options_.odometry.min_overlap
                        : match.around >= kShownKeyframes ? kShownOverlap
                                                          : kShownByOneOverlap;
  // Where the place has all the keyframes it may have, a scan that does not fit (people) stands where odometry puts it.
  const bool attach = !keyframe.new_segment && (match.around >= kMostKeyframes || match.overlap > enough);
  Placement placement{std::move(keyframe), std::nullopt};
  if (attach) {
    placement.attach_at = match.pose;
    placement.match_information = match.information;
  }
  return placement;
}

std::optional<RelocalisationCandidate> BoundedAdmission::recognise(const Keyframe& keyframe, const Pose2& predicted,
                                                                   const GraphSession& session, PlaceSearch& places) {
  std::optional<RelocalisationCandidate> best;
  keyframe.points->unpack(points_);
  // What was added since the tracker was last sure of its place says nothing of that place.
  const std::size_t sure = lost() ? state_.sure_nodes : session.keyframes().size();
  for (const PlaceMatch& place : places.find(keyframe, session.keyframes(), session.poses(), sure)) {
    const Pose2 there = session.poses()[static_cast<std::size_t>(place.node)] * place.T_node_query;
    const LocalMap& map = surroundings(place.node, session);
    const Registration found = register_points(map, points_, map.T_world_map().inverse() * there);
    if (found.overlap < kShownOverlap) continue;
    if (!determines_position(kMatchTrust * found.information, kKnownM)) continue;
    const Pose2 pose = map.T_world_map() * found.T_map_base;
    if (best && translation_distance(pose, predicted) > options_.loops.small_error_m) continue;
    const Eigen::Matrix3d seen = kMatchTrust * rotate_information(found.information, -found.T_map_base.theta);
    best = RelocalisationCandidate{predicted, pose, place.node, state_.waiting.size() - 1,
                                   edge_information(seen, kLoopWeakM, kLoopWeakRad)};
  }
  return best;
}

bool BoundedAdmission::correct(const GraphSession& session) {
  const RelocalisationCandidate last = state_.candidates.back();
  int votes = 0;
  for (const RelocalisationCandidate& other : state_.candidates) {
    const Pose2 off = last.pose.inverse() * (other.pose * (other.predicted.inverse() * last.predicted));
    votes +=
        std::hypot(off.x, off.y) < options_.loops.agree_m && std::abs(off.theta) < deg_to_rad(options_.loops.agree_deg);
  }
  if (votes < options_.loops.votes) return false;
  const double off = translation_distance(last.pose, last.predicted);
  if (off < options_.loops.small_error_m + options_.loops.most_drift * session.unconfirmed_m()) {
    // As much as the new part of the map may be off: a matter for the graph.
    close_loop_to_candidates(session);
  } else {
    relocalise_after_slip(last, session);
  }
  return true;
}

void BoundedAdmission::relocalise_after_slip(const RelocalisationCandidate& last, const GraphSession& session) {
  // The tracker slipped while it was sure of itself. The map is right; no edge may say otherwise.
  const Pose2 correction = last.pose * last.predicted.inverse();
  for (Keyframe& keyframe : state_.waiting) {
    const MapMatch match = match_map(keyframe, correction * session.predict(keyframe), session);
    decided_.push_back({std::move(keyframe), Decision::kAttach, match});
  }
  decided_.back().confirms_position = true;
  state_.waiting.clear();
  state_.candidates.clear();
  state_.unfit_m = 0.0;
}

void BoundedAdmission::close_loop_to_candidates(const GraphSession& session) {
  for (std::size_t i = 0; i < state_.waiting.size(); ++i) {
    Decision decision{std::move(state_.waiting[i]), Decision::kInsert, {}};
    for (const RelocalisationCandidate& c : state_.candidates) {
      if (c.waiting != i) continue;
      const Pose2 T_from_to = session.poses()[static_cast<std::size_t>(c.node)].inverse() * c.pose;
      decision.recognised.push_back({c.node, -1, T_from_to, c.information, 1.0});
    }
    decided_.push_back(std::move(decision));
  }
  state_.waiting.clear();
  state_.candidates.clear();
}

}  // namespace phasescan
