#include "localize/search_everywhere.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "localize/likelihood.hpp"

namespace phasescan {
namespace {

constexpr std::size_t kStepsOfMatch = 200;  // a registration takes as long as so many boxes
constexpr float kFirstHalfM = 0.2F, kLastHalfM = 0.03F;
constexpr int kFirstTurns = 48;                         // boxes of the first level in a turn
constexpr double kVisitedM = 0.12, kVisitedRad = 0.05;  // boxes this near one that was registered lead to the same pose
constexpr float kRoundingCells = 0.71F + 0.125F;        // of a hit to a cell's middle, of the distance there

struct Box {
  float x = 0, y = 0, theta = 0;  ///< middle of the laser's pose, frame of the grid
  float bound = 0;
};

/// Hits in the frame of the laser, in an order that tells boxes apart early: neighbours say much the same, so one of
/// every seventh comes first.
struct Hits {
  std::vector<float> x, y, range;
  std::vector<std::uint16_t> row;  ///< of the table
  /// Log-likelihood by the distance in eighths of a cell, a row for hits of much the same variance, which counts as the
  /// largest of the row.
  std::vector<float> table;
};

constexpr std::size_t kRows = 16, kDistances = MapGrid::kMostDistance + 1;

Hits hits_of(const QueryScan& scan, const MapGrid& grid) {
  const Pose2 T_laser_base = scan.T_base_laser.inverse();
  std::vector<std::size_t> order(scan.beams.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(), [](std::size_t a, std::size_t b) { return a % 7 < b % 7; });
  std::vector<float> variances = scan.beams.variance;
  std::sort(variances.begin(), variances.end());
  Hits hits;
  std::vector<float> largest;
  for (std::size_t r = 0; r < kRows; ++r) {
    largest.push_back(variances[((r + 1) * variances.size() - 1) / kRows]);
    for (std::size_t d = 0; d < kDistances; ++d)
      hits.table.push_back(hit_log_likelihood(static_cast<float>(d) / MapGrid::kPerCell * grid.cell_m,
                                              largest.back() + map_variance(grid)));
  }
  for (const std::size_t i : order) {
    const Eigen::Vector2d p =
        T_laser_base * Eigen::Vector2d(static_cast<double>(scan.beams.x[i]), static_cast<double>(scan.beams.y[i]));
    hits.x.push_back(static_cast<float>(p.x()));
    hits.y.push_back(static_cast<float>(p.y()));
    hits.range.push_back(scan.beams.range[i]);
    const auto row = std::lower_bound(largest.begin(), largest.end(), scan.beams.variance[i]) - largest.begin();
    hits.row.push_back(static_cast<std::uint16_t>(row * static_cast<std::ptrdiff_t>(kDistances)));
  }
  return hits;
}

/// Hits turned to one heading: cells from the laser's, and how far a pose of a box may move them.
struct TurnedHits {
  std::vector<float> u, v;          ///< [cells]
  std::vector<std::int32_t> least;  ///< what is taken off a distance [eighths of a cell]
};

void turn_hits(const Hits& hits, const MapGrid& grid, float theta, float half_m, float half_rad, TurnedHits& out) {
  const float c = std::cos(theta), s = std::sin(theta);
  const std::size_t n = hits.x.size();
  out.u.resize(n), out.v.resize(n), out.least.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    out.u[i] = (c * hits.x[i] - s * hits.y[i]) * grid.inverse_cell;
    out.v[i] = (s * hits.x[i] + c * hits.y[i]) * grid.inverse_cell;
    // A box's corner, a turn, and the corner of the cell that a hit lies in.
    const float shift = (1.41422F * half_m + hits.range[i] * half_rad) * grid.inverse_cell + kRoundingCells;
    out.least[i] = static_cast<std::int32_t>(std::ceil(shift * MapGrid::kPerCell));
  }
}

/// No pose of the box is likelier than this; less than `needed` as soon as that is sure.
float bound_of(const MapGrid& grid, const Hits& hits, const TurnedHits& turned, const Box& box, float needed) {
  const float u0 = box.x * grid.inverse_cell, v0 = box.y * grid.inverse_cell;
  float sum = 0.0F;
  for (std::size_t i = 0; i < turned.u.size(); ++i) {
    const float u = u0 + turned.u[i], v = v0 + turned.v[i];
    const auto column = static_cast<std::int32_t>(u), row = static_cast<std::int32_t>(v);
    int distance = MapGrid::kMostDistance;
    if (u >= 0.0F && v >= 0.0F && column < grid.width && row < grid.height)
      distance = grid.distance[grid.index(column, row)];
    sum += hits.table[hits.row[i] + static_cast<std::size_t>(std::max(0, distance - turned.least[i]))];
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

/// Boxes of the first level, those of one heading together.
std::vector<Box> first_boxes(const MapGrid& grid) {
  std::vector<Box> places, boxes;
  const float width = static_cast<float>(grid.width) * grid.cell_m,
              height = static_cast<float>(grid.height) * grid.cell_m;
  const float side = 2.0F * kFirstHalfM;
  for (int k = 0; static_cast<float>(k) * side < height; ++k) {
    for (int i = 0; static_cast<float>(i) * side < width; ++i) {
      const Box box{(static_cast<float>(i) + 0.5F) * side, (static_cast<float>(k) + 0.5F) * side, 0.0F, 0.0F};
      if (holds_free(grid, box, kFirstHalfM)) places.push_back(box);
    }
  }
  for (int t = 0; t < kFirstTurns; ++t) {
    for (Box box : places) {
      box.theta = static_cast<float>(kTwoPi * (t + 0.5) / kFirstTurns);
      boxes.push_back(box);
    }
  }
  return boxes;
}

/// The eighths of all boxes; headings stay together.
std::vector<Box> split(const std::vector<Box>& boxes, float half_m, float half_rad) {
  std::vector<Box> out;
  for (std::size_t first = 0, last = 0; first < boxes.size(); first = last) {
    while (last < boxes.size() && boxes[last].theta == boxes[first].theta) ++last;
    for (const float turn : {-half_rad, half_rad}) {
      for (std::size_t i = first; i < last; ++i) {
        for (int n = 0; n < 4; ++n)
          out.push_back({boxes[i].x + (n & 1 ? half_m : -half_m), boxes[i].y + (n & 2 ? half_m : -half_m),
                         boxes[i].theta + turn, 0.0F});
      }
    }
  }
  return out;
}

/// Boxes that may hold a pose as likely as `needed`.
std::vector<Box> keep_possible(const MapGrid& grid, const Hits& hits, const std::vector<Box>& boxes, float half_m,
                               float half_rad, float needed) {
  std::vector<Box> kept;
  TurnedHits turned;
  float theta = -1e9F;
  for (Box box : boxes) {
    if (box.theta != theta) {
      theta = box.theta;
      turn_hits(hits, grid, theta, half_m, half_rad, turned);
    }
    box.bound = bound_of(grid, hits, turned, box, needed);
    if (box.bound >= needed && holds_free(grid, box, half_m)) kept.push_back(box);
  }
  return kept;
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

/// Splits boxes down to the last level and keeps those that may hold a pose as likely as `needed`.
/// @return false where that took more steps than allowed
bool narrow_down(const MapGrid& grid, const Hits& hits, double needed, std::size_t most_steps, std::size_t& steps,
                 std::vector<Box>& boxes) {
  float half_m = kFirstHalfM, half_rad = static_cast<float>(kPi / kFirstTurns);
  while (true) {
    boxes = keep_possible(grid, hits, boxes, half_m, half_rad, static_cast<float>(needed));
    if (half_m <= kLastHalfM) return true;
    steps += 8 * boxes.size();
    if (most_steps > 0 && steps > most_steps) return false;
    half_m *= 0.5F, half_rad *= 0.5F;
    boxes = split(boxes, half_m, half_rad);
  }
}

double best_of(const std::vector<FoundPose>& found) {
  double best = -1e30;
  for (const FoundPose& pose : found) best = std::max(best, pose.fit.log_likelihood);
  return best;
}

}  // namespace

PosesEverywhere search_everywhere(const LocalizationMap::Data& map, const QueryScan& scan, double gap,
                                  std::size_t most_steps) {
  GlobalSearchWorkspace work;
  // What the fast search finds says how likely a pose must be; the poses themselves are found again.
  const double known = best_of(search_map(map, scan, {}, work));
  PosesEverywhere result;
  std::vector<FoundPose>& found = result.found;
  if (scan.beams.size() == 0) return result;
  std::vector<Box> boxes = first_boxes(map.grid);
  std::size_t steps = 0;
  result.finished = narrow_down(map.grid, hits_of(scan, map.grid), known - gap, most_steps, steps, boxes);
  std::stable_sort(boxes.begin(), boxes.end(), [](const Box& a, const Box& b) { return a.bound > b.bound; });
  std::vector<Pose2> begun;
  const Pose2 T_laser_base = scan.T_base_laser.inverse();
  for (const Box& box : boxes) {
    if (!result.finished) break;
    const Pose2 T_grid_laser{static_cast<double>(box.x), static_cast<double>(box.y),
                             wrap_angle(static_cast<double>(box.theta))};
    if (box.bound < std::max(known, best_of(found)) - gap) break;
    if (visited(begun, T_grid_laser)) continue;
    begun.push_back(T_grid_laser);
    add_pose(match_near(map, scan, T_grid_laser * T_laser_base), found);
    steps += kStepsOfMatch;
    result.finished = most_steps == 0 || steps <= most_steps;
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const FoundPose& a, const FoundPose& b) { return a.fit.log_likelihood > b.fit.log_likelihood; });
  const double least = best_of(found) - gap;
  while (!found.empty() && found.back().fit.log_likelihood < least) found.pop_back();
  return result;
}

}  // namespace phasescan
