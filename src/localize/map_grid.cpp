#include "localize/map_grid.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace phasescan {
namespace {

constexpr double kLeastCellM = 0.04, kMergedCellM = 0.05;

/// Squared distance transform of one line [Felzenszwalb12]: the lower envelope of parabolas.
class LineTransform {
 public:
  explicit LineTransform(std::size_t longest) : value_(longest), from_(longest), begin_(longest + 1) {}

  /// @param step  between the line's cells in `squares`
  void run(float* squares, std::size_t count, std::size_t step) {
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    for (std::size_t i = 0; i < count; ++i) value_[i] = squares[i * step];
    std::size_t parabolas = 0;
    for (std::size_t i = 0; i < count; ++i) {
      if (value_[i] == kInfinity) continue;
      float meet = -kInfinity;
      while (parabolas > 0) {
        meet = crossing(from_[parabolas - 1], i);
        if (meet > begin_[parabolas - 1]) break;
        --parabolas;
        meet = -kInfinity;
      }
      from_[parabolas] = i;
      begin_[parabolas] = meet;
      ++parabolas;
    }
    if (parabolas == 0) return;
    std::size_t at = 0;
    for (std::size_t i = 0; i < count; ++i) {
      while (at + 1 < parabolas && begin_[at + 1] < static_cast<float>(i)) ++at;
      const float off = static_cast<float>(i) - static_cast<float>(from_[at]);
      squares[i * step] = off * off + value_[from_[at]];
    }
  }

 private:
  float crossing(std::size_t a, std::size_t b) const {
    const auto p = static_cast<float>(a), q = static_cast<float>(b);
    return ((value_[b] + q * q) - (value_[a] + p * p)) / (2.0F * (q - p));
  }

  std::vector<float> value_;
  std::vector<std::size_t> from_;
  std::vector<float> begin_;
};

void fill_distances(MapGrid& grid) {
  const auto width = static_cast<std::size_t>(grid.width), height = static_cast<std::size_t>(grid.height);
  std::vector<float> squares(width * height, std::numeric_limits<float>::infinity());
  for (std::size_t i = 0; i < squares.size(); ++i) {
    if (grid.occupied[i]) squares[i] = 0.0F;
  }
  LineTransform line(std::max(width, height));
  for (std::size_t i = 0; i < width; ++i) line.run(squares.data() + i, height, width);
  for (std::size_t k = 0; k < height; ++k) line.run(squares.data() + k * width, width, 1);
  grid.distance.resize(squares.size());
  const auto most = static_cast<float>(MapGrid::kMostDistance);
  for (std::size_t i = 0; i < squares.size(); ++i)
    grid.distance[i] = static_cast<std::uint8_t>(std::min(most, std::round(MapGrid::kPerCell * std::sqrt(squares[i]))));
}

}  // namespace

float MapGrid::distance_at(float x, float y) const {
  const float u = x * inverse_cell - 0.5F, v = y * inverse_cell - 0.5F;
  if (!(u >= 0.0F && v >= 0.0F && u < static_cast<float>(width - 1) && v < static_cast<float>(height - 1)))
    return most_distance_m();
  const auto i = static_cast<int>(u), k = static_cast<int>(v);
  const float a = u - static_cast<float>(i), b = v - static_cast<float>(k);
  const std::uint8_t* const row = distance.data() + index(i, k);
  const std::uint8_t* const above = row + width;
  const float low = (1.0F - a) * static_cast<float>(row[0]) + a * static_cast<float>(row[1]);
  const float high = (1.0F - a) * static_cast<float>(above[0]) + a * static_cast<float>(above[1]);
  return ((1.0F - b) * low + b * high) * (cell_m / kPerCell);
}

float MapGrid::cast(float x, float y, float dx, float dy, float most) const {
  const float least_step = 0.5F * cell_m;
  float range = 0.0F;
  while (range < most) {
    const float u = (x + range * dx) * inverse_cell, v = (y + range * dy) * inverse_cell;
    if (!(u >= 0.0F && v >= 0.0F && u < static_cast<float>(width) && v < static_cast<float>(height))) return most;
    const std::size_t at = index(static_cast<int>(u), static_cast<int>(v));
    if (distance[at] == 0) return std::min(range, most);
    // From middle to middle: the point may lie up to 0.7 cells from its middle, and the surface begins half a cell or
    // more before the other's.
    const float clear = static_cast<float>(distance[at]) * (cell_m / kPerCell) - 1.4F * cell_m;
    range += std::max(clear, least_step);
  }
  return most;
}

MapGrid make_map_cells(const TrinaryMap& map) {
  const int merge =
      map.resolution_m >= kLeastCellM ? 1 : std::max(1, static_cast<int>(std::lround(kMergedCellM / map.resolution_m)));
  MapGrid grid;
  grid.width = (map.width + merge - 1) / merge;
  grid.height = (map.height + merge - 1) / merge;
  grid.cell_m = static_cast<float>(map.resolution_m * merge);
  grid.inverse_cell = 1.0F / grid.cell_m;
  const std::size_t count = static_cast<std::size_t>(grid.width) * static_cast<std::size_t>(grid.height);
  grid.free.assign(count, 0);
  grid.occupied.assign(count, 0);
  std::vector<std::int16_t> votes(merge > 1 ? count : 0, 0);
  for (int k = 0; k < map.height; ++k) {
    for (int i = 0; i < map.width; ++i) {
      const std::size_t at = grid.index(i / merge, k / merge);
      const CellState state = map.at(i, k);
      if (state == CellState::kOccupied) grid.occupied[at] = 1;
      if (merge == 1) {
        grid.free[at] = state == CellState::kFree;
      } else {
        votes[at] = static_cast<std::int16_t>(votes[at] + (state == CellState::kFree ? 1 : -1));
      }
    }
  }
  for (std::size_t i = 0; i < votes.size(); ++i) grid.free[i] = votes[i] >= 0 && !grid.occupied[i];
  return grid;
}

MapGrid make_map_grid(const TrinaryMap& map) {
  MapGrid grid = make_map_cells(map);
  fill_distances(grid);
  return grid;
}

}  // namespace phasescan
