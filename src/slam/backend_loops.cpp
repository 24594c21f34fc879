// The part of the backend that compares visits of one place.
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "edge_information.hpp"
#include "odometry/information.hpp"
#include "odometry/registration.hpp"
#include "slam/backend.hpp"

namespace phasescan {
namespace {

constexpr double kDriftPerMetre = 0.01;  // how fast the map may drift where no loop holds it
constexpr int kVisitNodes = 6;           // keyframes on either side of a visit's anchor that make its map
constexpr int kAnchorStep = 4;           // anchors are multiples of it, so that neighbours share a map
constexpr std::size_t kCachedMaps = 4;
constexpr double kCorridor = 0.02;  // ratio of information below which a direction counts as unseen
constexpr double kSlideStepM = 0.1;
constexpr int kSlideSteps = 10;
constexpr double kOutOfReachM = 1.0;    // loops farther off than this do not draw the graph by themselves
constexpr double kUntiedOverlap = 0.2;  // more of it than of others is asked of a loop between pieces,
constexpr double kMostAsked = 0.9;      // but never more than a good match of one place has
constexpr double kSlideGain = 0.01;     // of the score, for a slide to be worth it

/// Whether a match holds the pose in every direction to a decimetre: in a bare corridor it does not.
bool holds_both_ways(const Eigen::Matrix3d& information) {
  return largest_deviation(information) < 0.1;
}

/// In a corridor a match stays where it was begun: looks along the direction it cannot see for a place where more fits.
Registration slide_along_corridor(const LocalMap& map, const MapPoints& points, const Registration& found) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen(found.information.topLeftCorner<2, 2>());
  if (eigen.eigenvalues()(0) > kCorridor * eigen.eigenvalues()(1)) return found;
  const Eigen::Vector2d along = eigen.eigenvectors().col(0);
  double best = pose_score(map, points, found.T_map_base) + kSlideGain;
  Pose2 best_pose = found.T_map_base;
  bool moved = false;
  for (int k = 1; k <= kSlideSteps; ++k) {
    for (const double side : {-1.0, 1.0}) {
      const Eigen::Vector2d shift = side * k * kSlideStepM * along;
      const Pose2 pose{found.T_map_base.x + shift.x(), found.T_map_base.y + shift.y(), found.T_map_base.theta};
      const double score = pose_score(map, points, pose);
      if (score > best) best = score, best_pose = pose, moved = true;
    }
  }
  if (!moved) return found;
  const Registration again = register_points(map, points, best_pose);
  return pose_score(map, points, again.T_map_base) > best - kSlideGain ? again : found;
}

}  // namespace

std::vector<int> Backend::nearby_visits(int node, int max_other) const {
  // Runs of keyframes near the node, apart in time; of each run the one that looks most at the same place.
  struct Visit {
    int anchor;
    double far;
  };
  const auto& poses = graph_.poses();
  const Pose2& here = poses[static_cast<std::size_t>(node)];
  const Eigen::Vector2d centre = here * keyframes_[static_cast<std::size_t>(node)].centre;
  const double radius = options_.loops.near_radius_m + std::min(3.0, kDriftPerMetre * since_loop_m_);
  std::vector<Visit> visits;
  int last = -1000;
  for (int k = 0; k <= max_other; ++k) {
    if (std::abs(k - node) < options_.loops.min_nodes_apart && piece_of(k) == piece_of(node)) continue;
    const Pose2& there = poses[static_cast<std::size_t>(k)];
    const double distance = translation_distance(here, there);
    if (distance > radius) continue;
    const double views = (there * keyframes_[static_cast<std::size_t>(k)].centre - centre).norm();
    const double far = distance + 0.5 * views;
    if (k - last > 10) {
      visits.push_back({k, far});
    } else if (far < visits.back().far) {
      visits.back() = {k, far};
    }
    last = k;
  }
  std::stable_sort(visits.begin(), visits.end(), [](const Visit& a, const Visit& b) { return a.far < b.far; });
  std::vector<int> anchors;
  for (const Visit& v : visits) {
    if (anchors.size() >= static_cast<std::size_t>(options_.loops.clusters_per_node)) break;
    anchors.push_back(v.anchor);
  }
  return anchors;
}

