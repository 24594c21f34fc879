/// Floor plans by kind of building.
#pragma once

#include "sim/floor_plan.hpp"

namespace phasescan::sim {

FloorPlan plan_room(Random& random);
FloorPlan plan_office(Random& random);
FloorPlan plan_corridor(Random& random);
FloorPlan plan_flat(Random& random);
FloorPlan plan_hall(Random& random);
FloorPlan plan_building(Random& random);

}  // namespace phasescan::sim
