/// A map as map_server knows it, the surfaces in it that most beams do not see, and the options of making them:
/// sections `map` and `glass`.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "phasescan/core/options.hpp"
#include "phasescan/core/pose2.hpp"

namespace phasescan {

enum class CellState : std::int8_t { kUnknown = -1, kFree = 0, kOccupied = 100 };

struct TrinaryMap {
  int width = 0;   ///< cells along x
  int height = 0;  ///< cells along y
  double resolution_m = 0.05;
  Pose2 origin;                  ///< pose of the lower-left corner of cell (0, 0) on the map
  std::vector<CellState> cells;  ///< row-major from the lower left: cells[k * width + i]

  CellState at(int i, int k) const {
    return cells[static_cast<std::size_t>(k) * static_cast<std::size_t>(width) + static_cast<std::size_t>(i)];
  }
};

/// Glass answers beams that meet it head on only, black surfaces those from near only.
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

/// How rays change cells. Log-odds are kept in steps of 1/20 (8 bits a cell).
struct OccupancyOptions {
  double resolution_m = 0.05;
  double max_ray_m = 30.0;  ///< free space farther along a ray is not marked; hits beyond are left out
  double hit_log_odds = 0.9;
  double miss_log_odds = -0.4;
  double missing_log_odds = -0.1;  ///< of a beam that came back from nowhere, short of what its neighbours saw
  double clamp_log_odds = 5.0;     ///< so that a cell can change its mind
  bool update = false;             ///< a later drive says more than those before it

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("resolution_m", self.resolution_m, OptionInfo{"m", "size of a map cell", 0.005, 1});
    v("max_ray_m", self.max_ray_m, OptionInfo{"m", "rays are drawn no farther", 0.5, 200});
    v("hit_log_odds", self.hit_log_odds, OptionInfo{"", "what a hit adds to its cell", 0.05, 5});
    v("miss_log_odds", self.miss_log_odds, OptionInfo{"", "what a ray adds to the cells it crosses", -5, -0.05});
    v("missing_log_odds", self.missing_log_odds,
      OptionInfo{"", "what a beam without a return adds, short of its neighbours' hits", -5, 0});
    v("clamp_log_odds", self.clamp_log_odds, OptionInfo{"", "no cell is surer than this", 0.5, 6});
    v("update", self.update,
      OptionInfo{"", "where a later drive looked, what earlier ones saw fades: the map shows what stands there now"});
  }
};

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

}  // namespace phasescan
