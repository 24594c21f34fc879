// The part of the backend that keeps the map small: keyframes that show nothing new become no nodes, and those that do
// not fit the map wait until it is known whether the place is new or the tracker has slipped.
#include <algorithm>
#include <cmath>

#include "edge_information.hpp"
#include "odometry/information.hpp"
#include "odometry/registration.hpp"
#include "slam/backend.hpp"

namespace phasescan {
namespace {

// A place is shown well enough when so many keyframes look at it from so near, and a scan there fits so well.
constexpr int kShownKeyframes = 2, kMostKeyframes = 8;
constexpr double kShownM = 0.8, kShownViewM = 1.5, kShownOverlap = 0.7, kShownByOneOverlap = 0.9;
constexpr double kKnownM = 0.1;  // standard deviation of a pose that is known in both directions
constexpr std::size_t kSurroundings = 16;
constexpr std::size_t kMostWaiting = 8;

}  // namespace

Pose2 Backend::guess_of(const Keyframe& keyframe) const {
  const Handed& last = handed_.back();
  return graph_.poses()[static_cast<std::size_t>(last.node)] * last.T_node_keyframe() *
         (T_odom_last_.inverse() * keyframe.T_odom_base);
}

const LocalMap& Backend::surroundings(int node) {
  if (node != surroundings_of_) build_surroundings(node, kSurroundings, surroundings_);
  surroundings_of_ = node;
  return surroundings_;
}

Backend::Sight Backend::look(const Keyframe& keyframe, const Pose2& guess) {
  const auto& poses = graph_.poses();
  const Eigen::Vector2d centre = guess * keyframe.centre;
  Sight sight{0, guess, 0.0};
  int nearest = -1;
  double least = kShownM;
  for (std::size_t k = 0; k < poses.size(); ++k) {
    const double distance = translation_distance(guess, poses[k]);
    // A full turn looks at the same whatever its heading; half of one does not.
    if (distance > kShownM || (poses[k] * keyframes_[k].centre - centre).norm() > kShownViewM) continue;
    ++sight.around;
    if (distance <= least) least = distance, nearest = static_cast<int>(k);
  }
  if (nearest < 0) return sight;
  const LocalMap& map = surroundings(nearest);
  const Registration found = register_points(map, *keyframe.points, map.T_world_map().inverse() * guess);
  const Pose2 pose = map.T_world_map() * found.T_map_base;
  // A match that still trembles by a millimetre after all its steps is as good as one that came to rest.
  if (translation_distance(pose, guess) > options_.loops.small_error_m) return sight;
  sight.overlap = found.overlap;
  if (found.overlap > options_.odometry.min_overlap) sight.pose = pose;
  return sight;
}

void Backend::stand(const Keyframe& keyframe, const Pose2& pose) {
  const auto& poses = graph_.poses();
  const auto nearer = [&pose](const Pose2& a, const Pose2& b) {
    return translation_distance(pose, a) < translation_distance(pose, b);
  };
  const auto nearest = std::min_element(poses.begin(), poses.end(), nearer);
  hand_in(static_cast<int>(nearest - poses.begin()), nearest->inverse() * pose, keyframe.T_odom_base);
}

void Backend::settle(Keyframe keyframe) {
  if (handed_.empty()) return take(std::move(keyframe));
  const Pose2 guess = guess_of(keyframe);
  const Sight sight = look(keyframe, guess);
  if (keyframe.new_segment && since_fit_m_ < kBreakM) since_fit_m_ = kBreakM, sure_nodes_ = keyframes_.size();
  const bool shown = sight.overlap > (sight.around >= kShownKeyframes ? kShownOverlap : kShownByOneOverlap);
  if (since_fit_m_ < kBreakM && shown) {
    // The way here was right: what waits stands where it was thought to.
    settle_waiting();
    stand(keyframe, sight.pose);
    since_loop_m_ = since_fit_m_ = 0.0;
    return;
  }
  const Keyframe& before = waiting_.empty() ? keyframe : waiting_.back();
  since_fit_m_ += translation_distance(before.T_odom_base, keyframe.T_odom_base);
  waiting_.push_back(std::move(keyframe));
  bool known = sight.around > 0;
  if (options_.loops.enabled && options_.loops.places) {
    if (const std::optional<Suspicion> other = recognise(waiting_.back(), guess)) {
      const double off = translation_distance(other->pose, guess);
      if (off < options_.loops.small_error_m) {
        since_fit_m_ = 0.0;
        return settle_waiting();
      }
      suspicions_.push_back(*other);
      // Rooms look alike; but the way here is known too.
      if (off < options_.loops.near_radius_m + options_.loops.most_drift * since_fit_m_ && jump()) return;
    }
    known = known || !suspicions_.empty();
  }
  if (!known || waiting_.size() > kMostWaiting) {
    // It may be another place: what comes now hangs on what was before by no more than a guess, until loops tell.
    if (!suspicions_.empty() && since_fit_m_ < kBreakM) {
      waiting_.front().new_segment = true;
      since_fit_m_ = kBreakM;
      sure_nodes_ = keyframes_.size();
    }
    settle_waiting();
  }
}

void Backend::settle_waiting() {
  suspicions_.clear();
  std::vector<Keyframe> waiting;
  waiting.swap(waiting_);
  for (Keyframe& keyframe : waiting) {
    const Sight sight = look(keyframe, guess_of(keyframe));
    const double enough = sight.around > kMostKeyframes / 2 ? options_.odometry.min_overlap
                          : sight.around >= kShownKeyframes ? kShownOverlap
                                                            : kShownByOneOverlap;
    // Where the place has all the keyframes it may have, a scan that does not fit (people) stands where odometry puts
    // it.
    if (!keyframe.new_segment && (sight.around >= kMostKeyframes || sight.overlap > enough)) {
      stand(keyframe, sight.pose);
    } else {
      take(std::move(keyframe));
      surroundings_of_ = -1;
    }
  }
}

std::optional<Backend::Suspicion> Backend::recognise(const Keyframe& keyframe, const Pose2& guess) {
  std::optional<Suspicion> best;
  // What was added since the tracker was last sure of its place says nothing of that place.
  const std::size_t sure = since_fit_m_ < kBreakM ? keyframes_.size() : sure_nodes_;
  for (const PlaceMatch& place : places_.find(keyframe, keyframes_, graph_.poses(), sure)) {
    const Pose2 there = graph_.poses()[static_cast<std::size_t>(place.node)] * place.T_node_query;
    const LocalMap& map = surroundings(place.node);
    const Registration found = register_points(map, *keyframe.points, map.T_world_map().inverse() * there);
    if (found.overlap < kShownOverlap) continue;
    if (largest_deviation(kMatchTrust * found.information) > kKnownM) continue;
    const Pose2 pose = map.T_world_map() * found.T_map_base;
    if (best && translation_distance(pose, guess) > options_.loops.small_error_m) continue;
    const Eigen::Matrix3d seen = kMatchTrust * rotate_information(found.information, -found.T_map_base.theta);
    best = Suspicion{guess, pose, place.node, waiting_.size() - 1, edge_information(seen, 3.0, 0.5)};
  }
  return best;
}

bool Backend::jump() {
  const Suspicion& last = suspicions_.back();
  int votes = 0;
  for (const Suspicion& other : suspicions_) {
    const Pose2 off = last.pose.inverse() * (other.pose * (other.guess.inverse() * last.guess));
    votes +=
        std::hypot(off.x, off.y) < options_.loops.agree_m && std::abs(off.theta) < deg_to_rad(options_.loops.agree_deg);
  }
  if (votes < options_.loops.votes) return false;
  const double off = translation_distance(last.pose, last.guess);
  if (off < options_.loops.small_error_m + options_.loops.most_drift * since_loop_m_) {
    // As much as the new part of the map may be off: a matter for the graph.
    return join_waiting();
  }
  // The tracker slipped while it was sure of itself. The map is right; no edge may tell it otherwise.
  const Pose2 correction = last.pose * last.guess.inverse();
  std::vector<Pose2> poses;
  for (const Keyframe& keyframe : waiting_) poses.push_back(correction * guess_of(keyframe));
  for (std::size_t i = 0; i < waiting_.size(); ++i) stand(waiting_[i], look(waiting_[i], poses[i]).pose);
  waiting_.clear();
  suspicions_.clear();
  since_loop_m_ = since_fit_m_ = 0.0;
  return true;
}

bool Backend::join_waiting() {
  std::vector<Keyframe> waiting;
  std::vector<Suspicion> suspicions;
  waiting.swap(waiting_);
  suspicions.swap(suspicions_);
  for (std::size_t i = 0; i < waiting.size(); ++i) {
    take(std::move(waiting[i]));
    for (const Suspicion& s : suspicions) {
      if (s.waiting != i) continue;
      const Pose2 T_from_to = graph_.poses()[static_cast<std::size_t>(s.node)].inverse() * s.pose;
      believe({s.node, static_cast<int>(keyframes_.size()) - 1, T_from_to, s.information, 1.0});
    }
  }
  surroundings_of_ = -1;
  return true;
}

}  // namespace phasescan
