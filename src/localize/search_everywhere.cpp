#include "localize/search_everywhere.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "localize/likelihood.hpp"

namespace phasescan {
namespace {

constexpr float kFirstHalfM = 0.2F, kLastHalfM = 0.03F;
constexpr int kFirstTurns = 48;                         // boxes of the first level in a turn
constexpr double kVisitedM = 0.12, kVisitedRad = 0.05;  // boxes this near one that was registered lead to the same pose
constexpr float kRoundingM = 0.01F;                     // of distances, which are kept in eighths of a cell

struct Box {
  float x = 0, y = 0, theta = 0;  ///< middle of the laser's pose, frame of the grid
  float bound = 0;
};

/// Hits in the frame of the laser, in an order that tells boxes apart early: far ones first.
struct Hits {
  std::vector<float> x, y, range, variance;
};

Hits hits_of(const QueryScan& scan, const MapGrid& grid) {
  const Pose2 T_laser_base = scan.T_base_laser.inverse();
  std::vector<std::size_t> order(scan.beams.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  // Neighbours say much the same: one of every seventh first.
  std::stable_sort(order.begin(), order.end(), [](std::size_t a, std::size_t b) { return a % 7 < b % 7; });
  Hits hits;
  for (const std::size_t i : order) {
    const Eigen::Vector2d p =
        T_laser_base * Eigen::Vector2d(static_cast<double>(scan.beams.x[i]), static_cast<double>(scan.beams.y[i]));
    hits.x.push_back(static_cast<float>(p.x()));
    hits.y.push_back(static_cast<float>(p.y()));
    hits.range.push_back(scan.beams.range[i]);
    hits.variance.push_back(scan.beams.variance[i] + map_variance(grid));
  }
  return hits;
}

/// No pose of the box is likelier than this; less than `needed` as soon as that is sure.
float bound_of(const MapGrid& grid, const Hits& hits, const Box& box, float half_m, float half_rad, float needed) {
  const float c = std::cos(box.theta), s = std::sin(box.theta);
  const float shift = 1.41422F * half_m + kRoundingM;
  float sum = 0.0F;
  for (std::size_t i = 0; i < hits.x.size(); ++i) {
    const float distance =
        grid.distance_at(c * hits.x[i] - s * hits.y[i] + box.x, s * hits.x[i] + c * hits.y[i] + box.y);
    const float least = std::max(0.0F, distance - shift - hits.range[i] * half_rad);
    sum += hit_log_likelihood(least, hits.variance[i]);
    if (sum < needed) break;
  }
  return sum;
}

/// Whether a box holds a free cell.
bool holds_free(const MapGrid& grid, const Box& box, float half_m) {
  const auto cell = [&](float v) { return static_cast<int>(std::floor(v * grid.inverse_cell)); };
  for (int k = cell(box.y - half_m); k <= cell(box.y + half_m); ++k) {
    for (int i = cell(box.x - half_m); i <= cell(box.x + half_m); ++i) {
      if (grid.is_free(i, k)) return true;
    }
  }
  return false;
}

std::vector<Box> first_boxes(const MapGrid& grid) {
  std::vector<Box> boxes;
  const float width = static_cast<float>(grid.width) * grid.cell_m,
              height = static_cast<float>(grid.height) * grid.cell_m;
  const float side = 2.0F * kFirstHalfM;
  for (int k = 0; static_cast<float>(k) * side < height; ++k) {
    for (int i = 0; static_cast<float>(i) * side < width; ++i) {
      Box box{(static_cast<float>(i) + 0.5F) * side, (static_cast<float>(k) + 0.5F) * side, 0.0F, 0.0F};
      if (!holds_free(grid, box, kFirstHalfM)) continue;
      for (int t = 0; t < kFirstTurns; ++t) {
        box.theta = static_cast<float>(kTwoPi * (t + 0.5) / kFirstTurns);
        boxes.push_back(box);
      }
    }
  }
  return boxes;
}

bool visited(const std::vector<Pose2>& places, const Pose2& pose) {
  return std::any_of(places.begin(), places.end(), [&](const Pose2& p) {
    return std::abs(p.x - pose.x) < kVisitedM && std::abs(p.y - pose.y) < kVisitedM &&
           angle_distance(p.theta, pose.theta) < kVisitedRad;
  });
}

/// Adds a pose, or puts it in the place of one that it is not apart from and likelier than.
void add_pose(const FoundPose& pose, std::vector<FoundPose>& found) {
  for (FoundPose& known : found) {
    if (is_apart(known.T_grid_base, pose.T_grid_base)) continue;
    if (pose.fit.log_likelihood > known.fit.log_likelihood) known = pose;
    return;
  }
  found.push_back(pose);
}

double best_of(const std::vector<FoundPose>& found) {
  double best = -1e30;
  for (const FoundPose& pose : found) best = std::max(best, pose.fit.log_likelihood);
  return best;
}

}  // namespace

std::vector<FoundPose> search_everywhere(const LocalizationMap::Data& map, const QueryScan& scan, double gap) {
  GlobalSearchWorkspace work;
  // What the fast search finds says how likely a pose must be; the poses themselves are found again.
  const double known = best_of(search_map(map, scan, {}, work));
  std::vector<FoundPose> found;
  const MapGrid& grid = map.grid;
  const Hits hits = hits_of(scan, grid);
  std::vector<Box> boxes = first_boxes(grid);
  float half_m = kFirstHalfM, half_rad = static_cast<float>(kPi / kFirstTurns);
  const auto needed = static_cast<float>(known - gap);
  while (true) {
    std::vector<Box> kept;
    for (Box box : boxes) {
      box.bound = bound_of(grid, hits, box, half_m, half_rad, needed);
      if (box.bound >= needed && holds_free(grid, box, half_m)) kept.push_back(box);
    }
    boxes = std::move(kept);
    if (half_m <= kLastHalfM) break;
    half_m *= 0.5F, half_rad *= 0.5F;
    kept.clear();
    for (const Box& box : boxes) {
      for (int n = 0; n < 8; ++n)
        kept.push_back({box.x + (n & 1 ? half_m : -half_m), box.y + (n & 2 ? half_m : -half_m),
                        box.theta + (n & 4 ? half_rad : -half_rad), 0.0F});
    }
    boxes = std::move(kept);
  }
  std::stable_sort(boxes.begin(), boxes.end(), [](const Box& a, const Box& b) { return a.bound > b.bound; });
  std::vector<Pose2> begun;
  const Pose2 T_laser_base = scan.T_base_laser.inverse();
  for (const Box& box : boxes) {
    const Pose2 T_grid_laser{static_cast<double>(box.x), static_cast<double>(box.y),
                             wrap_angle(static_cast<double>(box.theta))};
    if (box.bound < std::max(known, best_of(found)) - gap) break;
    if (visited(begun, T_grid_laser)) continue;
    begun.push_back(T_grid_laser);
    add_pose(match_near(map, scan, T_grid_laser * T_laser_base), found);
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const FoundPose& a, const FoundPose& b) { return a.fit.log_likelihood > b.fit.log_likelihood; });
  const double least = best_of(found) - gap;
  while (!found.empty() && found.back().fit.log_likelihood < least) found.pop_back();
  return found;
}

}  // namespace phasescan
