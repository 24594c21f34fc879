/// Occupancy from rays: log-odds per cell, tiles that come into being where rays go.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <utility>

#include "phasescan/core/pose2.hpp"
#include "phasescan/map/trinary_map.hpp"
#include "phasescan/scan/scan.hpp"

namespace phasescan {

/// Cells in an unbounded plane. Cell (i, k) covers [i, i+1) x [k, k+1) times the resolution; its value is a log-odds.
class OccupancyGrid {
 public:
  static constexpr int kTileCells = 64;

  /// @throws std::invalid_argument for a resolution that is not above 0.
  explicit OccupancyGrid(const OccupancyOptions& options = {});
  /// The grid that is moved from is empty afterwards and can be drawn on again.
  OccupancyGrid(OccupancyGrid&& other) noexcept;
  OccupancyGrid& operator=(OccupancyGrid&& other) noexcept;

  /// Marks the rays of a scan: free from the laser to each hit, the hit's cell occupied once per scan.
  ///
  /// A missing beam says little: glass and black surfaces return nothing either. It marks weakly, and only as far as 80
  /// % of the shorter of its two neighbouring hits (at most 5 beams away).
  /// @param T_map_laser  pose of the laser at the first beam
  /// @param twist        motion of the laser during the turn, for scans with a time_increment
  void add_scan(const Scan& scan, const Pose2& T_map_laser, const Twist2& twist = {});

  /// Takes in what a later drive saw. What was known of a cell fades by as much as the later drive knows of it: where
  /// that alone makes a cell free or occupied, nothing is left. @param later  of the same resolution
  void update_with(const OccupancyGrid& later);

  /// Log-odds of a cell; 0 where nothing is known.
  double log_odds(int i, int k) const;
  bool known(int i, int k) const { return cell(i, k) != kUnknown; }
  int cell_of(double metres) const;
  double resolution() const { return options_.resolution_m; }

  struct Bounds {
    int min_i = 0, min_k = 0, max_i = -1, max_k = -1;  ///< inclusive; empty if max < min
  };
  /// The smallest rectangle that holds every known cell.
  Bounds bounds() const;

  /// Distance from a point along a direction to the first cell whose log-odds reach `occupied`, or nothing within
  /// `max_range`.
  std::optional<double> raycast(const Eigen::Vector2d& from, double direction, double max_range,
                                double occupied = 0.6) const;

  void clear();

 private:
  static constexpr std::int8_t kUnknown = -128;
  using Tile = std::array<std::int8_t, kTileCells * kTileCells>;
  std::int8_t cell(int i, int k) const;
  void change(int i, int k, int steps);
  Tile& tile(int ti, int tk);

  OccupancyOptions options_;
  int hit_ = 0, miss_ = 0, missing_ = 0, clamp_ = 0;
  std::map<std::pair<int, int>, std::unique_ptr<Tile>> tiles_;
  // The tile touched last: rays stay in one for a while.
  std::pair<int, int> last_{0, 0};
  Tile* last_tile_ = nullptr;
};

/// Cells with a probability of at least 0.65 are occupied, of at most 0.196 free, others and unseen ones unknown;
/// `margin` unknown cells all around.
TrinaryMap make_trinary(const OccupancyGrid& grid, int margin = 4);

}  // namespace phasescan
