// Samples of a turning head into the packets that a sensor of a model sends.
#pragma once

#include <vector>

#include "live/encode.hpp"

namespace phasescan::live {

struct WirePacket {
  ByteString bytes;
  double time_s = 0.0;  ///< of the last sample in it
};

/// How a model's samples lie in a turn and in packets.
struct PackerOptions {
  double turns_hz = 10.0;
  int samples_per_turn = 360;
  int rplidar_type = 0x81;  ///< form of an RPLIDAR's beams
  int ydlidar_width = 2;
  double start_deg = 0.0;                ///< SICK: direction of the first sample, as it tells it
  double step_deg = 0.0;                 ///< SICK
  std::string echo = "MD0044072500000";  ///< Hokuyo
};

class Packer {
 public:
  Packer(const SensorModel& model, const PackerOptions& options) : model_(model), options_(options) {}
  /// The next sample in time. `turned_deg` in [0, 360), `starts_turn` with the first of a turn.
  void add(const WireSample& sample, double time_s, std::vector<WirePacket>& out);

 private:
  void add_rplidar(const WireSample& sample, double time_s, std::vector<WirePacket>& out);
  void add_ydlidar(const WireSample& sample, double time_s, std::vector<WirePacket>& out);
  void add_whole_turn(double time_s, std::vector<WirePacket>& out);
  bool holds(std::size_t count) const { return held_.size() >= count; }
  void emit(ByteString bytes, double time_s, std::vector<WirePacket>& out) {
    out.push_back({std::move(bytes), time_s});
    held_.clear();
  }

  SensorModel model_;
  PackerOptions options_;
  std::vector<WireSample> held_;
  double first_s_ = 0.0, last_s_ = 0.0;
  bool began_ = false;
};

}  // namespace phasescan::live
