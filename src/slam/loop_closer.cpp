#include "slam/loop_closer.hpp"

#include <algorithm>
#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>

#include "odometry/information.hpp"
#include "slam/edge_information.hpp"
#include "slam/visit_match.hpp"

namespace phasescan {
namespace {

constexpr double kDriftPerMetre = 0.01;  // how far the map may drift for each unconfirmed metre
constexpr double kMostDriftM = 3.0;      // what is off by more is found by its looks, not by its pose

// Of what tracking and earlier loops leave open between two nodes, in standard deviations: no loop asks for more. On
// simulated halls, flats and offices right loops ask for less than 3, those of the next shelf or pillar for 7 and more.
constexpr double kMostDriftSigmas = 5.0;
constexpr double kBentM = 0.15, kBentRad = 0.035;  // standard deviations of what the map may be bent by within a visit

// Visits.
constexpr int kAnchorStep = 4;       // anchors are multiples of it, so that neighbours share a map
constexpr int kVisitGapNodes = 10;   // nodes out of reach that part one visit from the next
constexpr double kViewWeight = 0.5;  // of the distance between what two keyframes look at, against that of their poses

// Between pieces that nothing ties yet more overlap is asked, but never more than a good match of one place has.
constexpr double kUntiedOverlap = 0.2, kMostOverlapAsked = 0.9;

// Standard deviations that a loop keeps whatever its match claims to know [m], [rad].
constexpr double kLoopWeakM = 3.0, kLoopWeakRad = 0.5;

double drift_m(const GraphSession& session) {
  return std::min(kMostDriftM, kDriftPerMetre * session.unconfirmed_m());
}

}  // namespace

LoopCloser::LoopCloser(const SlamOptions& options, LoopCloserState state)
    : options_(options.loops),
      state_(std::move(state)),
      consistency_(options.loops, std::move(state_.consistency)),
      visit_maps_(options.odometry) {}

LoopCloserState LoopCloser::state() const {
  LoopCloserState state = state_;
  state.consistency = consistency_.state();
  return state;
}

std::vector<int> LoopCloser::nearby_visits(int node, int max_other, const GraphSession& session,
                                           const Connectivity& connectivity) const {
  // Runs of nodes near this one, apart in time; of each run the one that looks most at the same place.
  struct Visit {
    int anchor;
    double far;
  };
  const auto& poses = session.poses();
  const auto& keyframes = session.keyframes();
  const Pose2& here = poses[static_cast<std::size_t>(node)];
  const Eigen::Vector2d centre = here * keyframes[static_cast<std::size_t>(node)].centre;
  const double radius = options_.near_radius_m + drift_m(session);
  std::vector<Visit> visits;
  int last = -1000;
  for (int k = 0; k <= max_other; ++k) {
    if (std::abs(k - node) < options_.min_nodes_apart && connectivity.tied(k, node)) continue;
    const Pose2& there = poses[static_cast<std::size_t>(k)];
    const double distance = translation_distance(here, there);
    if (distance > radius) continue;
    const double views = (there * keyframes[static_cast<std::size_t>(k)].centre - centre).norm();
    const double far = distance + kViewWeight * views;
    if (k - last > kVisitGapNodes) {
      visits.push_back({k, far});
    } else if (far < visits.back().far) {
      visits.back() = {k, far};
    }
    last = k;
  }
  std::stable_sort(visits.begin(), visits.end(), [](const Visit& a, const Visit& b) { return a.far < b.far; });
  std::vector<int> anchors;
  for (const Visit& v : visits) {
    if (anchors.size() >= static_cast<std::size_t>(options_.clusters_per_node)) break;
    anchors.push_back(v.anchor);
  }
  return anchors;
}

std::optional<Loop> LoopCloser::compare(int other, int node, const Pose2& T_map_node, double uncertainty_m,
                                        const GraphSession& session) {
  const int anchor = std::min(session.last_node(), (other + kAnchorStep / 2) / kAnchorStep * kAnchorStep);
  if (std::abs(anchor - node) <= kVisitNodes) return std::nullopt;
  const LocalMap& map = visit_maps_.around(anchor, session);
  ++state_.compared;
  session.keyframes()[static_cast<std::size_t>(node)].points->unpack(points_);
  const std::optional<Registration> found =
      match_visit(map, points_, map.T_world_map().inverse() * T_map_node, uncertainty_m, options_.min_overlap);
  if (!found) return std::nullopt;
  ++state_.found;
  Loop loop;
  loop.from = anchor;
  loop.to = node;
  loop.T_from_to =
      session.poses()[static_cast<std::size_t>(anchor)].inverse() * (map.T_world_map() * found->T_map_base);
  loop.information = edge_information(kMatchTrust * rotate_information(found->information, -found->T_map_base.theta),
                                      kLoopWeakM, kLoopWeakRad);
  loop.overlap = found->overlap;
  return loop;
}

std::vector<Loop> LoopCloser::search(int node, const GraphSession& session, PlaceSearch& places,
                                     Connectivity& connectivity) {
  std::vector<Loop> accepted;
  covariance_.append(session);
  const double uncertainty_m = drift_m(session);
  const bool broke = connectivity.segments() > 1;  // what was just before may be another piece
  const int newest = broke ? node - 1 : node - options_.min_nodes_apart;
  for (const int visit : nearby_visits(node, newest, session, connectivity)) {
    const std::optional<Loop> loop =
        compare(visit, node, session.poses()[static_cast<std::size_t>(node)], uncertainty_m, session);
    if (!loop) continue;
    for (const Loop& l : submit(*loop, session, connectivity)) accepted.push_back(l);
  }
  if (options_.places) search_places(node, session, places, connectivity, accepted);
  return accepted;
}

void LoopCloser::search_places(int node, const GraphSession& session, PlaceSearch& places, Connectivity& connectivity,
                               std::vector<Loop>& accepted) {
  const auto& poses = session.poses();
  const double here_m = session.travelled_m(node);
  const bool search = here_m - state_.travelled_at_place_m >= options_.places_after_m;
  std::vector<Loop> found;
  bool as_mapped = false;
  for (const PlaceMatch& place : places.add(session.keyframes(), poses, search)) {
    const Pose2 T_map_node = poses[static_cast<std::size_t>(place.node)] * place.T_node_query;
    // Rooms look alike; but the way between them is known too, and the map is not off by more than that allows.
    const double off = translation_distance(T_map_node, poses[static_cast<std::size_t>(node)]);
    if (off > options_.near_radius_m && off > options_.most_drift * (here_m - session.travelled_m(place.node)))
      continue;
    ++state_.places;
    const std::optional<Loop> loop = compare(place.node, node, T_map_node, 0.0, session);
    if (!loop) continue;
    found.push_back(*loop);
    as_mapped = as_mapped || off < options_.small_error_m;
  }
  if (as_mapped) state_.travelled_at_place_m = here_m;
  if (!as_mapped && one_of_several(found, poses)) {
    doubt(node, state_.alike, found.size());
    return;
  }
  for (const Loop& loop : found) {
    for (const Loop& l : submit(loop, session, connectivity)) accepted.push_back(l);
  }
}

void LoopCloser::doubt(int node, std::size_t& count, std::size_t loops) {
  count += loops;
  if (state_.doubted < 0) state_.doubted = node;
}

bool LoopCloser::one_of_several(const std::vector<Loop>& found, const std::vector<Pose2>& poses) const {
  for (const Loop& loop : found) {
    const Pose2 one = poses[static_cast<std::size_t>(found.front().from)] * found.front().T_from_to;
    const Pose2 other = poses[static_cast<std::size_t>(loop.from)] * loop.T_from_to;
    if (translation_distance(one, other) > options_.near_radius_m) return true;
  }
  return false;
}

bool LoopCloser::within_drift(const Loop& loop, const GraphSession& session) const {
  const Pose2 off = asked_correction(loop, session.poses());
  const Eigen::Vector3d error(off.x, off.y, off.theta);
  Eigen::Matrix3d known = covariance_.between(loop.from, loop.to) + loop.information.inverse();
  known.diagonal() += Eigen::Vector3d(kBentM * kBentM, kBentM * kBentM, kBentRad * kBentRad);
  const double chi2 = error.dot(known.llt().solve(error));
  return chi2 <= kMostDriftSigmas * kMostDriftSigmas;
}

std::vector<Loop> LoopCloser::submit(const Loop& loop, const GraphSession& session, Connectivity& connectivity) {
  return accept(consistency_, loop, session, connectivity);
}

std::vector<Loop> LoopCloser::accept(LoopConsistency& consistency, const Loop& loop, const GraphSession& session,
                                     Connectivity& connectivity) {
  const bool tied = connectivity.tied(loop.from, loop.to);
  if (!tied && loop.overlap < std::min(kMostOverlapAsked, options_.min_overlap + kUntiedOverlap)) {
    ++state_.weak;
    return {};
  }
  if (!within_drift(loop, session)) {
    doubt(loop.to, state_.beyond, 1);
    return {};
  }
  std::vector<Loop> accepted =
      consistency.add(loop, session.poses(), tied ? SmallLoops::kAccepted : SmallLoops::kMustBeAgreedOn);
  // Those that waited may tie other pieces than this one.
  for (const Loop& l : accepted) connectivity.tie(l.from, l.to);
  return accepted;
}

std::vector<Loop> LoopCloser::search_before(int node, int limit, bool by_looks, LoopConsistency& consistency,
                                            const GraphSession& session, PlaceSearch& places,
                                            Connectivity& connectivity) {
  const auto& poses = session.poses();
  const Pose2& here = poses[static_cast<std::size_t>(node)];
  std::vector<Loop> found, by_place;
  for (const int visit : nearby_visits(node, limit - 1, session, connectivity)) {
    if (const std::optional<Loop> loop = compare(visit, node, here, 0.0, session)) found.push_back(*loop);
  }
  if (by_looks) {
    for (const PlaceMatch& place :
         places.find_again(node, session.keyframes(), poses, static_cast<std::size_t>(limit))) {
      ++state_.places;
      const Pose2 T_map_node = poses[static_cast<std::size_t>(place.node)] * place.T_node_query;
      if (const std::optional<Loop> loop = compare(place.node, node, T_map_node, 0.0, session))
        by_place.push_back(*loop);
    }
  }
  if (one_of_several(by_place, poses)) {
    doubt(node, state_.alike, by_place.size());
    by_place.clear();
  }
  found.insert(found.end(), by_place.begin(), by_place.end());
  std::vector<Loop> accepted;
  for (const Loop& loop : found) {
    for (const Loop& l : accept(consistency, loop, session, connectivity)) accepted.push_back(l);
  }
  return accepted;
}

void LoopCloser::append(const LoopCloserState& other, int first) {
  state_.compared += other.compared;
  state_.places += other.places;
  state_.found += other.found;
  state_.weak += other.weak + other.consistency.rejected + other.consistency.waiting.size();
  state_.beyond += other.beyond;
  state_.alike += other.alike;
  if (state_.doubted < 0 && other.doubted >= 0) state_.doubted = other.doubted + first;
}

std::vector<Loop> LoopCloser::search_all(const GraphSession& session, Connectivity& connectivity) {
  std::vector<Loop> loops;
  covariance_.rebuild(session);
  LoopConsistency consistency(options_);
  for (int node = 0; node <= session.last_node(); ++node) {
    for (const int visit : nearby_visits(node, session.last_node(), session, connectivity)) {
      const std::optional<Loop> loop =
          compare(visit, node, session.poses()[static_cast<std::size_t>(node)], 0.0, session);
      if (!loop) continue;
      for (const Loop& l : accept(consistency, *loop, session, connectivity)) loops.push_back(l);
    }
  }
  return loops;
}

}  // namespace phasescan
