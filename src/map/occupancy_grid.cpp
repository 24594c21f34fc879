#include "map/occupancy_grid.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

namespace phasescan {
namespace {

constexpr double kStepsPerUnit = 20.0;
constexpr int kNeighbourBeams = 5;
constexpr double kMissingShare = 0.8;
constexpr double kSureLogOdds =
    1.4;  // a probability of 0.8: a free cell of make_trinary, and more than an occupied one

int floor_div(int a, int b) {
  return a >= 0 ? a / b : -((-a + b - 1) / b);
}

/// Visits the cells of a segment in order, from the cell of `from` on, with the distance at which each is entered
/// [Amanatides87]. `visit(i, k, entered)` returns false to stop.
template <class Visit>
void walk(const Eigen::Vector2d& from, const Eigen::Vector2d& direction, double length, double resolution,
          Visit&& visit) {
  int i = static_cast<int>(std::floor(from.x() / resolution)), k = static_cast<int>(std::floor(from.y() / resolution));
  const int step_i = direction.x() >= 0.0 ? 1 : -1, step_k = direction.y() >= 0.0 ? 1 : -1;
  const double infinity = std::numeric_limits<double>::infinity();
  const double cross_i = direction.x() != 0.0 ? resolution / std::abs(direction.x()) : infinity;
  const double cross_k = direction.y() != 0.0 ? resolution / std::abs(direction.y()) : infinity;
  double next_i = direction.x() != 0.0 ? ((i + (step_i > 0)) * resolution - from.x()) / direction.x() : infinity;
  double next_k = direction.y() != 0.0 ? ((k + (step_k > 0)) * resolution - from.y()) / direction.y() : infinity;
  double entered = 0.0;
  while (entered <= length) {
    if (!visit(i, k, entered)) return;
    if (next_i < next_k) {
      entered = next_i;
      next_i += cross_i;
      i += step_i;
    } else {
      entered = next_k;
      next_k += cross_k;
      k += step_k;
    }
  }
}

/// How far a missing beam surely went: to the nearer of the hits next to it on either side, 0 where one has none.
double reach_of_missing(const Scan& scan, int beam) {
  double reach = std::numeric_limits<double>::infinity();
  for (const int side : {-1, 1}) {
    double neighbour = 0.0;
    for (int d = 1; d <= kNeighbourBeams; ++d) {
      const int other = beam + side * d;
      if (other < 0 || other >= static_cast<int>(scan.size())) break;
      if (!scan.is_hit(static_cast<std::size_t>(other))) continue;
      neighbour = static_cast<double>(scan.ranges[static_cast<std::size_t>(other)]);
      break;
    }
    reach = std::min(reach, neighbour);
  }
  return reach;
}

}  // namespace

OccupancyGrid::OccupancyGrid(const OccupancyOptions& options) : options_(options) {
  if (!(options_.resolution_m > 0.0))
    throw std::invalid_argument("map.resolution_m: " + std::to_string(options_.resolution_m) + " is not above 0");
  hit_ = static_cast<int>(std::lround(options_.hit_log_odds * kStepsPerUnit));
  miss_ = static_cast<int>(std::lround(options_.miss_log_odds * kStepsPerUnit));
  missing_ = static_cast<int>(std::lround(options_.missing_log_odds * kStepsPerUnit));
  clamp_ = static_cast<int>(std::lround(std::clamp(options_.clamp_log_odds, 0.1, 6.0) * kStepsPerUnit));
}

OccupancyGrid::OccupancyGrid(OccupancyGrid&& other) noexcept {
  *this = std::move(other);
}

OccupancyGrid& OccupancyGrid::operator=(OccupancyGrid&& other) noexcept {
  if (this == &other) return *this;
  options_ = other.options_;
  hit_ = other.hit_, miss_ = other.miss_, missing_ = other.missing_, clamp_ = other.clamp_;
  clear();
  tiles_.swap(other.tiles_);
  other.clear();
  return *this;
}

void OccupancyGrid::clear() {
  tiles_.clear();
  last_tile_ = nullptr;  // one of the tiles that are gone
}

int OccupancyGrid::cell_of(double metres) const {
  return static_cast<int>(std::floor(metres / options_.resolution_m));
}

OccupancyGrid::Tile& OccupancyGrid::tile(int ti, int tk) {
  if (last_tile_ && last_.first == ti && last_.second == tk) return *last_tile_;
  auto& found = tiles_[{ti, tk}];
  if (!found) {
    found = std::make_unique<Tile>();
    found->fill(kUnknown);
  }
  last_ = {ti, tk};
  last_tile_ = found.get();
  return *found;
}

void OccupancyGrid::change(int i, int k, int steps) {
  const int ti = floor_div(i, kTileCells), tk = floor_div(k, kTileCells);
  std::int8_t& value =
      tile(ti, tk)[static_cast<std::size_t>((k - tk * kTileCells) * kTileCells + (i - ti * kTileCells))];
  const int old = value == kUnknown ? 0 : value;
  value = static_cast<std::int8_t>(std::clamp(old + steps, -clamp_, clamp_));
}

std::int8_t OccupancyGrid::cell(int i, int k) const {
  const int ti = floor_div(i, kTileCells), tk = floor_div(k, kTileCells);
  const auto found = tiles_.find({ti, tk});
  if (found == tiles_.end()) return kUnknown;
  return (*found->second)[static_cast<std::size_t>((k - tk * kTileCells) * kTileCells + (i - ti * kTileCells))];
}

double OccupancyGrid::log_odds(int i, int k) const {
  const std::int8_t value = cell(i, k);
  return value == kUnknown ? 0.0 : value / kStepsPerUnit;
}

void OccupancyGrid::add_scan(const Scan& scan, const Pose2& T_map_laser, const Twist2& twist) {
  const int n = static_cast<int>(scan.size());
  const bool moving = !twist.is_zero() && scan.time_increment != 0.0;
  struct Ray {
    Eigen::Vector2d from, direction;
  };
  const auto ray_of = [&](int b) {
    const Pose2 pose = moving ? T_map_laser * exp_twist(twist, b * scan.time_increment) : T_map_laser;
    const double angle = pose.theta + scan.angle(static_cast<std::size_t>(b));
    return Ray{pose.translation(), {std::cos(angle), std::sin(angle)}};
  };
  std::vector<std::pair<int, int>> hits;
  hits.reserve(scan.size());
  // The cells that were hit are kept from being marked free by a neighbouring ray that grazes them.
  for (int b = 0; b < n; ++b) {
    if (!scan.is_hit(static_cast<std::size_t>(b))) continue;
    const double range = static_cast<double>(scan.ranges[static_cast<std::size_t>(b)]);
    if (range > options_.max_ray_m) continue;
    const Ray ray = ray_of(b);
    hits.emplace_back(cell_of(ray.from.x() + range * ray.direction.x()),
                      cell_of(ray.from.y() + range * ray.direction.y()));
  }
  std::sort(hits.begin(), hits.end());
  hits.erase(std::unique(hits.begin(), hits.end()), hits.end());
  const auto is_hit_cell = [&](int i, int k) { return std::binary_search(hits.begin(), hits.end(), std::pair{i, k}); };
  for (int b = 0; b < n; ++b) {
    const auto beam = static_cast<std::size_t>(b);
    if (scan.is_hit(beam)) {
      const Ray ray = ray_of(b);
      const double range = static_cast<double>(scan.ranges[beam]);
      const double free = std::min(range, options_.max_ray_m);
      const double near_hit = range - 2.0 * options_.resolution_m;
      walk(ray.from, ray.direction, free, options_.resolution_m, [&](int i, int k, double entered) {
        if (entered > near_hit && is_hit_cell(i, k)) return true;
        change(i, k, miss_);
        return true;
      });
      continue;
    }
    if (scan.states[beam] != BeamState::kOutOfRange && scan.states[beam] != BeamState::kNoReturn) continue;
    const double reach = reach_of_missing(scan, b);
    if (reach <= 0.0 || missing_ == 0) continue;
    const Ray ray = ray_of(b);
    walk(ray.from, ray.direction, std::min(kMissingShare * reach, options_.max_ray_m), options_.resolution_m,
         [&](int i, int k, double) {
           change(i, k, missing_);
           return true;
         });
  }
  for (const auto& [i, k] : hits) change(i, k, hit_);
}

void OccupancyGrid::update_with(const OccupancyGrid& later) {
  const int sure = static_cast<int>(std::lround(kSureLogOdds * kStepsPerUnit));
  for (const auto& [at, known] : later.tiles_) {
    Tile& here = tile(at.first, at.second);
    for (std::size_t c = 0; c < here.size(); ++c) {
      if ((*known)[c] == kUnknown) continue;
      const int now = (*known)[c], before = here[c] == kUnknown ? 0 : here[c];
      const int kept = before * std::max(0, sure - std::abs(now)) / sure;
      here[c] = static_cast<std::int8_t>(std::clamp(kept + now, -clamp_, clamp_));
    }
  }
}

OccupancyGrid::Bounds OccupancyGrid::bounds() const {
  Bounds b{std::numeric_limits<int>::max(), std::numeric_limits<int>::max(), std::numeric_limits<int>::min(),
           std::numeric_limits<int>::min()};
  for (const auto& [at, tile] : tiles_) {
    for (int k = 0; k < kTileCells; ++k) {
      for (int i = 0; i < kTileCells; ++i) {
        if ((*tile)[static_cast<std::size_t>(k * kTileCells + i)] == kUnknown) continue;
        b.min_i = std::min(b.min_i, at.first * kTileCells + i);
        b.max_i = std::max(b.max_i, at.first * kTileCells + i);
        b.min_k = std::min(b.min_k, at.second * kTileCells + k);
        b.max_k = std::max(b.max_k, at.second * kTileCells + k);
      }
    }
  }
  return b.max_i < b.min_i ? Bounds{} : b;
}

std::optional<double> OccupancyGrid::raycast(const Eigen::Vector2d& from, double direction, double max_range,
                                             double occupied) const {
  std::optional<double> distance;
  const Eigen::Vector2d along(std::cos(direction), std::sin(direction));
  walk(from, along, max_range, options_.resolution_m, [&](int i, int k, double entered) {
    if (log_odds(i, k) < occupied) return true;
    distance = entered;
    return false;
  });
  return distance;
}

}  // namespace phasescan
