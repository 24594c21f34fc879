#include "emulate/world_feed.hpp"

#include <algorithm>
#include <cmath>

#include "live/angle_shift.hpp"
#include "live/rplidar.hpp"
#include "sim/pairs_spec.hpp"

namespace phasescan::emulate {
namespace {

using namespace live;

const char* nearest_description(const SensorModel& model) {
  switch (model.protocol) {
    case Protocol::kRplidar:
      return model.name == "rplidar-c1"   ? "rplidar-c1"
             : model.name == "rplidar-a3" ? "rplidar-a2"
             : model.range_max_m > 30.0   ? "hall-30m"
                                          : "rplidar-a1";
    case Protocol::kLd06:
      return "ld06";
    case Protocol::kYdlidar:
      return "ydlidar-x4";
    case Protocol::kHokuyo:
      return "urg-04lx";
    case Protocol::kSick:
      return "hall-30m";
    default:
      return "rplidar-a1";
  }
}

PackerOptions packer_options(const SensorModel& model, const sim::LidarOptions& lidar, int rplidar_type,
                             const std::string& echo) {
  PackerOptions options;
  options.turns_hz = lidar.rate_hz;
  options.samples_per_turn = lidar.beams;
  options.rplidar_type = rplidar_type;
  options.ydlidar_width = model.name == "ydlidar-tg" ? 4
                          : model.name == "ydlidar-tmini" || model.name == "ydlidar-g4b" || model.name == "ydlidar-scl"
                              ? 3
                              : 2;
  options.start_deg = lidar.angle_min_deg - model.zero_deg;
  options.step_deg = rad_to_deg(lidar.angle_increment());
  if (!echo.empty()) options.echo = echo;
  return options;
}

/// The ranges of a sensor whose directions depend on them: at each turned angle what stands where the beam really goes.
double seen_at(const Scan& scan, std::size_t k, AngleShift shift, bool ultra) {
  const auto n = static_cast<double>(scan.size());
  const auto range = [&](double at) {
    const auto i = static_cast<std::size_t>(std::lround(at + 2.0 * n)) % scan.size();
    return scan.is_hit(i) ? 1e3 * scan.ranges[i] : 0.0;
  };
  double at = static_cast<double>(k), mm = range(at);
  for (int i = 0; i < 3 && mm > 0.0; ++i) {
    const double turn = ultra ? ultra_angle_shift(static_cast<std::uint32_t>(4.0 * mm)) : angle_shift(shift, mm);
    at = static_cast<double>(k) + turn * n / kTwoPi;
    mm = range(at);
  }
  return mm;
}

}  // namespace

sim::LidarOptions lidar_of(const SensorModel& model, int rplidar_type) {
  sim::LidarOptions lidar = sim::read_lidar(nearest_description(model));
  const bool forward =
      model.protocol == Protocol::kXv11 || model.protocol == Protocol::kHokuyo || model.protocol == Protocol::kSick;
  lidar.clockwise = !forward;
  lidar.angle_min_deg = model.protocol == Protocol::kLds01 ? -1.0 : 0.0;
  lidar.rate_hz = model.turns_hz;
  double samples_hz = model.samples_hz;
  if (model.protocol == Protocol::kRplidar && rplidar_type == rplidar::kNodes)
    samples_hz = model.name == "rplidar-a1" ? 1e6 / 508 : std::min(samples_hz, 5000.0);
  if (model.protocol == Protocol::kRplidar && rplidar_type == rplidar::kCapsules) samples_hz = 1e6 / 254;
  lidar.beams = static_cast<int>(std::lround(samples_hz / lidar.rate_hz));
  if (model.protocol == Protocol::kXv11 || model.protocol == Protocol::kLds01) lidar.beams = 360;
  if (model.protocol == Protocol::kDelta2) lidar.beams -= lidar.beams % 16;
  if (model.protocol == Protocol::kHokuyo) {
    lidar.beams = 682;
    lidar.fov_deg = 681 * 360.0 / 1024;
    lidar.angle_min_deg = (44 - 384) * 360.0 / 1024;
  }
  if (model.protocol == Protocol::kSick) {
    lidar.beams = 811;
    lidar.fov_deg = 270.0;
    lidar.angle_min_deg = -45.0 + model.zero_deg;
  }
  return lidar;
}

WorldFeed::WorldFeed(const SensorModel& model, sim::Drive drive, const sim::LidarOptions& lidar, int rplidar_type,
                     const std::string& echo)
    : model_(model),
      drive_(std::move(drive)),
      rplidar_type_(rplidar_type),
      packer_(model, packer_options(model, lidar, rplidar_type, echo)) {}

std::optional<WirePacket> WorldFeed::next() {
  while (ready_.empty()) {
    const auto turn = drive_.next();
    if (!turn) return std::nullopt;
    take_turn(*turn);
  }
  WirePacket packet = std::move(ready_.front());
  ready_.pop_front();
  return packet;
}

void WorldFeed::take_turn(const sim::DriveScan& turn) {
  const Scan& scan = turn.entry.scan;
  const double from_s = stamp_to_seconds(scan.stamp);
  truth_.emplace_back(from_s, turn.T_world_laser);
  std::vector<WirePacket> packets;
  const bool ultra = model_.protocol == Protocol::kRplidar && rplidar_type_ == rplidar::kUltra;
  for (std::size_t k = 0; k < scan.size(); ++k) {
    WireSample sample;
    sample.mm = seen_at(scan, k, model_.shift, ultra);
    sample.signal = sample.mm > 0.0 ? 40 : 0;
    sample.turned_deg = 360.0 * static_cast<double>(k) / static_cast<double>(scan.size());
    sample.starts_turn = k == 0;
    packer_.add(sample, from_s + static_cast<double>(k) * scan.time_increment, packets);
  }
  for (WirePacket& packet : packets) ready_.push_back(std::move(packet));
}

}  // namespace phasescan::emulate
