#include "live_tracking.hpp"

#include <algorithm>
#include <utility>

#include "live_keeping.hpp"
#include "saved_run.hpp"

namespace phasescan::app {

void add_map_flags(CLI::App& command, TrackingFlags& flags) {
  command.add_option("--map", flags.map, "a known map to be found in, of map_server: yaml with its image")
      ->type_name("MAP.yaml")
      ->check(not_empty());
  command.add_option("--state", flags.state, "a known map to be found in, of a saved run")
      ->type_name("STATE")
      ->check(not_empty());
  add_keep_prepared_flag(command, flags.keep_prepared);
  command.add_option("--resume", flags.resume, "go on from a saved run")->type_name("STATE")->check(not_empty());
}

namespace {

/// A sensor sends for days: memory grows with the area and not with time, unless the settings say otherwise.
bool keeps_all(const Config& config) {
  const std::vector<std::string>& set = config.options_set;
  const bool named = std::find(set.begin(), set.end(), "slam.bounded_memory") != set.end();
  return named && !config.slam.slam.bounded_memory;
}

}  // namespace

LiveTracking::LiveTracking(const TrackingFlags& flags, const CommonFlags& common) {
  const Config config = config_from(common);
  options_ = config.slam;
  options_.slam.bounded_memory = !keeps_all(config);
  if (flags.known_map()) {
    KnownMap known = load_known_map(flags.map, flags.state, config.localize, flags.keep_prepared);
    options_.map.resolution_m = known.drawn.resolution_m;
    engine_ = live::localize_engine([map = known.map, localize = config.localize,
                                     odometry = config.slam.odometry] { return Localizer(map, localize, odometry); },
                                    std::move(known.drawn));
    return;
  }
  if (!flags.resume.empty()) {
    saved_ = load_run(flags.resume).saved;
    // A run of `slam` that kept all goes on as it was.
    options_.slam.bounded_memory = saved_->options.slam.bounded_memory && !keeps_all(config);
    options_ = options_to_go_on(*saved_, common.config, options_);
  }
  slam_ = begin_slam();
  engine_ = live::slam_engine(*slam_, [this] { return begin_slam(); });
}

Slam LiveTracking::begin_slam() {
  if (saved_) return Slam(saved_->state, options_, Schedule::kLatest, &executor_);
  return Slam(options_, Schedule::kLatest, &executor_);
}

std::unique_ptr<live::LiveSource> LiveTracking::joined(std::unique_ptr<live::LiveSource> source) {
  if (!slam_ || !saved_ || saved_->state.scans() == 0) return source;
  return resumed(std::move(source), *engine_, summarize(saved_->state).last_stamp, options_.slam.session_gap_s);
}

}  // namespace phasescan::app
