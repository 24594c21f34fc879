// Map and state of a run that goes on, as files: taken between two scans, finished and written beside them.
#pragma once

#include <atomic>
#include <string>
#include <thread>

#include "phasescan/slam/slam.hpp"
#include "phasescan/slam/state.hpp"
#include "serve/live_control.hpp"

namespace phasescan::app {

class LiveSaver {
 public:
  /// @param folder  of all files; made where it is missing
  LiveSaver(Slam& slam, std::string folder) : slam_(slam), folder_(std::move(folder)) {}
  ~LiveSaver() { wait(); }
  LiveSaver(const LiveSaver&) = delete;
  LiveSaver& operator=(const LiveSaver&) = delete;

  /// By the thread that tracks: NAME.pgm, .yaml, .png and .state. `done` comes when they are written, from another
  /// thread. Nothing that is there is written over. @param name  empty: date and time
  /// @throws std::runtime_error where it cannot begin
  void save(const std::string& name, const serve::CommandDone& done);
  /// Until what was begun is written.
  void wait();

 private:
  void write(const SavedRun& run, const std::string& name) const;

  Slam& slam_;
  const std::string folder_;
  std::thread worker_;
  std::atomic<bool> busy_{false};
};

/// "map-20260131-154500", local time.
std::string name_of_now(const std::string& what);

}  // namespace phasescan::app
