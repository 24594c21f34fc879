#include "slam/path_covariance.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <set>
#include <utility>

#include "odometry/information.hpp"

namespace phasescan {
namespace {

// What a keyframe is matched with is a map of 16 before it, some of them of other places: an error of its own passes on
// to those after it by 2 / (n + 1), n = 9 taken. So much more is known of a way than its steps one by one tell.
constexpr double kMapShare = 25.0;
// Standard deviations of a step [m], [rad] that come on top of its match, and how large one can be at most: a robot
// does not jump, whatever its scans leave open.
constexpr double kFloorM = 0.002, kFloorRad = 0.0007;
constexpr double kWeakM = 0.2, kWeakRad = 0.1;
constexpr double kBreakM = 3.0, kBreakRad = 3.0;  // of the guess that ties a node to the one before a break
constexpr double kSessionM = 3000.0;              // of the place where a new session is put
// Of tracking that turns too much or too little all the time [rad/m]: half of the worst recorded log.
constexpr double kTurning = 0.00035;
constexpr double kLeverM = 10.0;  // a radian counts for as many metres, when ways are compared: half of a large room

Eigen::Matrix3d step_covariance(const Keyframe& to, bool new_session) {
  if (new_session)
    return Eigen::Vector3d(kSessionM * kSessionM, kSessionM * kSessionM, kBreakRad * kBreakRad).asDiagonal();
  if (to.new_segment) return Eigen::Vector3d(kBreakM * kBreakM, kBreakM * kBreakM, kBreakRad * kBreakRad).asDiagonal();
  const Eigen::Matrix3d weak =
      Eigen::Vector3d(1.0 / (kWeakM * kWeakM), 1.0 / (kWeakM * kWeakM), 1.0 / (kWeakRad * kWeakRad)).asDiagonal();
  Eigen::Matrix3d covariance = (kMapShare * to.information + weak).inverse();
  covariance.diagonal() += Eigen::Vector3d(kFloorM * kFloorM, kFloorM * kFloorM, kFloorRad * kFloorRad);
  return covariance;
}

/// Of the motion that an edge says.
Eigen::Matrix3d edge_covariance(const PoseEdge& edge, const GraphSession& session) {
  const Keyframe& to = session.keyframes()[static_cast<std::size_t>(edge.to)];
  return edge.robust ? Eigen::Matrix3d(edge.information.inverse())
                     : step_covariance(to, session.crosses_sessions(edge));
}

double position_sigma(const Eigen::Matrix3d& covariance) {
  return std::sqrt(std::max(0.0, covariance(0, 0) + covariance(1, 1)));
}

/// What the choice of the way minimises [m^2].
double length_of(const Eigen::Matrix3d& covariance) {
  return covariance(0, 0) + covariance(1, 1) + kLeverM * kLeverM * covariance(2, 2);
}

}  // namespace

void KnownWay::add(const PoseEdge& edge, const Eigen::Matrix3d& covariance, const Pose2& to, bool back) {
  const Eigen::Vector2d at = to.translation();
  single += carry_covariance(rotate_information(covariance, to.theta), -at);
  const double way = edge.robust ? 0.0 : edge.T_from_to.translation().norm();
  turning += (back ? -way : way) * Eigen::Vector3d(at.y(), -at.x(), 1.0);
}

Eigen::Matrix3d KnownWay::at(const Eigen::Vector2d& end) const {
  const Eigen::Vector3d common(turning.x() - end.y() * turning.z(), turning.y() + end.x() * turning.z(), turning.z());
  return carry_covariance(single, end) + kTurning * kTurning * common * common.transpose();
}

void PathCovariance::hang(const PoseEdge& edge, const GraphSession& session) {
  const Node& parent = node(edge.from);
  const Eigen::Matrix3d covariance = edge_covariance(edge, session);
  const double length = parent.length + length_of(covariance);
  Node& n = nodes_[static_cast<std::size_t>(edge.to)];
  if (n.parent >= 0 && length >= n.length) return;
  n.parent = edge.from;
  n.length = length;
  n.sums = parent.sums;
  n.sums.add(edge, covariance, n.pose, false);
}

void PathCovariance::rebuild(const GraphSession& session) {
  nodes_.assign(session.poses().size(), {});
  for (std::size_t k = 0; k < nodes_.size(); ++k) nodes_[k].pose = session.poses()[k];
  std::vector<std::vector<const PoseEdge*>> edges(nodes_.size());
  for (const PoseEdge& edge : session.graph().edges()) {
    if (edge.enabled && edge.from < edge.to) edges[static_cast<std::size_t>(edge.to)].push_back(&edge);
  }
  for (const auto& to_node : edges) {
    for (const PoseEdge* edge : to_node) hang(*edge, session);
  }
  edges_taken_ = session.graph().edges().size();
}

void PathCovariance::append(const GraphSession& session) {
  const auto& edges = session.graph().edges();
  if (nodes_.empty() && session.last_node() >= 0) nodes_.push_back({.pose = session.poses().front()});
  for (; edges_taken_ < edges.size(); ++edges_taken_) {
    const PoseEdge& edge = edges[edges_taken_];
    const auto newest = static_cast<int>(nodes_.size()) - 1;
    if (!edge.enabled || edge.from >= edge.to || edge.to < newest) continue;
    if (edge.to > newest) nodes_.push_back({.pose = session.poses()[static_cast<std::size_t>(edge.to)]});
    hang(edge, session);
  }
}

Eigen::Matrix3d PathCovariance::between(int from, int to) const {
  int a = from, b = to;
  while (a != b) {
    int& later = a > b ? a : b;
    if (node(later).parent < 0) break;  // the first node of all is where every way ends
    later = node(later).parent;
  }
  const Node &start = node(from), &end = node(to), &common = node(a);
  KnownWay way;
  way.single = end.sums.single + start.sums.single - 2.0 * common.sums.single;
  way.turning = end.sums.turning - start.sums.turning;
  return rotate_information(way.at(end.pose.translation()), -end.pose.theta);
}

std::vector<double> position_sigmas(const GraphSession& session, int seen_from) {
  const std::size_t count = session.poses().size();
  std::vector<std::vector<const PoseEdge*>> edges(count);
  for (const PoseEdge& edge : session.graph().edges()) {
    if (!edge.enabled) continue;
    for (const int end : {edge.from, edge.to}) edges[static_cast<std::size_t>(end)].push_back(&edge);
  }
  struct Reached {
    double length = std::numeric_limits<double>::infinity();
    KnownWay sums;
  };
  std::vector<Reached> reached(count);
  std::vector<double> sigmas(count, std::numeric_limits<double>::infinity());
  std::set<std::pair<double, int>> next{{0.0, seen_from}};
  reached[static_cast<std::size_t>(seen_from)].length = 0.0;
  while (!next.empty()) {
    const int here = next.begin()->second;
    next.erase(next.begin());
    const Reached from = reached[static_cast<std::size_t>(here)];
    sigmas[static_cast<std::size_t>(here)] =
        position_sigma(from.sums.at(session.poses()[static_cast<std::size_t>(here)].translation()));
    for (const PoseEdge* edge : edges[static_cast<std::size_t>(here)]) {
      const bool back = edge->to == here;
      const int there = back ? edge->from : edge->to;
      const Eigen::Matrix3d covariance = edge_covariance(*edge, session);
      const double step = length_of(covariance);
      if (!(step >= 0.0)) continue;  // of an edge whose information is none: ways with it would become ever shorter
      const double length = from.length + step;
      Reached& to = reached[static_cast<std::size_t>(there)];
      if (length >= to.length) continue;
      next.erase({to.length, there});
      to = {length, from.sums};
      to.sums.add(*edge, covariance, session.poses()[static_cast<std::size_t>(edge->to)], back);
      next.insert({length, there});
    }
  }
  return sigmas;
}

}  // namespace phasescan
