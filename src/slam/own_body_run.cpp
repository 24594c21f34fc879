// The robot's own body in the view of its lasers: once it is found, all is done again without it.
#include <utility>

#include "slam/slam_impl.hpp"

namespace phasescan {
namespace {

// Scans that are held until it is known whether the robot is in the laser's view: minutes of driving.
constexpr std::size_t kMostHeld = 3000;

}  // namespace

/// @return true where this scan showed that the robot itself is in the view of its laser
bool Slam::Impl::look_for_body(const RangeMeasurement& measurement, bool repeated) {
  OwnBodyState& body = state.bodies[measurement.laser];
  if (body.decided && state.beginning.empty()) return false;
  const ScanId scan = next_scan();
  if (state.beginning.size() == static_cast<std::size_t>(scan - session_begin()) &&
      state.beginning.size() < kMostHeld) {
    state.beginning.push_back({measurement, repeated});
    state.beginning.back().measurement.scan.intensities.clear();
  } else {
    state.beginning = {};
  }
  if (repeated || !own_body.add(measurement.scan, body) || body.sectors.empty()) return false;
  const OddityNote note{"own body", false,
                        "the robot itself is seen in " + format_sectors(body.sectors) +
                            " of the laser's frame, whatever the scene; these beams are left out"};
  take_note(scan, note);
  return true;
}

/// All measurements of the session once more, without the beams that see the robot: it held the poses.
ScanUpdate Slam::Impl::begin_anew() {
  runner->wait();
  SlamState::Data fresh = state.session_start ? *state.session_start : SlamState::Data{};
  tracker = CheckedTracker(options.odometry, {}, {}, options.match);
  runner = std::make_unique<BackendRunner>(options, std::exchange(fresh.backend, {}), schedule, executor);
  runner->set_pending(std::exchange(fresh.pending, nullptr));
  fresh.session_start = std::move(state.session_start);
  fresh.input = std::move(state.input);
  fresh.bodies = std::move(state.bodies);
  fresh.beginning = std::move(state.beginning);
  state = std::move(fresh);
  packed.clear();  // the ledger of a checkpoint is whole
  kept = {-1, nullptr, nullptr};
  ScanUpdate update;
  for (const HeldMeasurement& held : state.beginning) update = track_scene(held.measurement, held.repeated);
  return update;
}

/// Tracks what is no part of the robot.
ScanUpdate Slam::Impl::track_scene(const RangeMeasurement& measurement, bool repeated) {
  const std::vector<BodySector>& sectors = state.bodies[measurement.laser].sectors;
  if (sectors.empty()) return track(measurement, repeated);
  RangeMeasurement scene = measurement;
  scene.scan = without_sectors(measurement.scan, sectors);
  return track(scene, repeated);
}

}  // namespace phasescan
