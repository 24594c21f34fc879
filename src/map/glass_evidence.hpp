// What all scans say of a line, piece by piece: whether glass or something black is on it.
#pragma once

#include <array>
#include <vector>

#include "map/glass_candidates.hpp"
#include "map/view_rays.hpp"

namespace phasescan {

class GlassEvidence {
 public:
  GlassEvidence(const GlassCandidate& candidate, const GlassOptions& options);

  /// @param range_max  of the sensor, or the longest it is known to see [m]
  void add(const std::vector<ViewRay>& rays, double range_max, const OccupancyGrid& grid);
  /// The panes on the line.
  std::vector<GlassPane> panes() const;

 private:
  static constexpr std::size_t kShells = 40;  // of 25 cm
  /// 10 cm of the line. Counts of beams; `scans` of scans.
  struct Bin {
    int facing_hits = 0, facing_open = 0;           // head on: answered, went on
    int oblique_hits = 0;                           // of any scan
    int oblique_through = 0, oblique_vanished = 0;  // of scans that were answered head on elsewhere on the line
    int oblique_scans = 0;                          // of those
    int hits = 0, through = 0;                      // at whatever angle
    int expected = 0, expected_scans = 0;           // vanished though something known stands behind
    std::array<int, kShells> hits_at{}, vanished_at{}, scans_at{};  // by range; vanished: with the wall seen beside it
    void pool(const Bin& o);
    int vanished() const;
  };
  struct Witness {
    double place = 0.0;            // of the sensor along the line
    double low = 0.0, high = 0.0;  // where it was answered head on, or where beams vanished
  };
  struct Met {
    Meeting at;
    double incidence = 0.0;  ///< [rad]
    const ViewRay* ray = nullptr;
    std::size_t bin = 0;
  };

  void count_facing(double range_max);
  void count_gap(double range_max, const OccupancyGrid& grid);
  Bin pooled(std::size_t i) const;
  bool is_glass(const Bin& bin) const;
  bool is_black(std::size_t i) const;
  bool answers_near_only(const Bin& bin) const;
  bool passable(const Bin& bin) const;
  GlassPane pane(std::size_t from, std::size_t to) const;
  void grow(std::size_t& from, std::size_t& to) const;
  Eigen::Vector2d at(double place) const { return candidate_.line.at + place * candidate_.line.along; }

  GlassCandidate candidate_;
  GlassOptions options_;
  double start_ = 0.0;  // of the first bin
  std::vector<Bin> bins_;
  std::vector<Met> met_;
  std::vector<Witness> witnesses_;
  double range_max_ = 0.0;  // of the sensor that sees farthest
};

}  // namespace phasescan
