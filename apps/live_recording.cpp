#include "live_recording.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <stdexcept>

#include "io/file.hpp"
#include "live_saver.hpp"

namespace phasescan::app {

void LiveRecording::take(const live::LiveUpdate& update) {
  const std::lock_guard lock(mutex_);
  if (recorder_) recorder_->add(update);
}

std::string LiveRecording::start(const std::string& name) {
  const std::lock_guard lock(mutex_);
  if (recorder_) throw std::runtime_error("a recording is going on: " + recorder_->path());
  make_folder(folder_);
  const std::string file = (name.empty() ? name_of_now("drive") : name) + ".mcap";
  recorder_ = std::make_unique<live::Recorder>((std::filesystem::path(folder_) / file).string(), tell_);
  return std::filesystem::path(recorder_->path()).filename().string();
}

std::string LiveRecording::stop() {
  const std::lock_guard lock(mutex_);
  if (!recorder_) throw std::runtime_error("nothing is recorded");
  const std::string name = std::filesystem::path(recorder_->path()).filename().string();
  if (closing_.joinable()) closing_.join();
  closing_ = std::thread([recorder = std::shared_ptr<live::Recorder>(std::move(recorder_)), tell = tell_, name] {
    const bool whole = recorder->close();
    const live::RecorderCounts counts = recorder->counts();
    tell(fmt::format("{}: {} scans recorded, {:.2f} MB{}", name, counts.scans, 1e-6 * static_cast<double>(counts.bytes),
                     whole ? "" : ", not to the end"));
  });
  return name;
}

void LiveRecording::stop_and_wait() {
  if (!name().empty()) stop();
  if (closing_.joinable()) closing_.join();
}

std::string LiveRecording::name() const {
  const std::lock_guard lock(mutex_);
  return recorder_ ? std::filesystem::path(recorder_->path()).filename().string() : std::string();
}

}  // namespace phasescan::app
