#include "sim/pairs.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <stdexcept>

#include "sim/pairs_spec.hpp"
#include "sim/truth.hpp"
#include "sim/placement.hpp"

namespace phasescan {

template <>
std::span<const std::string_view> enum_names<sim::PairClass>() {
  static constexpr std::string_view names[] = {"small", "middle", "large", "global", "none"};
  return names;
}

}  // namespace phasescan

namespace phasescan::sim {
namespace {

/// The largest turn of the view itself where the class's turn is made by turning the sensor's frame.
constexpr double kViewTurn_rad = deg_to_rad(30.0);

/// What a scan must at least hold to be worth matching.
constexpr double kHitShare_min = 0.3;

/// The sensor with a narrower view, centred ahead, at the same angular resolution.
LidarOptions narrowed(LidarOptions lidar, double fov_deg) {
  if (fov_deg <= 0.0 || fov_deg >= lidar.fov_deg) return lidar;
  const double step_deg = std::abs(rad_to_deg(lidar.angle_increment()));
  lidar.beams = static_cast<int>(std::floor(fov_deg / step_deg)) + 1;
  lidar.fov_deg = step_deg * (lidar.beams - 1);
  lidar.angle_min_deg = (lidar.clockwise ? 0.5 : -0.5) * lidar.fov_deg;
  return lidar;
}

void blind(Scan& scan, double center_share, double width_share) {
  const auto n = static_cast<double>(scan.size());
  for (std::size_t i = 0; i < scan.size(); ++i) {
    double off = std::abs(static_cast<double>(i) / n - center_share);
    off = std::min(off, 1.0 - off);
    if (off > 0.5 * width_share) continue;
    scan.ranges[i] = std::numeric_limits<float>::quiet_NaN();
    scan.states[i] = BeamState::kNoReturn;
  }
}

bool worth_matching(const Scan& scan) {
  return static_cast<double>(scan.hit_count()) >= kHitShare_min * static_cast<double>(scan.size());
}

}  // namespace

PairBounds pair_bounds(PairClass cls) {
  const auto around = [](double distance, double turn_deg) {
    return PairBounds{0.65 * distance, 1.35 * distance, deg_to_rad(0.5 * turn_deg), deg_to_rad(1.5 * turn_deg)};
  };
  switch (cls) {
    case PairClass::kSmall:
      return around(0.3, 10.0);
    case PairClass::kMiddle:
      return around(0.5, 20.0);
    case PairClass::kLarge:
      return around(0.8, 30.0);
    case PairClass::kGlobal:
    case PairClass::kNone:
      break;
  }
  return {0.2, 1.5, 0.0, kPi};
}

void check_pair_row(const PairRow& row) {
  const auto fail = [&](const std::string& what) { throw std::invalid_argument("row " + row.dataset + ": " + what); };
  if (row.worlds.empty()) fail("worlds: none given");
  if (row.classes.empty()) fail("classes: none given");
  if (row.fixed && std::count(row.classes.begin(), row.classes.end(), PairClass::kNone) > 0)
    fail("classes: none needs more than one world");
  if (row.weight < 1) fail("weight: must be 1 or more");
  if (!(row.fov_deg >= 0.0 && row.fov_deg <= 360.0)) fail("fov_deg: must be 0..360");
  if (!(row.clearance_m > 0.0)) fail("clearance_m: must be above 0");
  if (!(row.overlap_min >= 0.0 && row.overlap_min < row.overlap_max)) fail("overlap_min: must be below overlap_max");
  if (!(row.moved_min >= 0 && row.moved_min <= row.moved_max)) fail("moved_min: must be 0..moved_max");
  if (row.people_max < 0) fail("people_max: must be 0 or more");
  if (!(row.dead_min_deg >= 0.0 && row.dead_min_deg <= row.dead_max_deg && row.dead_max_deg < 360.0))
    fail("dead_min_deg: must be 0..dead_max_deg");
  if (!(row.moved_share >= 0.0 && row.moved_share < 0.9)) fail("moved_share: must be 0..0.9");
}

PairGenerator::PairGenerator(PairsSpec spec, std::uint64_t seed) : spec_(std::move(spec)), seed_(seed) {
  if (spec_.rows.empty()) throw std::invalid_argument("rows: none given");
  int total = 0;
  for (const PairRow& row : spec_.rows) {
    check_pair_row(row);
    total += row.weight;
    lidars_.push_back(narrowed(read_lidar(row.sensor), row.fov_deg));
  }
  // One round serves each row `weight` times, spread evenly: always the row that is farthest behind its share.
  std::vector<int> served(spec_.rows.size(), 0);
  for (int turn = 0; turn < total; ++turn) {
    std::size_t next = 0;
    double behind = -1e300;
    for (std::size_t r = 0; r < spec_.rows.size(); ++r) {
      const double lag = static_cast<double>(spec_.rows[r].weight) * (turn + 1) / total - served[r];
      if (lag > behind + 1e-9) {
        behind = lag;
        next = r;
      }
    }
    turns_.push_back(next);
    index_in_row_.push_back(static_cast<std::size_t>(served[next]++));
  }
}

SimulatedPair PairGenerator::make(std::uint64_t k) const {
  const std::size_t turn = k % turns_.size(), r = turns_[turn];
  const PairRow& row = spec_.rows[r];
  const LidarOptions& lidar = lidars_[r];
  const std::uint64_t index = (k / turns_.size()) * static_cast<std::uint64_t>(row.weight) + index_in_row_[turn];
  const PairClass cls = row.classes[index % row.classes.size()];
  Random random(Random::derive(seed_, k));

  constexpr int kWorlds = 400;
  for (int attempt = 0; attempt < kWorlds; ++attempt) {
    SimulatedPair out;
    out.lidar = lidar;
    out.world = row.fixed ? *row.fixed : make_world(row.worlds[random.below(row.worlds.size())], random.bits());
    const RayCaster caster(out.world.shape);
    std::optional<RayCaster> other;
    Placement place;
    if (cls == PairClass::kNone) {
      const World second = make_world(row.worlds[random.below(row.worlds.size())], random.bits());
      other.emplace(second.shape);
      const auto a = draw_pose(out.world, caster, row.clearance_m, random),
                 b = draw_pose(second, *other, row.clearance_m, random);
      if (!a || !b) continue;
      place = {*a, *b};
    } else {
      const auto found = draw_placement(out.world, caster, row, cls, random);
      if (!found) continue;
      place = *found;
    }
    // The frame's heading is the class's; the view's may be kept near the reference's.
    const double frame_heading = place.T_world_scan.theta;
    if (row.turned_frame)
      place.T_world_scan.theta = wrap_angle(place.T_world_ref.theta + random.uniform(-kViewTurn_rad, kViewTurn_rad));
    draw_loose(caster, row, lidar, place, out.loose_ref, out.loose_scan, random);
    out.T_world_ref = place.T_world_ref;
    out.T_world_scan = place.T_world_scan;
    const Surroundings around_ref{&caster, &out.loose_ref}, around_scan{other ? &*other : &caster, &out.loose_scan};
    if (cls != PairClass::kNone) {
      const double overlap = pair_overlap(around_ref, around_scan, lidar, place.T_world_ref, place.T_world_scan).mean();
      if (overlap < row.overlap_min || overlap > row.overlap_max) continue;
      out.pair.overlap = overlap;
      out.pair.information = pair_information(around_ref, around_scan, lidar, place.T_world_ref, place.T_world_scan);
    }
    out.pair.reference = simulate_scan(around_ref, lidar, place.T_world_ref, random);
    out.pair.scan = simulate_scan(around_scan, lidar, place.T_world_scan, random);
    if (row.dead_max_deg > 0.0) {
      // Something on the robot is in the way: at the same bearing in both scans as often as not.
      const double width = random.uniform(row.dead_min_deg, row.dead_max_deg) / lidar.fov_deg, at = random.uniform();
      const bool same = random.chance(0.5);
      blind(out.pair.reference, at, width);
      blind(out.pair.scan, same ? at : random.uniform(),
            same ? width : random.uniform(row.dead_min_deg, row.dead_max_deg) / lidar.fov_deg);
    }
    if (!worth_matching(out.pair.reference) || !worth_matching(out.pair.scan)) continue;
    out.pair.scan.geometry.angle_min += wrap_angle(place.T_world_scan.theta - frame_heading);
    out.T_world_scan.theta = frame_heading;
    if (cls != PairClass::kNone) out.pair.truth = out.T_world_ref.inverse() * out.T_world_scan;
    char id[32];
    std::snprintf(id, sizeof id, "-%06llu", static_cast<unsigned long long>(k));
    out.pair.id = row.dataset + id;
    out.pair.dataset = row.dataset;
    out.pair.cls = std::string(to_string(cls));
    return out;
  }
  throw std::invalid_argument("row " + row.dataset + ": no pair could be placed in " + std::to_string(kWorlds) +
                              " worlds");
}

}  // namespace phasescan::sim
