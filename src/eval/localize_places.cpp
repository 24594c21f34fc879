#include "eval/localize_places.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "eval/statistics.hpp"
#include "eval/trajectory_error.hpp"
#include "phasescan/slam/slam.hpp"
#include "sim/drive.hpp"
#include "sim/furniture.hpp"
#include "sim/pairs_spec.hpp"
#include "sim/path.hpp"
#include "sim/placement.hpp"
#include "sim/ray_caster.hpp"
#include "sim/rearrange.hpp"
#include "sim/world_file.hpp"

namespace phasescan {

bool stands_on_map(const TrinaryMap& map, const Pose2& T_map_base) {
  const Eigen::Vector2d p = map.origin.inverse() * T_map_base.translation() / map.resolution_m;
  const auto i = static_cast<int>(std::floor(p.x())), k = static_cast<int>(std::floor(p.y()));
  return i >= 0 && k >= 0 && i < map.width && k < map.height && map.at(i, k) == CellState::kFree;
}

std::vector<std::size_t> wipe_rooms(double share, std::uint64_t seed, MappedWorld& mapped) {
  constexpr double kWallM = 0.2;
  Random random(seed);
  std::vector<std::size_t> wiped;
  for (std::size_t r = 0; r < mapped.world.rooms.size(); ++r) {
    if (random.chance(share)) wiped.push_back(r);
  }
  TrinaryMap& map = mapped.map;
  const Pose2 T_world_grid = mapped.T_map_world.inverse() * map.origin;
  for (const std::size_t r : wiped) {
    const sim::Polygon& room = mapped.world.rooms[r];
    for (int k = 0; k < map.height; ++k) {
      for (int i = 0; i < map.width; ++i) {
        const Eigen::Vector2d p =
            T_world_grid * Eigen::Vector2d((i + 0.5) * map.resolution_m, (k + 0.5) * map.resolution_m);
        bool in = sim::inside_polygon(room, p);
        for (std::size_t a = 0; !in && a < room.size(); ++a)
          in = sim::point_segment_distance(p, room[a], room[(a + 1) % room.size()]) < kWallM;
        if (in)
          map.cells[static_cast<std::size_t>(k) * static_cast<std::size_t>(map.width) + static_cast<std::size_t>(i)] =
              CellState::kUnknown;
      }
    }
  }
  return wiped;
}

MappedWorld map_world(const std::string& name, const sim::LidarOptions& lidar, std::uint64_t seed) {
  MappedWorld mapped{sim::world_by_name(name, seed), {}, {}};
  sim::PathOptions path;
  sim::Drive drive(mapped.world, lidar, sim::Path(mapped.world, path, Random::derive(seed, 1)), {},
                   Random::derive(seed, 2));
  Slam slam;
  std::vector<Pose2> truth;
  while (auto scan = drive.next()) {
    truth.push_back(scan->T_world_laser);
    slam.add(to_measurement(std::move(scan->entry)));
  }
  const SlamResult result = slam.finish();
  mapped.map = result.map;
  AssociatedPoses poses;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    if (!result.scans[i].on_map || result.scans[i].left_out) continue;
    poses.estimate.push_back(result.scans[i].T_map_base);
    poses.reference.push_back(truth[i]);
  }
  const Pose2 T_world_map = align_se2(poses);
  mapped.T_map_world = T_world_map.inverse();
  std::vector<double> errors;
  for (std::size_t i = 0; i < poses.estimate.size(); ++i)
    errors.push_back(translation_distance(T_world_map * poses.estimate[i], poses.reference[i]));
  mapped.error_m = quantile(errors, 0.95);
  return mapped;
}

