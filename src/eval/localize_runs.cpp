#include "eval/localize_runs.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

#include "eval/localize_bench.hpp"
#include "phasescan/core/time.hpp"
#include "sim/drive.hpp"
#include "sim/path.hpp"
#include "sim/rearrange.hpp"

namespace phasescan {
namespace {

constexpr double kWrongMapM = 0.1;
constexpr double kWayM = 2.0;                                    // after which a robot should know its place again
constexpr double kElsewhereM = 3.0;                              // a kidnapped robot is carried at least so far
constexpr double kWrongM = 0.5, kWrongRad = 10.0 * kPi / 180.0;  // another place, not an inexact pose

bool is_elsewhere(const Pose2& a, const Pose2& b) {
  return translation_distance(a, b) > kWrongM || angle_distance(a.theta, b.theta) > kWrongRad;
}

/// Follows one localizer from a moment when it knew nothing, or was carried away.
class StartWatch {
 public:
  explicit StartWatch(bool kidnapped) { start_.kidnapped = kidnapped; }

  /// @return false once the way is over
  bool add(const LocalizationUpdate& update, const Pose2& truth, double step_m) {
    const double t = stamp_to_seconds(update.stamp);
    if (!begun_) {
      begun_ = true;
      first_s_ = t;
      start_.first_ambiguous = update.status == TrackingStatus::kAmbiguous;
    } else {
      way_m_ += step_m;
    }
    const bool ok = update.status == TrackingStatus::kOk && update.T_map_base;
    const bool wrong = ok && is_elsewhere(*update.T_map_base, truth);
    if (wrong) {
      if (!wrong_since_) wrong_since_ = t;
      start_.wrong_ok_s = std::max(start_.wrong_ok_s, t - *wrong_since_);
    } else {
      wrong_since_.reset();
    }
    if (!wrong && !noticed_) {
      noticed_ = true;
      start_.noticed_s = t - first_s_;
    }
    if (way_m_ > kWayM) return false;
    if (!start_.recovered && ok && is_right(*update.T_map_base, truth)) {
      start_.recovered = true;
      start_.recovered_s = t - first_s_;
    }
    if (!noticed_) start_.noticed_s = t - first_s_;
    return true;
  }
  const UnknownStart& start() const { return start_; }

 private:
  UnknownStart start_;
  bool begun_ = false, noticed_ = false;
  double way_m_ = 0.0, first_s_ = 0.0;
  std::optional<double> wrong_since_;
};

/// One that was switched on in the middle of a drive.
struct FreshStart {
  Localizer localizer;
  StartWatch watch;
};

class DriveFollower {
 public:
  DriveFollower(const MappedWorld& world, const LocalizationMap& map, const LocalizeRunsSpec& spec,
                const LocalizeOptions& options, LocalizeRunsScore& score,
                const std::function<void(const DrivenScan&)>& each)
      : world_(world),
        map_(map),
        spec_(spec),
        options_(options),
        score_(score),
        each_(each),
        localizer_(map, options) {}

  void run(const sim::LidarOptions& lidar, std::uint64_t seed) {
    Random random(seed);
    for (std::size_t segment = 0, tries = 0; segment <= spec_.kidnaps && tries < 10 * (spec_.kidnaps + 1); ++tries) {
      sim::PathOptions path;
      path.speed_mps = spec_.speed_mps;
      sim::DriveOptions drive_options;
      drive_options.people = spec_.people;
      const std::uint64_t own = Random::derive(seed, 10 + tries);
      sim::Drive drive(world_.world, lidar, sim::Path(world_.world, path, own), drive_options, own);
      const Pose2 first = world_.T_map_world * drive.path().pose_at(0.0);
      if (!stands_on_map(world_.map, first)) continue;
      if (segment > 0 && translation_distance(first, last_truth_) < kElsewhereM) continue;
      begin(segment++ > 0);
      follow(drive, -std::log(std::max(1e-9, random.uniform())) / spec_.kidnaps_per_m);
    }
    if (watch_) score_.starts.push_back(watch_->start());
  }

 private:
  void begin(bool kidnapped) {
    if (watch_) score_.starts.push_back(watch_->start());
    watch_.emplace(kidnapped);
    stamp_offset_ = last_stamp_;
    carried_ = true;
  }

  void follow(sim::Drive& drive, double way_m) {
    double way = 0.0, until_start = spec_.starts_every_m;
    while (auto scan = drive.next()) {
      const Pose2 truth = world_.T_map_world * scan->T_world_laser;
      const double step = carried_ ? 0.0 : translation_distance(truth, last_truth_);
      carried_ = false;
      way += step;
      until_start -= step;
      RangeMeasurement measurement = to_measurement(std::move(scan->entry));
      measurement.scan.stamp += stamp_offset_;
      last_stamp_ = measurement.scan.stamp;
      last_truth_ = truth;
      add(measurement, truth, step);
      if (spec_.starts_every_m > 0.0 && until_start <= 0.0 && stands_on_map(world_.map, truth)) {
        until_start = spec_.starts_every_m;
        fresh_.push_back(std::make_unique<FreshStart>(FreshStart{Localizer(map_, options_), StartWatch(false)}));
      }
      for (auto& one : fresh_) {
        if (one->watch.add(one->localizer.add(measurement), truth, step)) continue;
        score_.starts.push_back(one->watch.start());
        one.reset();
      }
      std::erase(fresh_, nullptr);
      if (way > way_m) break;
    }
    fresh_.clear();
    last_stamp_ += kPauseNs;
  }

