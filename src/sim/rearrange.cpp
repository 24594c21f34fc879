#include "sim/rearrange.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/random.hpp"

namespace phasescan::sim {
namespace {

using Eigen::Vector2d;

constexpr double kTakenAway = 0.25;             // share of what does not stay where it is
constexpr double kShut = 0.3;                   // share of the leaves that turn
constexpr double kLeastM = 0.3, kMostM = 2.0;   // that a thing is moved by
constexpr double kClearM = 0.05, kDoorM = 0.8;  // that it keeps from other things, from doorways
constexpr double kTurnRad = 0.4;                // by which it is turned, standard deviation

Shape shape_of(const Shape& all, const MovablePart& part) {
  Shape shape;
  const auto copy = [](const auto& from, std::size_t first, std::size_t last, auto& to) {
    to.assign(from.begin() + static_cast<std::ptrdiff_t>(first), from.begin() + static_cast<std::ptrdiff_t>(last));
  };
  copy(all.segments, part.first_segment, part.last_segment, shape.segments);
  copy(all.discs, part.first_disc, part.last_disc, shape.discs);
  copy(all.solids, part.first_solid, part.last_solid, shape.solids);
  return shape;
}

/// The shape without the parts that are marked.
Shape without(const World& world, const std::vector<char>& moved) {
  const Shape& all = world.shape;
  std::vector<char> segments(all.segments.size(), 0), discs(all.discs.size(), 0), solids(all.solids.size(), 0);
  for (std::size_t i = 0; i < moved.size(); ++i) {
    if (!moved[i]) continue;
    const MovablePart& part = world.parts[i];
    std::fill(segments.begin() + static_cast<std::ptrdiff_t>(part.first_segment),
              segments.begin() + static_cast<std::ptrdiff_t>(part.last_segment), char{1});
    std::fill(discs.begin() + static_cast<std::ptrdiff_t>(part.first_disc),
              discs.begin() + static_cast<std::ptrdiff_t>(part.last_disc), char{1});
    std::fill(solids.begin() + static_cast<std::ptrdiff_t>(part.first_solid),
              solids.begin() + static_cast<std::ptrdiff_t>(part.last_solid), char{1});
  }
  Shape rest;
  for (std::size_t i = 0; i < segments.size(); ++i)
    if (!segments[i]) rest.segments.push_back(all.segments[i]);
  for (std::size_t i = 0; i < discs.size(); ++i)
    if (!discs[i]) rest.discs.push_back(all.discs[i]);
  for (std::size_t i = 0; i < solids.size(); ++i)
    if (!solids[i]) rest.solids.push_back(all.solids[i]);
  return rest;
}

/// Corners and middles of a thing.
std::vector<Vector2d> points_of(const Shape& thing) {
  std::vector<Vector2d> points;
  for (const Segment& s : thing.segments) points.insert(points.end(), {s.a, s.b, 0.5 * (s.a + s.b)});
  for (const Disc& d : thing.discs) points.push_back(d.center);
  return points;
}

Vector2d middle_of(const std::vector<Vector2d>& points) {
  Vector2d sum = Vector2d::Zero();
  for (const Vector2d& p : points) sum += p;
  return sum / static_cast<double>(points.size());
}

/// Rotation about a point, then a shift.
Pose2 turn_about(const Vector2d& center, double angle, const Vector2d& shift) {
  const Vector2d moved = center + shift - Pose2{0, 0, angle} * center;
  return {moved.x(), moved.y(), angle};
}

/// Another place in the room it is in; none where it does not fit.
std::optional<Pose2> new_place(const World& world, const Shape& rest, const Shape& thing, Random& random) {
  const std::vector<Vector2d> points = points_of(thing);
  const Vector2d middle = middle_of(points);
  const auto room = std::find_if(world.rooms.begin(), world.rooms.end(),
                                 [&](const Polygon& outline) { return inside_polygon(outline, middle); });
  if (room == world.rooms.end()) return {};
  constexpr int kTries = 12;
  for (int i = 0; i < kTries; ++i) {
    const double direction = random.uniform(-kPi, kPi), way = random.uniform(kLeastM, kMostM);
    const Pose2 T =
        turn_about(middle, random.normal(0.0, kTurnRad), way * Vector2d(std::cos(direction), std::sin(direction)));
    const bool fits = std::all_of(points.begin(), points.end(), [&](const Vector2d& point) {
      const Vector2d p = T * point;
      const bool at_door = std::any_of(world.doors.begin(), world.doors.end(), [&](const Doorway& door) {
        return point_segment_distance(p, door.a, door.b) < kDoorM;
      });
      return inside_polygon(*room, p) && !at_door && rest.clearance(p) > kClearM;
    });
    if (fits) return T;
  }
  return {};
}

/// A leaf opened by another angle, or shut; a leaf that was shut is opened wide: nothing of it is left.
void move_leaf(const Shape& leaf, Shape& shape, Random& random) {
  if (leaf.solids.empty()) return;
  const Polygon& outline = leaf.solids.front();
  const Vector2d hinge = 0.5 * (outline[0] + outline[3]);
  const double angle = (random.chance(0.5) ? 1.0 : -1.0) * random.uniform(0.4, 1.3);
  shape.append(leaf, turn_about(hinge, angle, {0.0, 0.0}));
}

}  // namespace

World rearrange(const World& world, const RearrangeOptions& options, std::uint64_t seed) {
  Random random(seed);
  World later = world;
  std::vector<char> moved(world.parts.size(), 0);
  for (std::size_t i = 0; i < moved.size(); ++i)
    moved[i] = random.chance(world.parts[i].kind == MovablePart::Kind::kDoorLeaf ? options.doors_share
                                                                                 : options.furniture_share);
  later.shape = without(world, moved);
  later.parts.clear();
  for (std::size_t i = 0; i < moved.size(); ++i) {
    if (!moved[i]) continue;
    const Shape thing = shape_of(world.shape, world.parts[i]);
    if (world.parts[i].kind == MovablePart::Kind::kDoorLeaf) {
      move_leaf(thing, later.shape, random);
    } else if (!random.chance(kTakenAway) && !thing.empty()) {
      if (const auto T = new_place(world, later.shape, thing, random)) later.shape.append(thing, *T);
    }
  }
  for (std::size_t i = 0; i < later.doors.size();) {
    const Doorway door = later.doors[i];
    if (!random.chance(kShut * options.doors_share)) {
      ++i;
      continue;
    }
    later.shape.add_line({door.a, door.b});
    later.doors.erase(later.doors.begin() + static_cast<std::ptrdiff_t>(i));
  }
  return later;
}

}  // namespace phasescan::sim
