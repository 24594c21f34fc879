// What `live` keeps while it runs: a recording, and the state to go on from.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "live/recorder.hpp"
#include "live/state_keeper.hpp"

namespace phasescan::app {

struct KeepingFlags {
  std::string record, save;
};
void add_keeping_flags(CLI::App& command, KeepingFlags& flags);

class LiveKeeping final : public live::LiveSink {
 public:
  using Tell = std::function<void(const std::string&)>;
  /// Opens the recording; says before anything begins where a file cannot be written.
  /// @param slam  the run that is saved; null: there is none. @throws InputError, SystemError
  LiveKeeping(const KeepingFlags& flags, Slam* slam, double autosave_s, const Tell& tell);

  void take(const live::LiveUpdate& update) override;
  /// By the thread of SLAM.
  void between();
  /// Saves the state, closes the recording, says what is in it. False where the disk said no.
  bool finish();

 private:
  Slam* slam_;
  Tell tell_;
  std::optional<live::Recorder> recorder_;
  std::optional<live::StateKeeper> state_;
  std::string save_;
};

/// The source of a run that goes on: where its first scan follows the run's last one by at most `session_gap_s`, it
/// goes on with it; else it is another drive (LiveEngine::relocalise).
std::unique_ptr<live::LiveSource> resumed(std::unique_ptr<live::LiveSource> source, live::LiveEngine& engine,
                                          Stamp last, double session_gap_s);

}  // namespace phasescan::app
