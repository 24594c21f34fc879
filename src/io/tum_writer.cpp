// A log's poses as a trajectory.
#include <vector>

#include "io/file.hpp"
#include "io/log_writers.hpp"
#include "io/pose_writer.hpp"
#include "io/tum.hpp"

namespace phasescan {
namespace {

class TumWriter final : public PoseWriter {
 public:
  using PoseWriter::PoseWriter;

 protected:
  void add_pose(const LogEntry& entry, const Pose2& T_odom_base) override {
    poses_.push_back({entry.scan.stamp, T_odom_base});
  }
  void write() override { write_file(path(), format_tum(poses_)); }

 private:
  std::vector<StampedPose> poses_;
};

}  // namespace

std::unique_ptr<LogWriter> make_tum_writer(const std::string& path) {
  return std::make_unique<TumWriter>(path);
}

}  // namespace phasescan
