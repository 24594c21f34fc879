#include "live_sources.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <filesystem>
#include <future>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "core/random.hpp"
#include "io/cut_log.hpp"
#include "sim/drive.hpp"
#include "sim/pairs_spec.hpp"
#include "sim/world_kinds.hpp"

namespace phasescan::app {
namespace {

std::int64_t steady_ns() {
  return std::chrono::steady_clock::now().time_since_epoch().count();
}

/// Waits for the moments at which scans were taken. A pause of the log is cut short. Any thread may set the speed.
class Pace {
 public:
  void set_speed(double speed) {
    const std::lock_guard lock(mutex_);
    rebase();
    speed_ = speed;
  }
  double speed() const {
    const std::lock_guard lock(mutex_);
    return speed_;
  }
  /// The next scan is due at once, whenever it was taken.
  void skip_to(Stamp stamp) {
    const std::lock_guard lock(mutex_);
    base_stamp_ = stamp;
    base_ns_ = steady_ns();
  }
  /// False where `stop` says so.
  bool wait_for(Stamp stamp, const std::function<bool()>& stop) {
    constexpr double kLongestNs = 2e9;
    {
      const std::lock_guard lock(mutex_);
      if (!base_stamp_) {
        base_stamp_ = stamp;
        base_ns_ = steady_ns();
      }
      rebase();
      if (static_cast<double>(stamp - *base_stamp_) > kLongestNs) base_stamp_ = stamp - static_cast<Stamp>(kLongestNs);
    }
    while (true) {
      if (stop()) return false;
      double left_ns = 1e9;
      {
        const std::lock_guard lock(mutex_);
        rebase();
        if (speed_ > 0.0) left_ns = static_cast<double>(stamp - *base_stamp_) / speed_;
      }
      if (left_ns <= 0.0) return true;
      std::this_thread::sleep_for(std::chrono::nanoseconds(static_cast<std::int64_t>(std::min(left_ns, 2e7))));
    }
  }

 private:
  /// Time goes on at the speed that was.
  void rebase() {
    const std::int64_t now = steady_ns();
    if (base_stamp_) *base_stamp_ += static_cast<Stamp>(speed_ * static_cast<double>(now - base_ns_));
    base_ns_ = now;
  }

  mutable std::mutex mutex_;
  double speed_ = 1.0;
  std::optional<Stamp> base_stamp_;  // where the log stands at base_ns_
  std::int64_t base_ns_ = 0;
};

class LogReplay final : public ReplaySource {
 public:
  LogReplay(std::string log, const LogOptions& options)
      : log_(std::move(log)), options_(options), reader_(open_log(log_, options)) {
    std::error_code ignored;
    again_ = std::filesystem::is_regular_file(log_, ignored) || std::filesystem::is_directory(log_, ignored);
  }
  ~LogReplay() override {
    ending_ = true;
    if (measuring_.joinable()) measuring_.join();
  }

  bool can_wait() const override { return true; }
  void set_speed(double speed) override { pace_.set_speed(speed); }
  bool seek(double share) override {
    if (!again_ || duration_ns_ <= 0) return false;
    sought_ns_ = static_cast<std::int64_t>(share * static_cast<double>(duration_ns_));
    return true;
  }
  serve::ReplayState state() const override {
    return {stamp_to_seconds(at_ns_), again_ ? stamp_to_seconds(duration_ns_) : 0.0, pace_.speed()};
  }
  void set_watched(std::function<bool()> watched) override { watched_ = std::move(watched); }

  void run(const std::function<bool()>& stop, const std::function<void(live::LiveScan)>& hand,
           const std::function<void(const std::string&)>&) override {
    if (again_ && watched_) measuring_ = std::thread([this] { measure(); });
    bool restarts = false;
    while (!stop()) {
      auto entry = reader_->next();
      if (!entry) {
        if (!wait_at_end(stop)) return;
        restarts = begin_again();
        continue;
      }
      RangeMeasurement measurement = to_measurement(std::move(*entry));
      const Stamp stamp = measurement.scan.stamp;
      if (!first_) first_ = stamp;
      if (!wait(stamp, stop)) return;
      if (goes_back(stamp)) {
        restarts = begin_again();
        continue;
      }
      at_ns_ = stamp - *first_;
      hand({std::move(measurement), steady_ns(), std::exchange(restarts, false)});
    }
  }

 private:
  static constexpr std::int64_t kNowhere = -1;

