// A log as MCAP: scans, odometry and the transforms that hold them together.
#include "io/even_scan.hpp"
#include "io/laser_names.hpp"
#include "io/log_writers.hpp"
#include "io/mcap_writer.hpp"

namespace phasescan {
namespace {

class McapLogWriter final : public LogWriter {
 public:
  explicit McapLogWriter(const std::string& path) : file_(path) {}

  void add(const LogEntry& entry) override {
    const Stamp stamp = entry.scan.stamp;
    const auto [laser, is_new] = names_.of(entry.laser);
    if (is_new) file_.static_transform(stamp, "base_link", laser.frame, entry.T_base_laser, entry.flipped);
    if (stamp < 0) add_loss("stamps before 1970 are logged at 0");
    if (entry.odometry) {
      file_.odometry("/odom", stamp, "odom", "base_link", *entry.odometry);
      file_.transform(stamp, "odom", "base_link", *entry.odometry);
    }
    double moved = 0.0;
    const Scan scan = even_scan(entry.scan, &moved);
    if (moved > 0.0) add_loss("beams at uneven angles were moved to the nearest even one");
    file_.scan(laser.topic, laser.frame, scan);
  }

  void finish() override { file_.close(); }

 private:
  McapWriter file_;
  LaserNames names_;
};

}  // namespace

std::unique_ptr<LogWriter> make_mcap_writer(const std::string& path) {
  return std::make_unique<McapLogWriter>(path);
}

}  // namespace phasescan
