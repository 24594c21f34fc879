// CARMEN logs. FLASER can say beams over 180 degrees of a laser ahead of the robot; other scans go as ROBOTLASER1, or
// as RAWLASER1 where there is no pose:
//
//   FLASER n r.. x y theta ox oy otheta t host lt
//   ROBOTLASER1 type start fov res maxr acc rem n r.. m rem.. lx ly ltheta rx ry rtheta tv rv fwd side turn t host lt
//   RAWLASER1 type start fov res maxr acc rem n r.. m rem.. t host lt
#include <cmath>
#include <optional>

#include "io/even_scan.hpp"
#include "io/log_writers.hpp"
#include "io/file.hpp"
#include "io/number.hpp"

namespace phasescan {
namespace {

constexpr float kNothingSeen = 81.83F;  // [m], what SICK scanners say
constexpr double kSameAngle = 1e-6;

void add_word(std::string& line, double value) {
  line += ' ';
  append_number(line, value);
}
void add_word(std::string& line, float value) {
  line += ' ';
  append_number(line, value);
}
void add_pose(std::string& line, const Pose2& pose) {
  add_word(line, pose.x);
  add_word(line, pose.y);
  add_word(line, pose.theta);
}

class CarmenWriter final : public LogWriter {
 public:
  explicit CarmenWriter(const std::string& path) : file_(path) { file_.write("# CARMEN Logfile\n"); }

  void add(const LogEntry& entry) override {
    double moved = 0.0;
    const Scan scan = even_scan(entry.flipped ? mirrored_scan(entry.scan) : entry.scan, &moved);
    if (moved > 0.0) add_loss("beams at uneven angles were moved to the nearest even one");
    if (scan.time_increment > 0.0) add_loss("CARMEN lines say no time between beams");
    if (!first_) first_ = scan.stamp;
    const bool front = entry.odometry && fits_front_laser(scan, entry.T_base_laser);
    std::string line = front ? front_laser(scan, entry) : other_laser(scan, entry);
    line += ' ';
    append_stamp(line, scan.stamp, 6);
    line += " phasescan ";
    append_stamp(line, scan.stamp - *first_, 6);
    line += '\n';
    file_.write(line);
  }

  void finish() override { file_.commit(); }

 private:
  /// A laser that looks ahead from a place on the robot's axis, its beams every 180 / n degrees from the right on.
  bool fits_front_laser(const Scan& scan, const Pose2& T_base_laser) const {
    const std::size_t n = scan.size();
    const bool count = n == 180 || n == 181 || n == 360 || n == 361;
    return count && std::abs(scan.geometry.angle_min + kPi / 2.0) < kSameAngle &&
           std::abs(scan.geometry.angle_increment - kPi / static_cast<double>(n - n % 2)) < kSameAngle / 360.0 &&
           T_base_laser.y == 0.0 && T_base_laser.theta == 0.0 && (!ahead_ || *ahead_ == T_base_laser.x) &&
           scan.effective_range_max() < 80.0;
  }

  std::string front_laser(const Scan& scan, const LogEntry& entry) {
    std::string line;
    if (!ahead_) {
      ahead_ = entry.T_base_laser.x;
      line = "PARAM robot_frontlaser_offset";
      add_word(line, *ahead_);
      line += '\n';
    }
    line += "FLASER " + std::to_string(scan.size());
    for (std::size_t i = 0; i < scan.size(); ++i) add_word(line, scan.is_hit(i) ? scan.ranges[i] : kNothingSeen);
    const Pose2 T_odom_laser = *entry.odometry * entry.T_base_laser;
    add_pose(line, entry.corrected.value_or(T_odom_laser));
    add_pose(line, T_odom_laser);
    if (scan.geometry.range_max > 0.0 || scan.geometry.range_min > 0.0) add_loss("FLASER lines say no range limits");
    return line;
  }

  std::string other_laser(const Scan& scan, const LogEntry& entry) {
    const double stated_max = scan.geometry.range_max > 0.0 ? scan.geometry.range_max : double{kNothingSeen};
    const auto missing = static_cast<float>(stated_max);
    const auto steps = static_cast<double>(scan.size() > 1 ? scan.size() - 1 : 1);
    if (scan.geometry.range_min > 0.0) add_loss("CARMEN lines say no smallest range");
    std::string line = entry.odometry ? "ROBOTLASER1 0" : "RAWLASER1 0";
    add_word(line, scan.geometry.angle_min);
    add_word(line, scan.geometry.angle_increment * steps);
    add_word(line, scan.geometry.angle_increment);
    add_word(line, stated_max);
    line += " 0.01 0 " + std::to_string(scan.size());
    for (std::size_t i = 0; i < scan.size(); ++i) add_word(line, scan.is_hit(i) ? scan.ranges[i] : missing);
    line += ' ' + std::to_string(scan.intensities.size());
    for (const float value : scan.intensities) add_word(line, std::isfinite(value) ? value : 0.0F);
    if (entry.odometry) {
      add_pose(line, *entry.odometry * entry.T_base_laser);
      add_pose(line, *entry.odometry);
      line += " 0 0 0 0 0";
    }
    return line;
  }

  AtomicFile file_;
  std::optional<Stamp> first_;
  std::optional<double> ahead_;
};

}  // namespace

std::unique_ptr<LogWriter> make_carmen_writer(const std::string& path) {
  return std::make_unique<CarmenWriter>(path);
}

}  // namespace phasescan
