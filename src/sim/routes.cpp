#include "sim/routes.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "sim/ray_caster.hpp"
#include "sim/placement.hpp"

namespace phasescan::sim {
namespace {

using Eigen::Vector2d;

/// A point of a room that can be reached; none after many tries.
std::optional<Vector2d> reachable_point(const Polygon& room, const FreeSpace::Distances& distances, Random& random) {
  Vector2d low = room[0], high = room[0];
  for (const Vector2d& p : room) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  constexpr int kTries = 100;
  for (int i = 0; i < kTries; ++i) {
    const Vector2d p(random.uniform(low.x(), high.x()), random.uniform(low.y(), high.y()));
    if (inside_polygon(room, p) && std::isfinite(distances.at(p))) return p;
  }
  return {};
}

}  // namespace

TourPlanner::TourPlanner(const World& world, double clearance_m, Random& random)
    : world_(world), space_(world), clearance_m_(clearance_m) {
  // Of a few starts the one from which most rooms can be reached: some rooms are closed.
  constexpr int kStarts = 6;
  const RayCaster caster(world.shape);
  std::size_t best = 0;
  for (int i = 0; i < kStarts; ++i) {
    const auto start = draw_pose(world, caster, clearance_m + 0.05, random);
    if (!start) continue;
    const FreeSpace::Distances distances = space_.distances_from(start->translation(), clearance_m);
    std::size_t reached = 0;
    for (const Polygon& room : world.rooms) reached += reachable_point(room, distances, random) ? 1 : 0;
    if (reached > best) {
      best = reached;
      start_ = start->translation();
      from_start_ = distances;
    }
    if (best == world.rooms.size()) break;
  }
  if (best == 0) throw std::invalid_argument("world " + world.name + ": no free place to drive in");
}

std::vector<Vector2d> TourPlanner::next_round(Random& random) const {
  std::vector<Vector2d> goals;
  for (const Polygon& room : world_.rooms) {
    // One goal a room, more in large ones.
    Vector2d low = room[0], high = room[0];
    for (const Vector2d& p : room) {
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
    constexpr double kAreaPerGoal_m2 = 25.0;
    const int count = 1 + std::min(8, static_cast<int>((high - low).prod() / kAreaPerGoal_m2));
    for (int i = 0; i < count; ++i) {
      if (const auto goal = reachable_point(room, from_start_, random)) goals.push_back(*goal);
    }
  }
  std::vector<Vector2d> round{start_};
  const auto drive_to = [&](const FreeSpace::Distances& from, const Vector2d& goal) {
    const auto legs = space_.way(from, goal, clearance_m_);
    if (legs) round.insert(round.end(), legs->begin() + 1, legs->end());
  };
  FreeSpace::Distances here = from_start_;
  while (!goals.empty()) {
    const auto nearest = std::min_element(
        goals.begin(), goals.end(), [&](const Vector2d& a, const Vector2d& b) { return here.at(a) < here.at(b); });
    drive_to(here, *nearest);
    here = space_.distances_from(round.back(), clearance_m_);
    goals.erase(nearest);
  }
  drive_to(here, start_);
  if (round.size() < 2) throw std::invalid_argument("world " + world_.name + ": nowhere to drive to");
  return round;
}

Vector2d find_point(const World& world, double clearance_m, Random& random) {
  const auto pose = draw_pose(world, RayCaster(world.shape), clearance_m, random);
  if (!pose) throw std::invalid_argument("world " + world.name + ": no free place to stand in");
  return pose->translation();
}

Pose2 find_circle(const World& world, double radius_m, double clearance_m, Random& random) {
  const RayCaster caster(world.shape);
  constexpr int kTries = 400, kPoints = 36;
  for (int i = 0; i < kTries; ++i) {
    const auto pose = draw_pose(world, caster, clearance_m, random);
    if (!pose) continue;
    bool free = true;
    for (int k = 1; k < kPoints && free; ++k) {
      const Pose2 on = *pose * exp_twist({radius_m * kTwoPi, 0.0, kTwoPi}, static_cast<double>(k) / kPoints);
      free = caster.clearance(on.translation(), clearance_m) >= clearance_m &&
             caster.line_of_sight(pose->translation(), on.translation());
    }
    if (free) return *pose;
  }
  throw std::invalid_argument("world " + world.name + ": no room for a circle of " +
                              std::to_string(std::abs(radius_m)) + " m radius");
}

std::pair<Vector2d, Vector2d> find_line(const World& world, double clearance_m, Random& random) {
  const RayCaster caster(world.shape);
  constexpr int kTries = 300;
  constexpr double kLongest_m = 6.0, kShortest_m = 0.3, kStep_m = 0.05;
  std::pair<Vector2d, Vector2d> best{Vector2d::Zero(), Vector2d::Zero()};
  for (int i = 0; i < kTries; ++i) {
    const auto pose = draw_pose(world, caster, clearance_m, random);
    if (!pose) continue;
    const Vector2d direction(std::cos(pose->theta), std::sin(pose->theta));
    double length = 0.0;
    while (length < kLongest_m &&
           caster.clearance(pose->translation() + (length + kStep_m) * direction, clearance_m) >= clearance_m)
      length += kStep_m;
    if (length > (best.second - best.first).norm())
      best = {pose->translation(), pose->translation() + length * direction};
  }
  if ((best.second - best.first).norm() < kShortest_m)
    throw std::invalid_argument("world " + world.name + ": no free line to drive along");
  return best;
}

}  // namespace phasescan::sim
