// What makes poses of the scans of `live`: SLAM, new or gone on from a saved run, or a search on a map that is known.
#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <optional>
#include <string>

#include "commands.hpp"
#include "known_map.hpp"
#include "phasescan/live/live.hpp"
#include "phasescan/slam/state.hpp"

namespace phasescan::app {

struct TrackingFlags {
  std::string map, state;  ///< of a map that is known
  bool keep_prepared = false;
  std::string resume;
  bool known_map() const { return !map.empty() || !state.empty(); }
};
void add_map_flags(CLI::App& command, TrackingFlags& flags);

class LiveTracking {
 public:
  /// @throws InputError for a map or state that cannot be used
  LiveTracking(const TrackingFlags& flags, const CommonFlags& common);
  LiveTracking(const LiveTracking&) = delete;
  LiveTracking& operator=(const LiveTracking&) = delete;

  live::LiveEngine& engine() { return *engine_; }
  /// Null: the map is known, and there is no run to save.
  Slam* slam() { return slam_ ? &*slam_ : nullptr; }
  /// Of SLAM; the cells of those who draw are those of the map.
  const SlamOptions& options() const { return options_; }
  /// The source, joined to the run that goes on.
  std::unique_ptr<live::LiveSource> joined(std::unique_ptr<live::LiveSource> source);
  /// Nothing begins again: what that would need is given back.
  void forget_beginning() { saved_.reset(); }

 private:
  Slam begin_slam();

  SlamOptions options_;
  std::optional<SavedRun> saved_;
  ThreadExecutor executor_;
  std::optional<Slam> slam_;
  std::unique_ptr<live::LiveEngine> engine_;
};

}  // namespace phasescan::app
