// What people ask of a run of `live`, done: poses and relocalising by the thread that tracks, files by it too.
#pragma once

#include <functional>
#include <string>

#include "live_recording.hpp"
#include "live_saver.hpp"
#include "live_sources.hpp"
#include "phasescan/live/live.hpp"
#include "serve/live_control.hpp"

namespace phasescan::app {

class LiveCommands final : public serve::LiveControl {
 public:
  /// What is given must outlive this object. @param saver  null: there is
  /// nothing to save
  LiveCommands(live::LiveEngine& engine, live::LiveTasks& tasks, LiveSaver* saver, LiveRecording* recording)
      : engine_(engine), tasks_(tasks), saver_(saver), recording_(recording) {}
  /// Before the server is made. Null: no log is replayed.
  void set_replay(ReplaySource* replay) { replay_ = replay; }

  serve::ControlState state() const override;

  void set_pose(const Pose2& T_map_base, serve::CommandDone done) override;
  void relocalise(serve::CommandDone done) override;
  void start_recording(const std::string& name, serve::CommandDone done) override;
  void stop_recording(serve::CommandDone done) override;
  void save(const std::string& name, serve::CommandDone done) override;
  void replay_speed(double speed, serve::CommandDone done) override;
  void replay_seek(double share, serve::CommandDone done) override;

 private:
  void between_scans(std::function<std::string()> work, serve::CommandDone done);

  live::LiveEngine& engine_;
  live::LiveTasks& tasks_;
  ReplaySource* replay_ = nullptr;
  LiveSaver* saver_;
  LiveRecording* recording_;
};

}  // namespace phasescan::app
