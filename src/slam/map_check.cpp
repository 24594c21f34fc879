#include "slam/map_check.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <map>
#include <memory>
#include <utility>

#include "core/motion.hpp"

namespace phasescan {
namespace {

constexpr double kCellM = 0.1;
constexpr double kStepM = 0.07;  // of a ray: no cell that it meets for longer than a corner is passed over
constexpr int kTile = 64;
constexpr std::size_t kRays = 60;         // of a scan
constexpr double kNearM = 4.0;            // visits nearer on the way are the same visit
constexpr double kFarM = 8.0;             // and these are others
constexpr double kSameM = 0.25;           // a hit so near to a wall is the wall's
constexpr double kDoubledM = 0.6;         // and so near is the wall once more
constexpr double kFarthestM = 15.0;       // of a ray: beyond, a degree is as much as a wall's thickness
constexpr std::size_t kFewest = 15;       // rays that must meet what others know
constexpr std::size_t kInARow = 5;        // scans of a worst place
constexpr std::size_t kTail = 20;         // one of so many places is among the worst
constexpr double kManyBeams = 1.0 / 3.0;  // of a scan: no door and no person
constexpr std::size_t kMostBins = 64;     // one bit each

using Bins = std::uint64_t;

/// What the stretches of the way know of a cell: a bit for each.
struct Cell {
  Bins hit = 0;   ///< was hit in it
  Bins wall = 0;  ///< by two scans or more
  Bins free = 0;  ///< was looked through
  Bins open = 0;  ///< by two scans or more
};

class VisitGrid {
 public:
  Cell& at(int i, int k) {
    const std::pair<int, int> key{i >> 6, k >> 6};
    if (last_ == nullptr || key != last_key_) {
      auto& tile = tiles_[key];
      if (!tile) tile = std::make_unique<Tile>();
      last_ = tile.get(), last_key_ = key;
    }
    return (*last_)[static_cast<std::size_t>((k & (kTile - 1)) * kTile + (i & (kTile - 1)))];
  }

