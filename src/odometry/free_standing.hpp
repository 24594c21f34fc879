/// Narrow objects that stand free: pillars and chairs to localise by, or people who walk by, ahead or behind.
///
/// A person who leads or follows the robot stays where it is in the robot's view, scan after scan; along a bare
/// corridor nothing but that person tells how far the robot drove, and tells it wrongly. What is static is seen at the
/// same place again after the robot has moved; what moves with the robot would by then have moved as far as it did.
#pragma once

#include <cstdint>
#include <vector>

#include "phasescan/core/pose2.hpp"
#include "scan/surface.hpp"

namespace phasescan {

/// Marks the hits on something narrow with farther surfaces, or nothing, to both sides of it: out[i] = 1 for hit i.
/// The ends of a view of less than the full circle are open. None is marked where most of the hits would be.
/// @cost O(hits)
void mark_free_standing(const SurfacePoints& surface, std::vector<std::uint8_t>& out);

/// A hit on such an object, seen from one of several poses.
struct FreeStandingHit {
  float x = 0, y = 0;            ///< in the frame of the map [m]
  float base_x = 0, base_y = 0;  ///< in the frame of the robot that saw it [m]
  int view = 0;                  ///< index of the pose it was seen from
};

/// Which of them are static: out[i] = 1 if hit i was met by one of another view from which an object that moves with
/// the robot would have been seen elsewhere.
/// @param poses  T_map_base by view
/// @cost O(hits * views) at worst, a few lookups a hit as a rule
class StaticObjectFilter {
 public:
  void find(const std::vector<FreeStandingHit>& hits, const std::vector<Pose2>& poses, std::vector<std::uint8_t>& out);

 private:
  struct View {
    float cos, sin, x, y;
  };
  struct Cell {
    std::int32_t u, v;
  };
  std::vector<View> views_;
  std::vector<Cell> cells_;                 // of the hits
  std::vector<std::int32_t> heads_, next_;  // hits by cell, as chains
  std::vector<std::int32_t> first_;         // the hit that stands for this one
};

}  // namespace phasescan
