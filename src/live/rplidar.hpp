// Slamtec's RPLIDAR protocol: requests, answers and the forms in which beams come.
// Source: Slamtec, "RPLIDAR interface protocol and application notes" (2.4), and the fixed-point steps of its SDK for
// what the notes leave open (docs/live.md).
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "live/stream_decoder.hpp"

namespace phasescan::live::rplidar {

// Requests: A5, command, and where bit 7 of the command is set a length, as many bytes and the XOR of all before.
inline constexpr std::uint8_t kStop = 0x25, kScan = 0x20, kReset = 0x40, kInfo = 0x50, kHealth = 0x52,
                              kSampleRate = 0x59, kExpress = 0x82, kConf = 0x84, kRpm = 0xA8, kPwm = 0xF0,
                              kMotorBoard = 0xFF;
// Entries of kConf.
inline constexpr std::uint32_t kModeCount = 0x70, kModeMicroseconds = 0x71, kModeRange = 0x74, kModeAnswer = 0x75,
                               kTypicalMode = 0x7C, kModeName = 0x7F;
// Types of answers.
inline constexpr int kNodes = 0x81, kCapsules = 0x82, kHqNodes = 0x83, kUltra = 0x84, kDense = 0x85, kUltraDense = 0x86,
                     kInfoAnswer = 0x04, kHealthAnswer = 0x06, kRateAnswer = 0x15, kConfAnswer = 0x20,
                     kMotorAnswer = 0xFF;

std::vector<std::uint8_t> request(std::uint8_t command, Bytes payload = {});
std::vector<std::uint8_t> conf_request(std::uint32_t entry, std::optional<std::uint16_t> mode = {});

/// Bytes of a packet of that type of answer; 0: not one that beams come in.
constexpr std::size_t packet_size(int type) {
  switch (type) {
    case kNodes:
      return 5;
    case kCapsules:
    case kDense:
      return 84;
    case kHqNodes:
      return 781;
    case kUltra:
      return 132;
    case kUltraDense:
      return 170;
    default:
      return 0;
  }
}

/// A sample of a capsule: its direction is that of its place in the capsule, and this further on.
struct CapsuleSample {
  double shift = 0.0;             ///< [rad], clockwise
  std::uint32_t distance_q2 = 0;  ///< quarter millimetres
  float quality = 0.0F;
};

/// Samples of a capsule of that type. Those at the end of an ultra capsule need the one behind it.
void read_capsule(int type, Bytes capsule, Bytes next, std::vector<CapsuleSample>& out);
constexpr std::size_t capsule_samples(int type) {
  return type == kCapsules ? 32 : type == kUltra ? 96 : type == kDense ? 40 : 64;
}

/// The two check nibbles of a capsule stand in its first two bytes: XOR of all behind them.
bool capsule_is_right(Bytes capsule);

/// The long range of an ultra capsule's 12 bits [mm], and how far its small numbers are shifted.
struct VarBits {
  std::uint32_t value = 0;
  int level = 0;
};
VarBits var_bits(std::uint32_t bits);

}  // namespace phasescan::live::rplidar