 private:
  using Tile = std::array<Cell, static_cast<std::size_t>(kTile) * kTile>;
  std::map<std::pair<int, int>, std::unique_ptr<Tile>> tiles_;
  Tile* last_ = nullptr;
  std::pair<int, int> last_key_;
};

struct Ray {
  Eigen::Vector2d from, direction;
  double range = 0.0;
};

/// Some of a scan's hits as rays on the map.
std::vector<Ray> rays_of(const PlacedScan& placed) {
  std::vector<Ray> rays;
  const Scan& scan = placed.scan;
  const bool moving = !placed.twist.is_zero() && scan.time_increment != 0.0;
  const std::size_t stride = std::max<std::size_t>(1, scan.size() / kRays);
  for (std::size_t b = 0; b < scan.size(); b += stride) {
    if (!scan.is_hit(b)) continue;
    const auto range = static_cast<double>(scan.ranges[b]);
    if (range > kFarthestM) continue;
    const Pose2 pose = moving
                           ? placed.T_map_laser * exp_twist(placed.twist, static_cast<double>(b) * scan.time_increment)
                           : placed.T_map_laser;
    const double angle = pose.theta + scan.angle(b);
    rays.push_back({pose.translation(), {std::cos(angle), std::sin(angle)}, range});
  }
  return rays;
}

template <class Visit>
void step_along(const Ray& ray, double from_m, double to_m, Visit&& visit) {
  int last_i = 0, last_k = 0;
  bool first = true;
  for (double d = from_m; d < to_m; d += kStepM) {
    const Eigen::Vector2d p = ray.from + d * ray.direction;
    const int i = static_cast<int>(std::floor(p.x() / kCellM)), k = static_cast<int>(std::floor(p.y() / kCellM));
    if (!first && i == last_i && k == last_k) continue;
    first = false, last_i = i, last_k = k;
    if (!visit(i, k, d)) return;
  }
}

void draw(const std::vector<Ray>& rays, Bins bin, VisitGrid& grid) {
  std::vector<std::pair<int, int>> hits, passed;
  for (const Ray& ray : rays) {
    const Eigen::Vector2d p = ray.from + ray.range * ray.direction;
    hits.emplace_back(static_cast<int>(std::floor(p.x() / kCellM)), static_cast<int>(std::floor(p.y() / kCellM)));
    step_along(ray, 0.0, ray.range - kSameM, [&](int i, int k, double) {
      passed.emplace_back(i, k);
      return true;
    });
  }
  for (auto* cells : {&hits, &passed}) {  // once a scan
    std::sort(cells->begin(), cells->end());
    cells->erase(std::unique(cells->begin(), cells->end()), cells->end());
  }
  for (const auto& [i, k] : hits) {
    Cell& cell = grid.at(i, k);
    cell.wall |= cell.hit & bin;
    cell.hit |= bin;
  }
  for (const auto& [i, k] : passed) {
    Cell& cell = grid.at(i, k);
    cell.open |= cell.free & bin;
    cell.free |= bin;
  }
}

/// Beams of a scan by what they say of what others know.
struct Count {
  std::size_t met = 0, crossed = 0, doubled = 0, in_free = 0;
};

/// A wall: others hit it again and again, and do not look through it as well.
bool is_wall(const Cell& cell, Bins others) {
  return (cell.wall & others) != 0 && (cell.open & others) == 0;
}

void judge(const Ray& ray, Bins others, VisitGrid& grid, Count& count) {
  double wall = -1.0;
  bool hit_here = false, open_here = false;
  step_along(ray, 0.3, ray.range + kDoubledM, [&](int i, int k, double d) {
    const Cell& cell = grid.at(i, k);
    if (wall < 0.0 && is_wall(cell, others)) wall = d;
    if (std::abs(d - ray.range) <= kSameM && (cell.hit & others) != 0) hit_here = true;
    if (std::abs(d - ray.range) <= 0.5 * kCellM && (cell.open & others) != 0) open_here = true;
    return true;
  });
  // A wall behind what only this visit saw may be the wall's other side.
  const bool behind_wall = wall >= 0.0 && ray.range - wall > kSameM;
  if (!behind_wall && !hit_here && !open_here) return;
  ++count.met;
  if (behind_wall && ray.range - wall > kDoubledM) {
    ++count.crossed;
  } else if (hit_here) {
    return;  // the same thing, be it thin
  } else if (wall >= 0.0) {
    ++count.doubled;
  } else {
    ++count.in_free;
  }
}

/// Of one scan; `met` is 0 where it has too little in common with others.
Count judge(const std::vector<Ray>& rays, Bins others, VisitGrid& grid) {
  Count count;
  if (others == 0) return count;
  for (const Ray& ray : rays) judge(ray, others, grid, count);
  return count.met < kFewest ? Count{} : count;
}

VisitShares shares(const Count& count) {
  const auto met = static_cast<double>(std::max<std::size_t>(1, count.met));
  return {static_cast<double>(count.crossed) / met, static_cast<double>(count.doubled) / met,
          static_cast<double>(count.in_free) / met};
}

void add(const Count& one, Count& sum) {
  sum.met += one.met, sum.crossed += one.crossed, sum.doubled += one.doubled, sum.in_free += one.in_free;
}

VisitShares mean_of_worst(std::vector<VisitShares> places) {
  VisitShares mean;
  if (places.empty()) return mean;
  std::stable_sort(places.begin(), places.end(),
                   [](const VisitShares& a, const VisitShares& b) { return a.against() > b.against(); });
  const std::size_t count = (places.size() + kTail - 1) / kTail;
  for (std::size_t k = 0; k < count; ++k) {
    mean.crossed += places[k].crossed / static_cast<double>(count);
    mean.doubled += places[k].doubled / static_cast<double>(count);
    mean.in_free += places[k].in_free / static_cast<double>(count);
  }
  return mean;
}

VisitComparison compare(const std::vector<Count>& counts) {
  VisitComparison result;
  Count all;
  std::vector<std::size_t> told;
  for (std::size_t k = 0; k < counts.size(); ++k) {
    if (counts[k].met == 0) continue;
    told.push_back(k);
    add(counts[k], all);
    const VisitShares one = shares(counts[k]);
    result.contradicting += one.crossed + one.in_free > kManyBeams;
    result.doubling += one.doubled > kManyBeams;
  }
  result.scans = told.size();
  result.mean = shares(all);
  std::vector<VisitShares> places;
  for (std::size_t k = 0; k + kInARow <= told.size(); ++k) {
    Count some;
    for (std::size_t j = k; j < k + kInARow; ++j) add(counts[told[j]], some);
    const VisitShares here = shares(some);
    places.push_back(here);
    if (here.against() <= result.worst.against()) continue;
    result.worst = here;
    result.worst_scan = told[k + kInARow / 2];
  }
  result.tail = mean_of_worst(std::move(places));
  return result;
}

/// Stretches of the way: of each scan its bit, and those of the stretches between two distances from it.
struct Stretches {
  explicit Stretches(const std::vector<double>& way_m)
      : length(std::max(2.0, (way_m.empty() ? 0.0 : way_m.back()) / static_cast<double>(kMostBins - 1))) {}
  std::size_t bin(double way) const { return std::min(kMostBins - 1, static_cast<std::size_t>(way / length)); }
  Bins others(double way, double least, double most) const {
    Bins bins = 0;
    for (std::size_t b = 0; b < kMostBins; ++b) {
      const double begin = static_cast<double>(b) * length, end = begin + length;
      const double apart = std::max({0.0, begin - way, way - end});
      if (b != bin(way) && apart >= least && apart < most) bins |= Bins{1} << b;
    }
    return bins;
  }
  double length;
};

}  // namespace

MapCheck check_map(std::size_t count, const std::function<PlacedScan(std::size_t)>& scan_of,
                   const std::vector<double>& way_m) {
  const Stretches stretches(way_m);
  VisitGrid grid;
  std::vector<std::vector<Ray>> rays;
  rays.reserve(count);
  for (std::size_t k = 0; k < count; ++k) {
    rays.push_back(rays_of(scan_of(k)));
    draw(rays.back(), Bins{1} << stretches.bin(way_m[k]), grid);
  }
  std::vector<Count> near, far;
  for (std::size_t k = 0; k < count; ++k) {
    near.push_back(judge(rays[k], stretches.others(way_m[k], 0.0, kNearM), grid));
    far.push_back(judge(rays[k], stretches.others(way_m[k], kFarM, 1e9), grid));
  }
  return {compare(near), compare(far)};
}

}  // namespace phasescan
