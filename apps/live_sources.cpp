#include "live_sources.hpp"

#include <algorithm>
#include <chrono>
#include <optional>
#include <thread>

#include "core/random.hpp"
#include "sim/drive.hpp"
#include "sim/pairs_spec.hpp"
#include "sim/world_kinds.hpp"

namespace phasescan::app {
namespace {

std::int64_t steady_ns() {
  return std::chrono::steady_clock::now().time_since_epoch().count();
}

/// Waits for the moments at which scans of a log were taken. A pause of the log is cut short.
class Pace {
 public:
  /// False where it is to stop.
  bool wait_for(Stamp stamp, const std::function<bool()>& stop) {
    constexpr Stamp kLongest = 2'000'000'000;
    if (before_)
      due_ns_ += std::clamp<Stamp>(stamp - *before_, 0, kLongest);
    else
      due_ns_ = steady_ns();
    before_ = stamp;
    while (steady_ns() < due_ns_) {
      if (stop()) return false;
      std::this_thread::sleep_for(std::chrono::nanoseconds(std::min<std::int64_t>(due_ns_ - steady_ns(), 20'000'000)));
    }
    return !stop();
  }

 private:
  std::optional<Stamp> before_;
  std::int64_t due_ns_ = 0;
};

class ReplaySource final : public live::LiveSource {
 public:
  explicit ReplaySource(std::unique_ptr<LogReader> reader) : reader_(std::move(reader)) {}
  void run(const std::function<bool()>& stop, const std::function<void(live::LiveScan)>& hand,
           const std::function<void(const std::string&)>&) override {
    Pace pace;
    while (auto entry = reader_->next()) {
      RangeMeasurement measurement = to_measurement(std::move(*entry));
      if (!pace.wait_for(measurement.scan.stamp, stop)) return;
      hand({std::move(measurement), steady_ns()});
    }
  }

 private:
  std::unique_ptr<LogReader> reader_;
};

class DemoSource final : public live::LiveSource {
 public:
  explicit DemoSource(std::uint64_t seed) : drive_(drive_of(seed)) {}
  void run(const std::function<bool()>& stop, const std::function<void(live::LiveScan)>& hand,
           const std::function<void(const std::string&)>& tell) override {
    tell("a simulated RPLIDAR A1 in a simulated flat");
    Pace pace;
    while (auto scan = drive_.next()) {
      if (!pace.wait_for(scan->entry.scan.stamp, stop)) return;
      hand({to_measurement(std::move(scan->entry)), steady_ns()});
    }
  }

 private:
  static sim::Drive drive_of(std::uint64_t seed) {
    const sim::World world = sim::make_world(sim::WorldKind::kFlat, seed);
    sim::PathOptions path;
    path.duration_s = 3600.0;
    return sim::Drive(world, sim::read_lidar("rplidar-a1"), sim::Path(world, path, Random::derive(seed, 1)), {},
                      Random::derive(seed, 2));
  }
  sim::Drive drive_;
};

}  // namespace

std::unique_ptr<live::LiveSource> replay_source(const std::string& log, const LogOptions& options) {
  return std::make_unique<ReplaySource>(open_log(log, options));
}
std::unique_ptr<live::LiveSource> demo_source(std::uint64_t seed) {
  return std::make_unique<DemoSource>(seed);
}

}  // namespace phasescan::app
