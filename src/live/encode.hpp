// The bytes that sensors send: the reverse of the decoders, for emulators and tests. Directions are of the sensor's own
// sense, in degrees from its zero; ranges in millimetres, 0 where there is none.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "live/stream_decoder.hpp"

namespace phasescan::live {

struct WireSample {
  double mm = 0.0;
  int signal = 0;
  double turned_deg = 0.0;   ///< forms that tell each direction
  bool starts_turn = false;  ///< forms that tell it
};
using WireSamples = std::span<const WireSample>;
using ByteString = std::vector<std::uint8_t>;

/// Twelve samples from start to end.
ByteString ld06_packet(double deg_per_s, double start_deg, double end_deg, WireSamples samples, std::uint32_t ms);
/// Four samples; packet `index` of 90.
ByteString xv11_packet(int index, double rpm, WireSamples samples);
/// Six samples; packet `index` of 60.
ByteString lds01_packet(int index, double rpm, WireSamples samples);
/// Eight samples from start to end.
ByteString camsense_packet(double rpm, double start_deg, double end_deg, WireSamples samples);
ByteString delta2_packet(double turns_hz, double start_deg, WireSamples samples);
/// @param width  bytes a sample: 2, 3 or 4; `turns_hz` stands in packets that start a turn
ByteString ydlidar_packet(bool starts_turn, double turns_hz, double start_deg, double end_deg, WireSamples samples,
                          int width, double mm_per_unit = 0.25);

/// What stands before an answer of `size` bytes; of packets without end: `repeated`.
ByteString rplidar_descriptor(std::uint32_t size, bool repeated, int type);
ByteString rplidar_answer(int type, std::span<const std::uint8_t> body);
ByteString rplidar_node(const WireSample& sample);
/// 32, 96, 40 or 64 samples by type. @param next_mm  84: the first range of the capsule behind it
ByteString rplidar_capsule(int type, double start_deg, bool restarts, WireSamples samples, double next_mm = 0.0);
/// 96 samples.
ByteString rplidar_hq(std::uint64_t time_us, WireSamples samples);

/// A block of SCIP 2.0: echo, status, a stamp of 24 bits, ranges of three characters.
std::string scip_scan(const std::string& echo, const std::string& status, std::uint32_t ms, WireSamples samples);
/// An answer without data, or with lines that carry their sums already.
std::string scip_answer(const std::string& echo, const std::string& status, std::span<const std::string> lines = {});
/// "DMIN:20" with ";" and its sum.
std::string scip_parameter(const std::string& text);

/// A telegram with STX and ETX.
std::string sick_scan(const std::string& command, std::uint32_t started_us, double turns_hz, double start_deg,
                      double step_deg, WireSamples samples);

}  // namespace phasescan::live