const LocalMap& Backend::visit_map(int anchor) {
  for (const auto& [key, map] : map_cache_) {
    if (key == anchor) return *map;
  }
  if (map_cache_.size() < kCachedMaps) {
    map_cache_.emplace_back(anchor, std::make_unique<LocalMap>());
    next_cached_ = map_cache_.size() - 1;
  } else {
    next_cached_ = (next_cached_ + 1) % kCachedMaps;
    map_cache_[next_cached_].first = anchor;
  }
  LocalMap& map = *map_cache_[next_cached_].second;
  const auto& poses = graph_.poses();
  map.reset(poses[static_cast<std::size_t>(anchor)], options_.odometry.map_range_m + 5.0, options_.odometry.cell_m);
  const int last = static_cast<int>(keyframes_.size()) - 1;
  // Where tracking broke the visit ends: how the two sides lie to each other is a guess.
  int from = anchor, to = anchor;
  while (from > std::max(0, anchor - kVisitNodes) && !keyframes_[static_cast<std::size_t>(from)].new_segment) --from;
  while (to < std::min(last, anchor + kVisitNodes) && !keyframes_[static_cast<std::size_t>(to) + 1].new_segment) ++to;
  for (int k = from; k <= to; ++k)
    map.add(*keyframes_[static_cast<std::size_t>(k)].points, poses[static_cast<std::size_t>(k)]);
  map.finish();
  return map;
}

std::optional<Loop> Backend::compare(int other, int node, const Pose2& T_world_node, double uncertainty_m) {
  const int last = static_cast<int>(keyframes_.size()) - 1;
  const int anchor = std::min(last, (other + kAnchorStep / 2) / kAnchorStep * kAnchorStep);
  if (std::abs(anchor - node) <= kVisitNodes) return std::nullopt;
  const LocalMap& map = visit_map(anchor);
  const auto& poses = graph_.poses();
  const MapPoints& points = *keyframes_[static_cast<std::size_t>(node)].points;
  const Pose2 guess = map.T_world_map().inverse() * T_world_node;
  ++counts_.compared;
  Registration found = register_points(map, points, guess);
  if (found.overlap < options_.loops.min_overlap + 0.1 && uncertainty_m > 0.15) {
    LatticeSearch lattice;
    lattice.half_width_m = std::min(1.2, 0.2 + uncertainty_m);
    lattice.step_m = 0.2;
    lattice.half_angle_rad = std::min(0.35, 0.1 + 0.1 * uncertainty_m);
    lattice.step_rad = 0.05;
    const Registration again = register_points(map, points, search_lattice(map, points, guess, lattice));
    if (again.overlap > found.overlap + 0.05) found = again;
  }
  if (found.overlap < options_.loops.min_overlap) return std::nullopt;
  found = slide_along_corridor(map, points, found);
  if (found.overlap < options_.loops.min_overlap || !found.converged) return std::nullopt;
  ++counts_.found;
  Loop loop;
  loop.from = anchor;
  loop.to = node;
  loop.T_from_to = poses[static_cast<std::size_t>(anchor)].inverse() * (map.T_world_map() * found.T_map_base);
  loop.information =
      edge_information(kMatchTrust * rotate_information(found.information, -found.T_map_base.theta), 3.0, 0.5);
  loop.overlap = found.overlap;
  return loop;
}

void Backend::find_loops(int node) {
  const double uncertainty_m = std::min(3.0, kDriftPerMetre * since_loop_m_);
  const bool broke = piece_.size() > 1;  // what was just before may be another piece
  for (const int anchor : nearby_visits(node, broke ? node - 1 : node - options_.loops.min_nodes_apart)) {
    const std::optional<Loop> loop =
        compare(anchor, node, graph_.poses()[static_cast<std::size_t>(node)], uncertainty_m);
    if (loop) believe(*loop);
  }
  if (options_.loops.places) find_places(node);
}

int Backend::piece_of(int node) const {
  int piece = segment_[static_cast<std::size_t>(node)];
  while (piece_[static_cast<std::size_t>(piece)] != piece) piece = piece_[static_cast<std::size_t>(piece)];
  return piece;
}

