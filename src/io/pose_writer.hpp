/// What writers of a log's poses share.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>

#include "phasescan/core/pose2.hpp"
#include "phasescan/io/error.hpp"
#include "phasescan/io/log.hpp"

namespace phasescan {

/// Takes the pose of each entry: odometry, or where there is none the log's own estimate.
class PoseWriter : public LogWriter {
 public:
  explicit PoseWriter(std::string path) : path_(std::move(path)) {}
  void add(const LogEntry& entry) final {
    const std::optional<Pose2>& pose = entry.odometry ? entry.odometry : entry.corrected;
    if (!pose) {
      add_loss("scans without a pose are left out");
      return;
    }
    ++poses_;
    add_pose(entry, *pose);
  }
  void finish() final {
    if (poses_ == 0) {
      throw InputError(path_, 0, "the log has no poses; expected odometry (from scans alone: `phasescan slam`)");
    }
    write();
  }

 protected:
  virtual void add_pose(const LogEntry& entry, const Pose2& T_odom_base) = 0;
  virtual void write() = 0;
  const std::string& path() const { return path_; }

 private:
  std::string path_;
  std::size_t poses_ = 0;
};

}  // namespace phasescan