  /// Until the scan is due, or another place is asked for.
  bool wait(Stamp stamp, const std::function<bool()>& stop) {
    const std::int64_t sought = sought_ns_;
    if (sought != kNowhere && stamp - *first_ < sought && sought >= at_ns_) {
      pace_.skip_to(stamp);
      return true;
    }
    if (sought != kNowhere && sought >= at_ns_) {
      sought_ns_ = kNowhere;  // it is reached
      pace_.skip_to(stamp);
      return true;
    }
    return pace_.wait_for(stamp, [&] { return stop() || sought_ns_ != kNowhere; }) || !stop();
  }
  bool goes_back(Stamp) const { return sought_ns_ != kNowhere && sought_ns_ < at_ns_; }
  bool begin_again() {
    reader_ = open_log(log_, options_);
    at_ns_ = 0;
    return true;
  }
  /// False: nobody watches, or it is to stop.
  bool wait_at_end(const std::function<bool()>& stop) {
    constexpr std::int64_t kGraceNs = 10'000'000'000;  // a page that is loaded anew is away for a moment
    std::int64_t seen_ns = 0;
    while (!stop() && watched_) {
      if (watched_()) seen_ns = steady_ns();
      if (seen_ns == 0 || steady_ns() - seen_ns > kGraceNs) return false;
      if (sought_ns_ != kNowhere && sought_ns_ < at_ns_) return true;
      sought_ns_ = kNowhere;
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    return false;
  }
  /// How long the log is: read once to its end, beside what is shown.
  void measure() {
    try {
      const auto reader = open_log(log_, options_);
      std::optional<Stamp> first;
      while (auto entry = reader->next()) {
        if (ending_) return;
        const Stamp stamp = to_measurement(std::move(*entry)).scan.stamp;
        if (!first) first = stamp;
        length_ns_ = std::max<std::int64_t>(length_ns_, stamp - *first);
      }
      duration_ns_ = length_ns_;
    } catch (const std::exception&) {
      again_ = false;  // what is wrong with it is said by who shows it
    }
  }

  const std::string log_;
  const LogOptions options_;
  std::unique_ptr<LogReader> reader_;
  Pace pace_;
  std::optional<Stamp> first_;
  std::function<bool()> watched_;
  std::thread measuring_;
  std::atomic<bool> again_{false}, ending_{false};
  std::int64_t length_ns_ = 0;
  std::atomic<std::int64_t> at_ns_{0}, duration_ns_{0}, sought_ns_{kNowhere};
};

/// An hour's way takes a second to plan: the first round of it, which is the same, is driven meanwhile.
class DemoSource final : public live::LiveSource {
 public:
  explicit DemoSource(std::uint64_t seed) : seed_(seed), drive_(drive_of(seed, 0.0)) {}
  void run(const std::function<bool()>& stop, const std::function<void(live::LiveScan)>& hand,
           const std::function<void(const std::string&)>& tell) override {
    tell("a simulated RPLIDAR A1 in a simulated flat");
    whole_ = std::async(std::launch::async, [this] { return drive_of(seed_, kDuration_s); });
    Pace pace;
    while (auto scan = next()) {
      if (!pace.wait_for(scan->entry.scan.stamp, stop)) return;
      hand({to_measurement(std::move(scan->entry)), steady_ns()});
    }
  }

 private:
  static constexpr double kDuration_s = 3600.0;

  /// @param duration_s  0: one round
  static std::unique_ptr<sim::Drive> drive_of(std::uint64_t seed, double duration_s) {
    const sim::World world = sim::make_world(sim::WorldKind::kFlat, seed);
    sim::PathOptions path;
    path.duration_s = duration_s;
    return std::make_unique<sim::Drive>(world, sim::read_lidar("rplidar-a1"),
                                        sim::Path(world, path, Random::derive(seed, 1)), sim::DriveOptions{},
                                        Random::derive(seed, 2));
  }

  std::optional<sim::DriveScan> next() {
    if (whole_.valid() && whole_.wait_for(std::chrono::seconds(0)) == std::future_status::ready) take_whole();
    auto scan = drive_->next();
    if (!scan && whole_.valid()) {
      take_whole();
      scan = drive_->next();
    }
    ++given_;
    return scan;
  }

  void take_whole() {
    drive_ = whole_.get();
    for (std::size_t i = 0; i < given_; ++i) drive_->next();
  }

  std::uint64_t seed_;
  std::unique_ptr<sim::Drive> drive_;
  std::future<std::unique_ptr<sim::Drive>> whole_;
  std::size_t given_ = 0;
};

/// Scans of a sensor cut down as those of a log are.
class CutSource final : public live::LiveSource {
 public:
  CutSource(std::unique_ptr<live::LiveSource> source, LogOptions options)
      : source_(std::move(source)), options_(std::move(options)) {}
  void run(const std::function<bool()>& stop, const std::function<void(live::LiveScan)>& hand,
           const std::function<void(const std::string&)>& tell) override {
    source_->run(
        stop,
        [&](live::LiveScan scan) {
          scan.measurement.scan = cut_scan(scan.measurement.scan, options_);
          hand(std::move(scan));
        },
        tell);
  }
  bool can_wait() const override { return source_->can_wait(); }

 private:
  std::unique_ptr<live::LiveSource> source_;
  LogOptions options_;
};

}  // namespace

std::unique_ptr<live::LiveSource> sensor_source(const std::string& port, const std::string& sensor,
                                                const std::string& raw, LogOptions options) {
  const bool file = live::find_sensor(sensor) == nullptr && std::filesystem::is_regular_file(sensor);
  if (file) {
    const sim::LidarOptions lidar = sim::read_lidar(sensor);
    options.range_min = std::max(options.range_min, lidar.range_min_m);
    options.range_max = options.range_max > 0.0 ? std::min(options.range_max, lidar.range_max_m) : lidar.range_max_m;
  }
  auto source = live::open_sensor(port, file ? "" : sensor, raw);
  if (!cuts_anything(options)) return source;
  return std::make_unique<CutSource>(std::move(source), std::move(options));
}

std::unique_ptr<ReplaySource> replay_source(const std::string& log, const LogOptions& options) {
  return std::make_unique<LogReplay>(log, options);
}
std::unique_ptr<live::LiveSource> demo_source(std::uint64_t seed) {
  return std::make_unique<DemoSource>(seed);
}

}  // namespace phasescan::app
