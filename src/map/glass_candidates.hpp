// Lines on which glass or black surfaces may lie, from single scans put together.
#pragma once

#include <vector>

#include "map/view_rays.hpp"

namespace phasescan {

struct GlassCandidate {
  LineSums sums;
  MapLine line;
  double low = 0.0, high = 0.0;  ///< of what was seen, along the line
  std::size_t views = 0;
  bool gap = false;  ///< between two pieces of a wall beams vanish; else: a piece that is seen head on only
};

/// Puts together what single scans show.
class GlassCandidates {
 public:
  explicit GlassCandidates(const GlassOptions& options) : options_(options) {}
  void add(const std::vector<ViewRay>& rays, double step_rad);
  /// Those that enough scans showed.
  std::vector<GlassCandidate> take();

 private:
  struct Piece {
    int first = 0, last = 0;
    LineSums sums;
    MapLine line;
  };
  void find_pieces(const std::vector<ViewRay>& rays, double step_rad);
  void split(const std::vector<ViewRay>& rays, std::size_t from, std::size_t to);
  void look_for_facet(const std::vector<ViewRay>& rays, const Piece& piece);
  void look_for_gap(const std::vector<ViewRay>& rays, const Piece& before, const Piece& after);
  void put(const LineSums& sums, const Eigen::Vector2d& from, const Eigen::Vector2d& to, bool gap);

  GlassOptions options_;
  std::vector<Piece> pieces_;
  std::vector<int> run_;
  std::vector<GlassCandidate> found_;
};

}  // namespace phasescan
