#include "live_commands.hpp"

#include <exception>
#include <utility>

namespace phasescan::app {

void LiveCommands::between_scans(std::function<std::string()> work, serve::CommandDone done) {
  const bool taken = tasks_.post([work = std::move(work), done] {
    try {
      done(true, work());
    } catch (const std::exception& error) {
      done(false, error.what());
    }
  });
  if (!taken) done(false, "too much was asked at once, or the run is over");
}

void LiveCommands::set_pose(const Pose2& T_map_base, serve::CommandDone done) {
  between_scans([this, T_map_base] { return engine_.set_pose(T_map_base); }, std::move(done));
}

void LiveCommands::relocalise(serve::CommandDone done) {
  between_scans([this] { return engine_.relocalise(); }, std::move(done));
}

void LiveCommands::start_recording(const std::string& name, serve::CommandDone done) {
  if (recording_ == nullptr) return done(false, "this run records nothing");
  try {
    done(true, recording_->start(name) + " is being recorded");
  } catch (const std::exception& error) {
    done(false, error.what());
  }
}

void LiveCommands::stop_recording(serve::CommandDone done) {
  if (recording_ == nullptr) return done(false, "this run records nothing");
  try {
    done(true, recording_->stop() + " is recorded");
  } catch (const std::exception& error) {
    done(false, error.what());
  }
}

void LiveCommands::save(const std::string& name, serve::CommandDone done) {
  if (saver_ == nullptr) return done(false, "this run has nothing to save");
  const bool taken = tasks_.post([this, name, done] {
    try {
      saver_->save(name, done);
    } catch (const std::exception& error) {
      done(false, error.what());
    }
  });
  if (!taken) done(false, "too much was asked at once, or the run is over");
}

serve::ControlState LiveCommands::state() const {
  serve::ControlState state;
  state.can_set_pose = true;
  state.can_save = saver_ != nullptr;
  state.can_record = recording_ != nullptr;
  if (recording_ != nullptr) state.recording = recording_->name();
  if (replay_ != nullptr) state.replay = replay_->state();
  return state;
}

void LiveCommands::replay_speed(double speed, serve::CommandDone done) {
  if (replay_ == nullptr) return done(false, "this is no log that is replayed");
  replay_->set_speed(speed);
  done(true, speed > 0.0 ? "it goes on" : "held");
}

void LiveCommands::replay_seek(double share, serve::CommandDone done) {
  if (replay_ == nullptr) return done(false, "this is no log that is replayed");
  const bool can = replay_->seek(share);
  done(can, can ? "going there" : "this log can be read from the beginning to the end alone");
}

}  // namespace phasescan::app