namespace {

constexpr int kMarginCells = 20;  // between maps that lie side by side
constexpr double kWiped = 0.3;    // share of the rooms that are wiped from the map where that is asked for

/// Pastes a map to the right of another; gives where its frame lies in that one's.
Pose2 paste(const TrinaryMap& added, TrinaryMap& all) {
  if (all.cells.empty()) {
    all = added;
    return {};
  }
  TrinaryMap wide;
  wide.resolution_m = all.resolution_m;
  wide.origin = all.origin;
  wide.width = all.width + kMarginCells + added.width;
  wide.height = std::max(all.height, added.height);
  wide.cells.assign(static_cast<std::size_t>(wide.width) * static_cast<std::size_t>(wide.height), CellState::kUnknown);
  const auto copy = [&wide](const TrinaryMap& from, int column) {
    for (int k = 0; k < from.height; ++k) {
      for (int i = 0; i < from.width; ++i)
        wide.cells[static_cast<std::size_t>(k) * static_cast<std::size_t>(wide.width) +
                   static_cast<std::size_t>(column + i)] = from.at(i, k);
    }
  };
  copy(all, 0);
  const int column = all.width + kMarginCells;
  copy(added, column);
  all = std::move(wide);
  return all.origin * Pose2{column * all.resolution_m, 0.0, 0.0} * added.origin.inverse();
}

/// The largest part of the free cells that hangs together.
std::vector<std::size_t> largest_free_area(const TrinaryMap& map) {
  std::vector<char> seen(map.cells.size(), 0);
  std::vector<std::size_t> best;
  const auto width = static_cast<std::size_t>(map.width);
  for (std::size_t start = 0; start < map.cells.size(); ++start) {
    if (seen[start] || map.cells[start] != CellState::kFree) continue;
    std::vector<std::size_t> area{start};
    seen[start] = 1;
    for (std::size_t at = 0; at < area.size(); ++at) {
      const std::size_t cell = area[at], column = cell % width;
      const auto visit = [&](bool inside, std::size_t next) {
        if (!inside || seen[next] || map.cells[next] != CellState::kFree) return;
        seen[next] = 1;
        area.push_back(next);
      };
      visit(column > 0, cell - 1);
      visit(column + 1 < width, cell + 1);
      visit(cell >= width, cell - width);
      visit(cell + width < map.cells.size(), cell + width);
    }
    if (area.size() > best.size()) best = std::move(area);
  }
  return best;
}

double clearance_at(const TrinaryMap& map, std::size_t cell, double limit_m) {
  const int reach = static_cast<int>(std::ceil(limit_m / map.resolution_m));
  const int i = static_cast<int>(cell % static_cast<std::size_t>(map.width)),
            k = static_cast<int>(cell / static_cast<std::size_t>(map.width));
  double nearest = limit_m;
  for (int b = std::max(0, k - reach); b <= std::min(map.height - 1, k + reach); ++b) {
    for (int a = std::max(0, i - reach); a <= std::min(map.width - 1, i + reach); ++a) {
      if (map.at(a, b) == CellState::kOccupied)
        nearest = std::min(nearest, std::hypot(a - i, b - k) * map.resolution_m);
    }
  }
  return nearest;
}

/// Where a ray leaves the map's free and unknown cells, by small steps; 0 within range.
float cast_cells(const TrinaryMap& map, const Pose2& T_grid_laser, double angle, double range) {
  const double c = std::cos(T_grid_laser.theta + angle), s = std::sin(T_grid_laser.theta + angle);
  const double step = 0.2 * map.resolution_m;
  for (double r = 0.0; r < range; r += step) {
    const double x = (T_grid_laser.x + r * c) / map.resolution_m, y = (T_grid_laser.y + r * s) / map.resolution_m;
    if (!(x >= 0.0 && y >= 0.0 && x < map.width && y < map.height)) return 0.0F;
    if (map.at(static_cast<int>(x), static_cast<int>(y)) == CellState::kOccupied) return static_cast<float>(r);
  }
  return 0.0F;
}

/// People at random places around a pose, not in or behind walls.
sim::Shape people_around(const sim::RayCaster& caster, const Pose2& pose, int most, Random& random) {
  constexpr double kNearM = 0.6, kFarM = 4.0, kRoomM = 0.3;
  sim::Shape people;
  const auto count = random.below(static_cast<std::uint64_t>(most) + 1);
  for (std::uint64_t n = 0, tries = 0; n < count && tries < 20 * count; ++tries) {
    const double direction = random.uniform(-kPi, kPi), range = random.uniform(kNearM, kFarM);
    const Eigen::Vector2d at = pose.translation() + range * Eigen::Vector2d(std::cos(direction), std::sin(direction));
    if (caster.clearance(at, kRoomM) < kRoomM || !caster.line_of_sight(pose.translation(), at)) continue;
    people.append(sim::make_person(random), {at.x(), at.y(), random.uniform(-kPi, kPi)});
    ++n;
  }
  return people;
}

struct ScansSpec {
  const SimulatedPlacesSpec& places;
  const sim::LidarOptions& lidar;
  std::size_t count = 0;
  std::uint64_t seed = 0;
};

/// Scans at random places of a world that is part of the map.
void add_scans(const MappedWorld& mapped, const std::vector<std::size_t>& wiped, const Pose2& T_map_world,
               const ScansSpec& spec, LocalizePlaces& places) {
  const sim::RayCaster caster(mapped.world.shape);
  Random random(spec.seed);
  const auto unmapped = static_cast<std::size_t>(spec.places.unmapped * static_cast<double>(spec.count));
  std::size_t on_map = 0, off_map = 0;
  const std::size_t most_tries = 40 * spec.count;
  for (std::size_t tries = 0; on_map + off_map < spec.count && tries < most_tries; ++tries) {
    const auto pose = sim::draw_pose(mapped.world, caster, spec.places.clearance_m, random);
    if (!pose) break;
    const bool in_wiped = std::any_of(wiped.begin(), wiped.end(), [&](std::size_t r) {
      return sim::inside_polygon(mapped.world.rooms[r], pose->translation());
    });
    if (!in_wiped && !stands_on_map(places.map, T_map_world * *pose)) continue;
    if (in_wiped ? off_map >= unmapped : on_map >= spec.count - unmapped) continue;
    ++(in_wiped ? off_map : on_map);
    const sim::Shape people = people_around(caster, *pose, spec.places.people, random);
    LocalizeCase one;
    one.measurement.scan = sim::simulate_scan({&caster, &people}, spec.lidar, *pose, random);
    one.T_map_base = T_map_world * *pose;
    one.mapped = !in_wiped;
    places.cases.push_back(std::move(one));
  }
}

}  // namespace

