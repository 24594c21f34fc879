/// The finished map against its own scans: what one visit saw against what others saw of the same place.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "map/glass.hpp"

namespace phasescan {

/// Of the beams that meet what other visits know: shares by what they say of it, 0 to 1.
struct VisitShares {
  double crossed = 0.0;  ///< went through a wall and on for 0.6 m or more
  double doubled = 0.0;  ///< ended 0.25 to 0.6 m before or behind the wall: it stands there twice
  double in_free = 0.0;  ///< ended where others looked through

  double against() const { return crossed + doubled + in_free; }
};

/// Scans compared with visits that are near on the way (what sensor, people and the grid leave open: the base level),
/// and with those that are far.
struct VisitComparison {
  std::size_t scans = 0;          ///< with enough beams in common with others to say something
  VisitShares mean;               ///< over these
  VisitShares worst;              ///< over the five in a row that are worst: a whole room, not a door
  VisitShares tail;               ///< mean of the twentieth of all fives in a row that is worst: grows with no length
  std::size_t worst_scan = 0;     ///< the middle one of them, as a number of the scans checked
  std::size_t contradicting = 0;  ///< scans of which a third and more of the beams crossed walls or ended in the free
  std::size_t doubling = 0;       ///< and of which a third and more saw walls twice
};

struct MapCheck {
  VisitComparison near, far;
};

/// @param scan_of  gives the k-th of `count` scans where it stands on the map; asked for once, in order
/// @param way_m    way of the robot up to each of them [m]
/// @cost  about 60 rays a scan through cells of 10 cm, twice
MapCheck check_map(std::size_t count, const std::function<PlacedScan(std::size_t)>& scan_of,
                   const std::vector<double>& way_m);

}  // namespace phasescan