  void add(const RangeMeasurement& measurement, const Pose2& truth, double step) {
    const double cpu = thread_cpu_seconds();
    const LocalizationUpdate update = localizer_.add(measurement);
    const double ms = 1e3 * (thread_cpu_seconds() - cpu);
    if (each_) each_({update, truth, stands_on_map(world_.map, truth), watch_.has_value()});
    if (watch_) {
      if (watch_->add(update, truth, step)) return;
      score_.starts.push_back(watch_->start());
      watch_.reset();
      lost_since_.reset(), wrong_since_.reset();
    }
    if (!update.searched) score_.cpu_ms.push_back(ms);
    count(update, truth, step);
  }

  void count(const LocalizationUpdate& update, const Pose2& truth, double step) {
    const double t = stamp_to_seconds(update.stamp);
    const bool ok = update.status == TrackingStatus::kOk && update.T_map_base;
    if (!stands_on_map(world_.map, truth)) {
      ++score_.off_map;
      score_.off_map_wrong_ok += ok && is_elsewhere(*update.T_map_base, truth);
      wrong_since_.reset(), lost_since_.reset();
      return;
    }
    ++score_.scans;
    score_.way_m += step;
    score_.ok += ok;
    score_.degraded += update.status == TrackingStatus::kDegraded;
    score_.ambiguous += update.status == TrackingStatus::kAmbiguous;
    score_.lost += update.status == TrackingStatus::kLost;
    if (update.T_map_base && update.status != TrackingStatus::kAmbiguous)
      score_.judgements.push_back({update.confidence, is_right(*update.T_map_base, truth)});
    if (ok) {
      const bool right = is_right(*update.T_map_base, truth);
      ++(right ? score_.right_ok : score_.wrong_ok);
      score_.errors_m.push_back(translation_distance(*update.T_map_base, truth));
    }
    stretch(ok && is_elsewhere(*update.T_map_base, truth), t, wrong_since_, score_.longest_wrong_ok_s);
    stretch(update.status == TrackingStatus::kLost || !update.T_map_base, t, lost_since_, score_.longest_lost_s);
  }

  static void stretch(bool on, double t, std::optional<double>& since, double& longest) {
    if (!on) {
      since.reset();
      return;
    }
    if (!since) since = t;
    longest = std::max(longest, t - *since);
  }

  static constexpr Stamp kPauseNs = 180'000'000;  // a scan later it is elsewhere
  const MappedWorld& world_;
  const LocalizationMap& map_;
  const LocalizeRunsSpec& spec_;
  const LocalizeOptions& options_;
  LocalizeRunsScore& score_;
  const std::function<void(const DrivenScan&)>& each_;
  Localizer localizer_;
  std::optional<StartWatch> watch_;
  std::vector<std::unique_ptr<FreshStart>> fresh_;
  Stamp stamp_offset_ = 0, last_stamp_ = 0;
  Pose2 last_truth_;
  bool carried_ = true;
  std::optional<double> lost_since_, wrong_since_;
};

}  // namespace

StartsScore score_of(const std::vector<UnknownStart>& starts) {
  constexpr double kLateS = 1.0;
  StartsScore score;
  double seconds = 0.0;
  for (const UnknownStart& start : starts) {
    score.wrong_ok_long += start.wrong_ok_s > kLateS;
    if (start.kidnapped) {
      ++score.kidnapped;
      score.noticed_late += start.noticed_s > kLateS;
      score.recovered += start.recovered;
      if (start.recovered) seconds += start.recovered_s;
      continue;
    }
    ++score.begun;
    score.begun_found += start.recovered;
    score.begun_ambiguous += start.first_ambiguous;
    score.begun_ambiguous_found += start.first_ambiguous && start.recovered;
  }
  if (score.recovered > 0) score.recovery_s_mean = seconds / static_cast<double>(score.recovered);
  return score;
}

LocalizeRunsScore run_drives(const LocalizeRunsSpec& spec, const LocalizeOptions& options,
                             const std::function<void()>& progress,
                             const std::function<void(const DrivenScan&)>& each) {
  LocalizeRunsScore score;
  const sim::LidarOptions lidar = sim::read_lidar(spec.sensor);
  std::uint64_t number = 0;
  for (const std::string& name : spec.worlds) {
    const std::uint64_t seed = Random::derive(spec.seed, ++number);
    MappedWorld mapped = map_world(name, lidar, seed);
    if (!(mapped.error_m < kWrongMapM)) {  // what is found on it would not be right where it is right on the map
      ++score.wrong_maps;
      progress();
      continue;
    }
    if (spec.unmapped > 0.0) wipe_rooms(spec.unmapped, Random::derive(seed, 4), mapped);
    const LocalizationMap map = LocalizationMap::from_grid(mapped.map, options);
    if (spec.moved > 0.0)
      mapped.world = sim::rearrange(mapped.world, {spec.moved, spec.moved}, Random::derive(seed, 5));
    DriveFollower(mapped, map, spec, options, score, each).run(lidar, Random::derive(seed, 6));
    progress();
  }
  return score;
}

}  // namespace phasescan
