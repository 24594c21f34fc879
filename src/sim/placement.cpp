#include "sim/placement.hpp"

#include <algorithm>
#include <cmath>

#include "sim/furniture.hpp"

namespace phasescan::sim {
namespace {

using Eigen::Vector2d;

std::optional<Vector2d> draw_point(const World& world, const RayCaster& caster, double clearance_m, Random& random) {
  constexpr int kTries = 30;
  for (int i = 0; i < kTries; ++i) {
    const Polygon& room = world.rooms[random.below(world.rooms.size())];
    Vector2d low = room[0], high = room[0];
    for (const Vector2d& p : room) {
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
    const Vector2d p(random.uniform(low.x(), high.x()), random.uniform(low.y(), high.y()));
    if (inside_polygon(room, p) && caster.clearance(p, clearance_m) >= clearance_m) return p;
  }
  return {};
}

/// True where the way from p to q crosses one of the doorways.
bool crosses_door(const World& world, const Vector2d& p, const Vector2d& q) {
  const auto side = [](const Vector2d& a, const Vector2d& b, const Vector2d& c) {
    return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x()) > 0.0;
  };
  return std::any_of(world.doors.begin(), world.doors.end(), [&](const Doorway& d) {
    return side(d.a, d.b, p) != side(d.a, d.b, q) && side(p, q, d.a) != side(p, q, d.b);
  });
}

/// A thing at a random direction and distance of a pose, clear of both poses; false if nothing fits.
bool put_near(const RayCaster& caster, const Placement& place, const Pose2& near, double distance_min,
              double distance_max, const Shape& thing, double radius, Shape& loose, Random& random) {
  constexpr int kTries = 20;
  for (int i = 0; i < kTries; ++i) {
    const double angle = random.uniform(-kPi, kPi), distance = random.uniform(distance_min, distance_max);
    const Vector2d at = near.translation() + distance * Vector2d(std::cos(angle), std::sin(angle));
    if ((at - place.T_world_ref.translation()).norm() < radius + 0.3 ||
        (at - place.T_world_scan.translation()).norm() < radius + 0.3)
      continue;
    if (caster.clearance(at, radius) < radius || !caster.line_of_sight(near.translation(), at)) continue;
    loose.append(thing, {at.x(), at.y(), random.uniform(-kPi, kPi)});
    return true;
  }
  return false;
}

/// A box, bag or round thing that somebody moves.
Shape movable(Random& random, double& radius) {
  constexpr ItemKind kinds[] = {ItemKind::kClutter, ItemKind::kOfficeChair, ItemKind::kBin, ItemKind::kCupboard};
  const Item item = make_item(kinds[random.below(4)], random);
  radius = 0.5 * std::hypot(item.width, item.depth);
  return item.shape;
}

double share_on_loose(const RayCaster& caster, const Shape& loose, const LidarOptions& lidar, const Pose2& pose) {
  constexpr int kRays = 180;
  int on_loose = 0, all = 0;
  for (int i = 0; i < kRays; ++i) {
    const double angle =
        pose.theta + deg_to_rad(lidar.angle_min_deg) + lidar.angle_increment() * lidar.beams * i / kRays;
    const Vector2d direction(std::cos(angle), std::sin(angle));
    const RayHit fixed = caster.cast(pose.translation(), direction, lidar.range_max_m);
    const RayHit moved = cast_all(loose, pose.translation(), direction, lidar.range_max_m);
    if (moved.range < fixed.range) ++on_loose;
    if (moved.found() || fixed.found()) ++all;
  }
  return all ? static_cast<double>(on_loose) / all : 0.0;
}

}  // namespace

std::optional<Pose2> draw_pose(const World& world, const RayCaster& caster, double clearance_m, Random& random) {
  const auto p = draw_point(world, caster, clearance_m, random);
  if (!p) return {};
  return Pose2{p->x(), p->y(), random.uniform(-kPi, kPi)};
}

std::optional<Placement> draw_placement(const World& world, const RayCaster& caster, const PairRow& row, PairClass cls,
                                        Random& random) {
  const PairBounds bounds = pair_bounds(cls);
  const auto draw_turn = [&] {
    return random.uniform(bounds.turn_min, bounds.turn_max) * (random.chance(0.5) ? 1.0 : -1.0);
  };
  constexpr int kTries = 40;
  for (int i = 0; i < kTries; ++i) {
    std::optional<Pose2> ref;
    if (row.through_door) {
      if (world.doors.empty()) return {};
      // Around a doorway, so that the way leads through it.
      const Doorway& door = world.doors[random.below(world.doors.size())];
      const Vector2d middle = 0.5 * (door.a + door.b);
      const double reach = random.uniform(0.0, bounds.distance_max), angle = random.uniform(-kPi, kPi);
      ref =
          Pose2{middle.x() + reach * std::cos(angle), middle.y() + reach * std::sin(angle), random.uniform(-kPi, kPi)};
      if (caster.clearance(ref->translation(), row.clearance_m) < row.clearance_m) continue;
    } else {
      ref = draw_pose(world, caster, row.clearance_m, random);
      if (!ref) continue;
    }
    for (int k = 0; k < 4; ++k) {
      const double distance = random.uniform(bounds.distance_min, bounds.distance_max),
                   angle = random.uniform(-kPi, kPi);
      const Vector2d q = ref->translation() + distance * Vector2d(std::cos(angle), std::sin(angle));
      const Pose2 scan{q.x(), q.y(), wrap_angle(ref->theta + draw_turn())};
      if (caster.clearance(q, row.clearance_m) < row.clearance_m || !caster.line_of_sight(ref->translation(), q))
        continue;
      const bool in_room = std::any_of(world.rooms.begin(), world.rooms.end(),
                                       [&](const Polygon& room) { return inside_polygon(room, q); });
      if (!row.through_door && !in_room) continue;
      if (row.through_door && !crosses_door(world, ref->translation(), q)) continue;
      return Placement{*ref, scan};
    }
  }
  return {};
}

void draw_loose(const RayCaster& caster, const PairRow& row, const LidarOptions& lidar, const Placement& place,
                Shape& loose_ref, Shape& loose_scan, Random& random) {
  const Pose2 between{0.5 * (place.T_world_ref.x + place.T_world_scan.x),
                      0.5 * (place.T_world_ref.y + place.T_world_scan.y), 0.0};
  constexpr double kNear_m = 0.5, kFar_m = 3.0;
  const int moved =
      row.moved_min + static_cast<int>(random.below(static_cast<std::uint64_t>(row.moved_max - row.moved_min + 1)));
  for (int i = 0; i < moved; ++i) {
    double radius = 0.0;
    const Shape thing = movable(random, radius);
    // Moved, taken away or brought: in each scan it stands somewhere else, or not at all.
    const double fate = random.uniform();
    if (fate < 0.85) put_near(caster, place, between, kNear_m, kFar_m, thing, radius, loose_ref, random);
    if (fate > 0.15) put_near(caster, place, between, kNear_m, kFar_m, thing, radius, loose_scan, random);
  }
  constexpr double kPersonRadius_m = 0.25;
  for (Shape* loose : {&loose_ref, &loose_scan}) {
    const auto people = random.below(static_cast<std::uint64_t>(row.people_max) + 1);
    for (std::uint64_t i = 0; i < people; ++i) {
      put_near(caster, place, between, kNear_m, kFar_m, make_person(random), kPersonRadius_m, *loose, random);
    }
  }
  if (row.moved_share <= 0.0) return;
  constexpr int kThings = 60;
  for (int side = 0; side < 2; ++side) {
    Shape& loose = side ? loose_scan : loose_ref;
    const Pose2& pose = side ? place.T_world_scan : place.T_world_ref;
    for (int i = 0; i < kThings && share_on_loose(caster, loose, lidar, pose) < row.moved_share; ++i) {
      double radius = 0.15;
      Shape thing;
      if (random.chance(0.4))
        thing = make_person(random);
      else
        thing = movable(random, radius);
      put_near(caster, place, pose, kNear_m, 2.0, thing, radius, loose, random);
    }
  }
}

}  // namespace phasescan::sim
