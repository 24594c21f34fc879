#include "sim/places.hpp"

#include <algorithm>
#include <cmath>

#include "sim/placement.hpp"

namespace phasescan::sim {

std::vector<Place> make_places(const PlacesOptions& options, const LidarOptions& lidar, std::uint64_t seed,
                               std::uint64_t building) {
  Random random(Random::derive(seed, building));
  const World world = make_world(options.world, random.bits());
  const RayCaster caster(world.shape);
  const Surroundings around{&caster, nullptr};
  std::vector<Place> places;
  // Darts until they keep landing too near to others.
  constexpr int kMisses = 60, kQueryTries = 40;
  for (int misses = 0; misses < kMisses;) {
    const auto pose = draw_pose(world, caster, options.clearance_m, random);
    const auto near = [&](const Place& other) {
      return translation_distance(other.T_world_place, *pose) < options.apart_m;
    };
    if (!pose || std::any_of(places.begin(), places.end(), near)) {
      ++misses;
      continue;
    }
    misses = 0;
    for (int i = 0; i < kQueryTries; ++i) {
      const double distance = options.reach_m * std::sqrt(random.uniform()), angle = random.uniform(-kPi, kPi);
      const Pose2 query{pose->x + distance * std::cos(angle), pose->y + distance * std::sin(angle),
                        random.uniform(-kPi, kPi)};
      if (caster.clearance(query.translation(), options.clearance_m) < options.clearance_m) continue;
      if (!caster.line_of_sight(pose->translation(), query.translation())) continue;
      Place place{building, *pose, simulate_scan(around, lidar, *pose, random), query, {}, {}};
      place.query = simulate_scan(around, lidar, query, random);
      places.push_back(std::move(place));
      break;
    }
  }
  for (Place& place : places) {
    for (std::uint32_t k = 0; k < places.size(); ++k) {
      if (translation_distance(places[k].T_world_place, place.T_world_query) <= options.reach_m &&
          caster.line_of_sight(places[k].T_world_place.translation(), place.T_world_query.translation()))
        place.in_reach.push_back(k);
    }
  }
  return places;
}

}  // namespace phasescan::sim
