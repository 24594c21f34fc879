// A plugged-in lidar: poses as they come. With no argument scans that are made here; else PORT (auto, /dev/ttyUSB0,
// tcp:HOST:PORT). Ctrl-C ends.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <exception>
#include <memory>
#include <phasescan/live/live.hpp>
#include <phasescan/slam/slam.hpp>
#include <string>
#include <thread>
#include <vector>

using namespace phasescan;

namespace {

volatile std::sig_atomic_t stopped = 0;

// A sensor that drives along a room of 6 m x 4 m and turns, twenty scans: what a source of one's own looks like.
class DriveThroughRoom : public live::LiveSource {
 public:
  void run(const std::function<bool()>& stop, const std::function<void(live::LiveScan)>& hand,
           const std::function<void(const std::string&)>& tell) override {
    tell("no port named: scans are made here");
    for (int k = 0; k < 20 && !stop(); ++k) {
      const Pose2 pose{0.05 * k, 0.0, deg_to_rad(3.0 * k)};
      std::vector<float> ranges;
      for (int beam = 0; beam < 360; ++beam) {
        const double angle = pose.theta + deg_to_rad(beam), dx = std::cos(angle), dy = std::sin(angle);
        const double to_x = ((dx > 0 ? 4.0 : -2.0) - pose.x) / dx, to_y = std::abs((dy > 0 ? 2.5 : -1.5) / dy);
        ranges.push_back(static_cast<float>(std::min(to_x, to_y)));
      }
      live::LiveScan scan;
      scan.measurement.scan =
          make_scan(ranges, {.angle_increment = deg_to_rad(1), .range_min = 0.1, .range_max = 12.0});
      scan.measurement.scan.stamp = stamp_from_seconds(0.1 * k);
      scan.arrived_ns = std::chrono::steady_clock::now().time_since_epoch() / std::chrono::nanoseconds(1);
      hand(std::move(scan));
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
  }
  bool can_wait() const override { return true; }  // a sensor cannot: a scan that comes too fast is left out
};

}  // namespace

int main(int argc, char** argv) try {
  std::signal(SIGINT, [](int) { stopped = 1; });
  std::unique_ptr<live::LiveSource> source;
  if (argc > 1)
    source = live::open_sensor(argv[1], "", "");
  else
    source = std::make_unique<DriveThroughRoom>();
  Slam slam(SlamOptions{}, Schedule::kLatest);
  Pose2 last;
  const live::LiveSummary summary = live::run_live(
      *source, slam, [] { return stopped != 0; },
      [&](const live::LiveUpdate& update) {
        last = update.update.T_map_base();
        std::printf("%10.3f s  %-12s x %6.2f m  y %6.2f m  %5.1f ms late\n", stamp_to_seconds(update.update.stamp),
                    to_string(update.update.status), last.x, last.y, update.latency_ms);
      },
      [](const std::string& line) { std::fprintf(stderr, "%s\n", line.c_str()); });
  std::printf("%llu scans\n", static_cast<unsigned long long>(summary.scans));
  return argc > 1 || (summary.scans == 20 && std::abs(last.x - 0.95) < 0.05) ? 0 : 1;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 3;
}