LocalizePlaces simulated_places(const SimulatedPlacesSpec& spec, const std::function<void()>& progress) {
  LocalizePlaces places;
  const sim::LidarOptions lidar = sim::read_lidar(spec.sensor);
  std::uint64_t number = 0;
  for (const std::string& name : spec.worlds) {
    const std::uint64_t seed = Random::derive(spec.seed, ++number);
    MappedWorld mapped = map_world(name, lidar, seed);
    const std::vector<std::size_t> wiped =
        spec.unmapped > 0.0 ? wipe_rooms(kWiped, Random::derive(seed, 4), mapped) : std::vector<std::size_t>{};
    if (spec.moved > 0.0)
      mapped.world = sim::rearrange(mapped.world, {spec.moved, spec.moved}, Random::derive(seed, 5));
    const Pose2 T_map_world = paste(mapped.map, places.map) * mapped.T_map_world;
    add_scans(mapped, wiped, T_map_world, {spec, lidar, spec.poses / spec.worlds.size(), Random::derive(seed, 3)},
              places);
    places.name += (places.name.empty() ? "" : "+") + name;
    progress();
  }
  return places;
}

LocalizePlaces cast_places(const std::string& name, const TrinaryMap& map, const CastPlacesSpec& spec) {
  LocalizePlaces places{name, map, {}};
  const std::vector<std::size_t> area = largest_free_area(map);
  if (area.empty()) throw std::invalid_argument("map: it has no free space");
  Random random(spec.seed);
  std::size_t made = 0;
  for (std::size_t tries = 0; made < spec.poses && tries < 1000 * spec.poses; ++tries) {
    const std::size_t cell = area[random.below(area.size())];
    if (clearance_at(map, cell, spec.clearance_m) < spec.clearance_m) continue;
    ++made;
    const Pose2 T_grid_laser{
        (static_cast<double>(cell % static_cast<std::size_t>(map.width)) + random.uniform(0, 1)) * map.resolution_m,
        (static_cast<double>(cell / static_cast<std::size_t>(map.width)) + random.uniform(0, 1)) * map.resolution_m,
        random.uniform(-kPi, kPi)};
    ScanGeometry geometry{-kPi, kTwoPi / spec.rays, 0.0, spec.range_m};
    std::vector<float> exact;
    for (int i = 0; i < spec.rays; ++i)
      exact.push_back(cast_cells(map, T_grid_laser, geometry.angle_min + i * geometry.angle_increment, spec.range_m));
    for (std::size_t draw = 0; draw < spec.draws; ++draw) {
      std::vector<float> ranges = exact;
      for (float& r : ranges) {
        if (r > 0.0F) r = static_cast<float>(std::max(0.01, static_cast<double>(r) + random.normal(0.0, spec.sigma_m)));
      }
      LocalizeCase one;
      one.measurement.scan = make_scan(ranges, geometry);
      one.T_map_base = map.origin * T_grid_laser;
      places.cases.push_back(std::move(one));
    }
  }
  return places;
}

}  // namespace phasescan
