// Recordings that people begin and end while a run goes on.
#pragma once

#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "live/recorder.hpp"

namespace phasescan::app {

class LiveRecording final : public live::LiveSink {
 public:
  /// @param tell  takes a line for people, from any thread
  LiveRecording(std::string folder, std::function<void(const std::string&)> tell)
      : folder_(std::move(folder)), tell_(std::move(tell)) {}
  ~LiveRecording() override { stop_and_wait(); }

  void take(const live::LiveUpdate& update) override;
  /// Begins NAME.mcap, or NAME-2.mcap where that is there. Gives its name. @param name  empty: date and time
  /// @throws std::runtime_error while one is going on, InputError, SystemError
  std::string start(const std::string& name);
  /// Closes it, beside the caller: what is left goes to the disk, then it is told. Gives its name. @throws
  /// std::runtime_error where there is none
  std::string stop();
  void stop_and_wait();
  /// Of the one that is going on; empty: none.
  std::string name() const;

 private:
  const std::string folder_;
  const std::function<void(const std::string&)> tell_;
  mutable std::mutex mutex_;
  std::unique_ptr<live::Recorder> recorder_;
  std::thread closing_;
};

}  // namespace phasescan::app
