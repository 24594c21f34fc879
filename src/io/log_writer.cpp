#include "phasescan/io/log_writer.hpp"

#include <algorithm>
#include <cctype>
#include <optional>
#include <cmath>

#include "io/log_writers.hpp"
#include "phasescan/io/error.hpp"
#include "io/mcap_writer.hpp"
#include "io/scan_log.hpp"

namespace phasescan {
namespace {

constexpr std::size_t kMostLosses = 20;

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

struct Ending {
  std::string_view ending;
  LogTarget target;
};
constexpr Ending kEndings[] = {
    {".mcap", LogTarget::kMcap},        {".log", LogTarget::kCarmen}, {".log.gz", LogTarget::kCarmen},
    {".carmen", LogTarget::kCarmen},    {".clf", LogTarget::kCarmen}, {".jsonl", LogTarget::kScanLog},
    {".jsonl.gz", LogTarget::kScanLog}, {".tum", LogTarget::kTum},    {".g2o", LogTarget::kG2o},
    {".pgm", LogTarget::kMap},          {".yaml", LogTarget::kMap}};

}  // namespace

const std::vector<std::string>& log_target_names() {
  static const std::vector<std::string> kNames{"mcap", "carmen", "jsonl", "tum", "g2o", "map"};
  return kNames;
}

LogTarget log_target_for(const std::string& path) {
  std::string known;
  for (const Ending& ending : kEndings) {
    if (path.ends_with(ending.ending)) return ending.target;
    known += (known.empty() ? "" : ", ") + std::string(ending.ending);
  }
  throw InputError(path, 0, "the name does not tell the format; expected one ending in " + known + ", or --to");
}

void LogWriter::add_loss(const std::string& text) {
  if (losses_.size() < kMostLosses && std::find(losses_.begin(), losses_.end(), text) == losses_.end())
    losses_.push_back(text);
}

std::unique_ptr<LogWriter> make_log_writer(LogTarget target, const std::string& path) {
  switch (target) {
    case LogTarget::kMcap:
      return std::make_unique<McapLogWriter>(path);
    case LogTarget::kCarmen:
      return make_carmen_writer(path);
    case LogTarget::kScanLog:
      return std::make_unique<JsonLogWriter>(path);
    case LogTarget::kTum:
      return make_tum_writer(path);
    case LogTarget::kG2o:
      return make_g2o_writer(path);
    case LogTarget::kMap:
      break;
  }
  return make_map_writer(path);
}

std::pair<const LaserNames::Laser&, bool> LaserNames::of(const std::string& name) {
  const auto found = lasers_.find(name);
  if (found != lasers_.end()) return {found->second, false};
  Laser laser{name, "laser"};
  if (!name.starts_with('/')) {
    laser.topic = lasers_.empty() ? "/scan" : "/";
    for (const char c : lasers_.empty() ? std::string() : name) {
      const auto byte = static_cast<unsigned char>(c);
      laser.topic += std::isalnum(byte) != 0 ? static_cast<char>(std::tolower(byte)) : '_';
    }
  }
  if (!lasers_.empty()) laser.frame.append("_").append(std::to_string(lasers_.size() + 1));
  return {lasers_.emplace(name, std::move(laser)).first->second, true};
}

Scan even_scan(const Scan& scan, double* largest_move_rad) {
  if (largest_move_rad != nullptr) *largest_move_rad = 0.0;
  const std::size_t n = scan.size();
  if (scan.angles.empty() || n == 0) return scan;
  const auto [low, high] = std::minmax_element(scan.angles.begin(), scan.angles.end());
  ScanGeometry geometry = scan.geometry;
  geometry.angle_min = *low;
  geometry.angle_increment = n > 1 && *high > *low ? (double{*high} - double{*low}) / static_cast<double>(n - 1) : 1.0;
  // A falling sweep stays one.
  if (scan.angles.back() < scan.angles.front()) {
    geometry.angle_min = *high;
    geometry.angle_increment = -geometry.angle_increment;
  }
  std::vector<float> raw(n, 0.0F);
  std::vector<float> intensities(scan.intensities.empty() ? 0 : n, 0.0F);
  std::vector<double> distance(n, std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i < n; ++i) {
    const double at = (scan.angle(i) - geometry.angle_min) / geometry.angle_increment;
    const auto bin = static_cast<std::size_t>(std::clamp(std::lround(at), 0L, static_cast<long>(n) - 1));
    const double away = std::abs(at - static_cast<double>(bin));
    const double moved = away * std::abs(geometry.angle_increment);
    // Float angles are even within their own rounding.
    if (largest_move_rad != nullptr && moved > 1e-5) *largest_move_rad = std::max(*largest_move_rad, moved);
    if (away >= distance[bin]) continue;
    distance[bin] = away;
    raw[bin] = raw_range(scan, i);
    if (!intensities.empty()) intensities[bin] = scan.intensities[i];
  }
  Scan out = make_scan(raw, geometry);
  out.stamp = scan.stamp;
  out.time_increment = scan.time_increment;
  out.intensities = std::move(intensities);
  return out;
}

}  // namespace phasescan
