// Scan logs: JSON Lines, a scan a line.
#include <optional>

#include "io/log_writers.hpp"
#include "io/scan_log.hpp"

namespace phasescan {
namespace {

class JsonLogWriter final : public LogWriter {
 public:
  explicit JsonLogWriter(const std::string& path) : file_(path) {}
  void add(const LogEntry& entry) override {
    // A scan log knows no mounting: odometry is written as the laser's own, and a laser upside down as the upright one
    // that sees the same.
    LogEntry alone = entry;
    if (entry.flipped) alone.scan = mirrored_scan(entry.scan);
    if (entry.odometry) alone.odometry = *entry.odometry * entry.T_base_laser;
    if (!first_mount_) first_mount_ = entry.T_base_laser;
    if (!(entry.T_base_laser == *first_mount_))
      add_loss("scan logs say no mounting, and these lasers are mounted at different places: write one with --topic");
    file_.write(alone);
  }
  void finish() override { file_.commit(); }

 private:
  ScanLogWriter file_;
  std::optional<Pose2> first_mount_;
};

}  // namespace

std::unique_ptr<LogWriter> make_scan_log_writer(const std::string& path) {
  return std::make_unique<JsonLogWriter>(path);
}

}  // namespace phasescan