std::vector<Loop> Backend::judged(LoopJudge& judge, const Loop& loop) {
  const bool tied = piece_of(loop.from) == piece_of(loop.to);
  // Where a piece stands that nothing ties is a guess: a loop that agrees with it is worth no more than another.
  if (!tied && loop.overlap < std::min(kMostAsked, options_.loops.min_overlap + kUntiedOverlap)) {
    ++counts_.outvoted;
    return {};
  }
  std::vector<Loop> believed = judge.add(loop, graph_.poses(), tied ? 0.0 : -options_.loops.small_error_m);
  // Those that waited may tie other pieces than this one.
  for (const Loop& l : believed) {
    const int a = piece_of(l.from), b = piece_of(l.to);
    piece_[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
  }
  return believed;
}

void Backend::believe(const Loop& loop) {
  for (const Loop& l : judged(judge_, loop)) {
    const Pose2 error = graph_.poses()[static_cast<std::size_t>(l.to)].inverse() *
                        (graph_.poses()[static_cast<std::size_t>(l.from)] * l.T_from_to);
    const bool large = std::hypot(error.x, error.y) > options_.loops.small_error_m;
    add_loop_edge(l);
    if (large) {
      large_correction_ = true;
      if (std::hypot(error.x, error.y) > kOutOfReachM)
        large_loops_.push_back(static_cast<int>(graph_.edges().size()) - 1);
    }
    if (holds_both_ways(l.information)) since_loop_m_ = 0.0;
  }
}

void Backend::find_places(int node) {
  const auto here = static_cast<std::size_t>(node);
  const bool search = way_m_[here] - way_of_place_m_ >= options_.loops.places_after_m;
  for (const PlaceMatch& place : places_.add(keyframes_, graph_.poses(), search)) {
    const auto other = static_cast<std::size_t>(place.node);
    const Pose2 T_world_node = graph_.poses()[other] * place.T_node_query;
    // Rooms look alike; but the way between them is known too, and the map is not off by more than that allows.
    const double off = translation_distance(T_world_node, graph_.poses()[here]);
    if (off > options_.loops.near_radius_m && off > options_.loops.most_drift * (way_m_[here] - way_m_[other]))
      continue;
    ++counts_.places;
    const std::optional<Loop> loop = compare(place.node, node, T_world_node, 0.0);
    if (!loop) continue;
    believe(*loop);
    if (off < options_.loops.small_error_m) way_of_place_m_ = way_m_[here];
  }
}

void Backend::add_loop_edge(const Loop& loop) {
  PoseEdge edge;
  edge.from = loop.from;
  edge.to = loop.to;
  edge.T_from_to = loop.T_from_to;
  edge.information = loop.information;
  edge.robust = true;
  graph_.add_edge(edge);
  ++new_edges_;
}

void Backend::rematch_all() {
  const int n = static_cast<int>(keyframes_.size());
  std::vector<Loop> loops;
  LoopJudge judge(options_.loops);
  for (int node = 0; node < n; ++node) {
    for (const int anchor : nearby_visits(node, n - 1)) {
      if (const std::optional<Loop> loop = compare(anchor, node, graph_.poses()[static_cast<std::size_t>(node)], 0.0)) {
        for (const Loop& believed : judged(judge, *loop)) loops.push_back(believed);
      }
    }
  }
  std::vector<char> keep;
  keep.reserve(graph_.edges().size());
  for (const PoseEdge& edge : graph_.edges()) keep.push_back(!edge.robust);
  // A tie to another time that could not be found again stays: it may be all that holds a part of the map.
  std::vector<char> tied(keyframes_.size(), 0);
  for (const Loop& loop : loops) tied[static_cast<std::size_t>(loop.to)] = 1;
  for (std::size_t i = 0; i < keep.size(); ++i) {
    const PoseEdge& edge = graph_.edges()[i];
    if (edge.robust && edge.enabled && !tied[static_cast<std::size_t>(edge.to)]) keep[i] = 1;
  }
  graph_.keep_edges(keep);
  for (const Loop& loop : loops) add_loop_edge(loop);
  optimize(30);
}

}  // namespace phasescan
