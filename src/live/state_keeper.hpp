// The state of a live run on the disk, so that a kill costs a few seconds of it.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "phasescan/slam/state.hpp"

namespace phasescan::live {

/// Packs and writes in a thread of its own. The file is the old or the new one at any moment.
class StateKeeper {
 public:
  /// @param every_s  time between two saves; a run that takes long to save is saved less often, so that it never takes
  /// more than a tenth of a core. 0: at the end alone
  /// @param tell  takes a line for people, from any thread
  StateKeeper(std::string path, double every_s, std::function<void(const std::string&)> tell);
  ~StateKeeper();
  StateKeeper(const StateKeeper&) = delete;
  StateKeeper& operator=(const StateKeeper&) = delete;

  /// By the thread of SLAM, between two scans: takes the state where it is time, and does not wait for the disk.
  /// @cost a copy of the run's poses; waits for the batch in work
  void scan_added(Slam& slam);
  /// The last state; waits until it is on the disk. False where the disk said no.
  bool finish(Slam& slam);

 private:
  void work();
  bool write(const SavedRun& run);

  const std::string path_;
  const double every_s_;
  const std::function<void(const std::string&)> tell_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::optional<SavedRun> waiting_;
  bool busy_ = false, ends_ = false, told_ = false;
  std::int64_t due_ns_ = 0;
  std::thread thread_;
};

}  // namespace phasescan::live
