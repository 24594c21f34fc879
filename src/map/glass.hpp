/// Surfaces that most beams do not see: glass, which answers head on only, and black ones, which answer from near only.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "phasescan/core/options.hpp"
#include "phasescan/core/pose2.hpp"
#include "map/occupancy_grid.hpp"
#include "phasescan/map/trinary_map.hpp"
#include "phasescan/scan/scan.hpp"

namespace phasescan {

/// Section `glass`.
struct GlassOptions {
  bool enabled = true;
  bool block = true;
  int min_views = 4;
  double min_length_m = 0.4;
  double facing_deg = 8.0;
  double oblique_deg = 28.0;
  double keep_open_m = 0.5;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("enabled", self.enabled, OptionInfo{"", "look for glass and black surfaces in the finished map"});
    v("block", self.block, OptionInfo{"", "what is surely glass or black is occupied in map.pgm"});
    v("min_views", self.min_views, OptionInfo{"", "scans that must show a surface for it to be sure", 2, 1000});
    v("min_length_m", self.min_length_m, OptionInfo{"m", "shorter ones are left out", 0.1, 20});
    v("facing_deg", self.facing_deg, OptionInfo{"deg", "a beam meets a surface head on up to this incidence", 1, 20});
    v("oblique_deg", self.oblique_deg,
      OptionInfo{"deg", "and obliquely from this one on; glass does not answer there", 10, 60, false, "facing_deg"});
    v("keep_open_m", self.keep_open_m,
      OptionInfo{"m", "nothing is claimed so near to where the robot drove through", 0, 5});
  }
};

enum class GlassKind : std::uint8_t {
  kGlass,  ///< answered head on, was looked through obliquely
  kBlack,  ///< swallows beams: nothing came back, though there is something behind it, or it answered from near or head
           ///< on
};

/// A straight piece of such a surface, frame of the map [m].
struct GlassPane {
  Eigen::Vector2d a, b;
  GlassKind kind = GlassKind::kGlass;
  bool sure = false;         ///< enough views, from places far enough apart
  std::size_t views = 0;     ///< scans that show it
  std::size_t hits = 0;      ///< beams that it answered
  std::size_t through = 0;   ///< beams that ended behind it
  std::size_t vanished = 0;  ///< beams that should have come back and did not

  double length() const { return (b - a).norm(); }
};

/// A scan where it stands on the map, as OccupancyGrid::add_scan takes it.
struct PlacedScan {
  Scan scan;
  Pose2 T_map_laser;  ///< at the first beam
  Twist2 twist;       ///< of the laser during the turn
};

/// Looks for panes in scans at their final poses.
///
/// Glass: over several scans hits lie on one line, each only at the foot of that scan's perpendicular, while in the
/// same scan beams that meet the line obliquely go through or vanish, and no scan sees the same spot obliquely. People,
/// doors that moved and a torn map do not do that: it is the same scan that hits and passes. Black: between two pieces
/// of one wall beams vanish that should have met what is known to stand behind, or that did come back from nearer by. A
/// gap behind which nothing is known (a doorway to a hall larger than the sensor's range) is never claimed.
///
/// @param scan_of  gives the k-th of `count` scans; asked for twice, in order
/// @param grid     the map of the same scans
/// @return sorted by the order in which they were first seen
/// @cost   O(beams) per scan, and per scan and candidate in its reach
std::vector<GlassPane> find_glass(std::size_t count, const std::function<PlacedScan(std::size_t)>& scan_of,
                                  const OccupancyGrid& grid, const GlassOptions& options = {});

/// Cuts out of the panes what is nearer than `keep_open_m` to a place where the way crosses them.
std::vector<GlassPane> cut_where_driven(std::vector<GlassPane> panes, std::span<const Pose2> way, double keep_open_m,
                                        double min_length_m);

/// Cells of a map that a pane lies on, as indices into its `cells`; each once, sorted.
std::vector<std::size_t> cells_of(const TrinaryMap& map, const GlassPane& pane);

}  // namespace phasescan
