/// The localiser of the library as what the localisation node asks for.
#pragma once

#include <memory>

#include "phasescan/localize/options.hpp"
#include "phasescan/odometry/options.hpp"
#include "ros2/parameters.hpp"
#include "ros2/pose_finder.hpp"

namespace phasescan::ros2 {

class LocalizerFinders final : public PoseFinderFactory {
 public:
  /// Sections `localize` and `odometry`. What is changed while the node runs counts from the next map on.
  void add_parameters(ParameterTable& table) {
    table.add("localize.", localize_, true);
    table.add("odometry.", odometry_, true);
  }
  std::unique_ptr<PoseFinder> make(const TrinaryMap& map) override;

 private:
  LocalizeOptions localize_;
  OdometryOptions odometry_;
};

}  // namespace phasescan::ros2
