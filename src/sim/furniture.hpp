/// What stands in rooms, as a lidar 20-30 cm above the floor sees it.
#pragma once

#include <vector>

#include "core/random.hpp"
#include "sim/world.hpp"

namespace phasescan::sim {

/// A thing in its own frame: centred at the origin, its back at -y, `width` along x and `depth` along y [m].
struct Item {
  Shape shape;
  double width = 0.0;
  double depth = 0.0;
};

enum class ItemKind {
  kCupboard,
  kShelf,
  kBed,
  kSofa,
  kTable,
  kDesk,
  kOfficeChair,
  kBin,
  kClutter,
  kPlant,
  kRadiator,
  kCurtain,
  kBath,
  kPartition,
  kMachine,
  kPallet,
  kRack
};

/// Makes a thing of a kind, with sizes, materials and untidiness drawn.
Item make_item(ItemKind kind, Random& random);

/// A standing person: two legs, or a trunk.
Shape make_person(Random& random);

/// A footprint on the floor: a rectangle anywhere, at any angle.
struct Footprint {
  Pose2 T_room_item;
  double width = 0.0;
  double depth = 0.0;
};

/// True where two footprints, the first widened by `margin` [m] on every side, overlap (separating axes).
bool footprints_overlap(const Footprint& a, const Footprint& b, double margin);

}  // namespace phasescan::sim
