/// What people may ask of a run while it goes on, from the page or by any other protocol.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "phasescan/core/pose2.hpp"

namespace phasescan::serve {

/// How a command ended, and a line about it for people. May be called from any thread, once.
using CommandDone = std::function<void(bool done, const std::string& text)>;

/// A log that is replayed, where it stands.
struct ReplayState {
  double time_s = 0.0;      ///< since its first scan
  double duration_s = 0.0;  ///< 0: not known yet
  double speed = 1.0;       ///< 0: held
};

/// What a run can do, and what it does now.
struct ControlState {
  bool can_set_pose = false, can_save = false, can_record = false;
  std::string recording;  ///< name of what is recorded now; empty: nothing
  std::optional<ReplayState> replay;
};

/// All of them return at once, may be called from any thread, and never throw for what a person typed: the answer comes
/// by `done`.
class LiveControl {
 public:
  virtual ~LiveControl() = default;
  virtual ControlState state() const = 0;
  /// Where the robot stands.
  virtual void set_pose(const Pose2& T_map_base, CommandDone done) = 0;
  /// The robot may be anywhere: what was told of its pose is dropped, too.
  virtual void relocalise(CommandDone done) = 0;
  /// @param name  as `check_save_name` has it; empty: one is made of date and time
  virtual void start_recording(const std::string& name, CommandDone done) = 0;
  virtual void stop_recording(CommandDone done) = 0;
  /// Map and state, under one name in the folder of the run.
  virtual void save(const std::string& name, CommandDone done) = 0;
  /// Of a log that is replayed; elsewhere the answer is no. @param speed  0: pause; 1: as it was
  virtual void replay_speed(double speed, CommandDone done) = 0;
  /// @param share  0..1 of the log
  virtual void replay_seek(double share, CommandDone done) = 0;
};

/// Whether a name may become a file in the folder of the run: 1 to 64 letters, digits, '-', '_', '.', not the first.
/// `why` says what is wrong.
bool check_save_name(const std::string& name, std::string& why);

}  // namespace phasescan::serve
