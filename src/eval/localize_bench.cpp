#include "eval/localize_bench.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "eval/trajectory_error.hpp"
#include "phasescan/core/time.hpp"
#include "phasescan/slam/slam.hpp"
#include "sim/drive.hpp"
#include "sim/pairs_spec.hpp"
#include "sim/path.hpp"
#include "sim/placement.hpp"
#include "sim/ray_caster.hpp"
#include "sim/world_file.hpp"

namespace phasescan {
namespace {

constexpr double kRightM = 0.1, kRightRad = 3.0 * kPi / 180.0;
constexpr int kMarginCells = 20;  // between maps that lie side by side

bool is_within(double error_m, double error_rad) {
  return error_m < kRightM && error_rad < kRightRad;
}

/// A world, driven through and mapped.
struct MappedWorld {
  sim::World world;
  TrinaryMap map;
  Pose2 T_map_world;
};

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
  mapped.T_map_world = align_se2(poses).inverse();
  return mapped;
}

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

/// Whether the drive has seen that a robot can stand there: rooms that it never looked into are not on the map.
bool stands_on_map(const TrinaryMap& map, const Pose2& T_map_base) {
  const Eigen::Vector2d p = map.origin.inverse() * T_map_base.translation() / map.resolution_m;
  const auto i = static_cast<int>(std::floor(p.x())), k = static_cast<int>(std::floor(p.y()));
  return i >= 0 && k >= 0 && i < map.width && k < map.height && map.at(i, k) == CellState::kFree;
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

}  // namespace

LocalizePlaces simulated_places(const SimulatedPlacesSpec& spec, const std::function<void()>& progress) {
  LocalizePlaces places;
  const sim::LidarOptions lidar = sim::read_lidar(spec.sensor);
  std::uint64_t number = 0;
  for (const std::string& name : spec.worlds) {
    const std::uint64_t seed = Random::derive(spec.seed, ++number);
    const MappedWorld mapped = map_world(name, lidar, seed);
    const Pose2 T_map_world = paste(mapped.map, places.map) * mapped.T_map_world;
    const sim::RayCaster caster(mapped.world.shape);
    Random random(Random::derive(seed, 3));
    const std::size_t count = spec.poses / spec.worlds.size();
    for (std::size_t k = 0, tries = 0; k < count && tries < 20 * count; ++tries) {
      const auto pose = sim::draw_pose(mapped.world, caster, spec.clearance_m, random);
      if (!pose) break;
      if (!stands_on_map(places.map, T_map_world * *pose)) continue;
      LocalizeCase one;
      one.measurement.scan = sim::simulate_scan({&caster, nullptr}, lidar, *pose, random);
      one.T_map_base = T_map_world * *pose;
      places.cases.push_back(std::move(one));
      ++k;
    }
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

bool LocalizeRow::right() const {
  return is_within(error_m, error_rad);
}

std::vector<LocalizeRow> answer_all(const LocalizationMap& map, const std::vector<LocalizeCase>& cases,
                                    const LocalizeOptions& options, const std::function<void(std::size_t)>& progress) {
  std::vector<LocalizeRow> rows;
  for (const LocalizeCase& one : cases) {
    LocalizeRow row;
    const double cpu = thread_cpu_seconds();
    row.update = locate(map, one.measurement, options);
    row.ms = 1e3 * (thread_cpu_seconds() - cpu);
    row.error_m = row.error_rad = 1e3;
    if (row.update.T_map_base) {
      row.error_m = translation_distance(*row.update.T_map_base, one.T_map_base);
      row.error_rad = angle_distance(row.update.T_map_base->theta, one.T_map_base.theta);
    }
    for (const PoseEstimate& h : row.update.hypotheses)
      row.named |= is_within(translation_distance(h.T_map_base, one.T_map_base),
                             angle_distance(h.T_map_base.theta, one.T_map_base.theta));
    rows.push_back(std::move(row));
    progress(rows.size());
  }
  return rows;
}

LocalizeScore score_of(const std::vector<LocalizeRow>& rows) {
  LocalizeScore score;
  std::vector<double> ms, metres, degrees;
  std::vector<Judgement> judgements;
  for (const LocalizeRow& row : rows) {
    ++score.n;
    ms.push_back(row.ms);
    score.right += row.right();
    score.within_half_m += row.error_m < 0.5;
    if (row.right()) metres.push_back(row.error_m), degrees.push_back(rad_to_deg(row.error_rad));
    const TrackingStatus status = row.update.status;
    score.ok += status == TrackingStatus::kOk;
    score.right_ok += status == TrackingStatus::kOk && row.right();
    score.wrong_ok += status == TrackingStatus::kOk && !row.right();
    score.ambiguous += status == TrackingStatus::kAmbiguous;
    score.ambiguous_named += status == TrackingStatus::kAmbiguous && row.named;
    score.lost += status == TrackingStatus::kLost;
    if (status != TrackingStatus::kAmbiguous && row.update.T_map_base)
      judgements.push_back({row.update.confidence, row.right()});
  }
  score.median_m = quantile(metres, 0.5);
  score.median_deg = quantile(degrees, 0.5);
  score.ms_p50 = quantile(ms, 0.5);
  score.ms_p99 = quantile(ms, 0.99);
  score.calibration_error = calibration_error(judgements);
  return score;
}

}  // namespace phasescan
