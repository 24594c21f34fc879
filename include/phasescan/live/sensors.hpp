/// The sensors that can be plugged in: what their maker calls them, how they talk, what they reach.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

namespace phasescan::live {

/// How a sensor puts its beams on the wire.
enum class Protocol : std::uint8_t {
  kRplidar,   ///< Slamtec: requests and answers; nodes and capsules
  kLd06,      ///< LDROBOT: 47-byte packets, one way
  kLds01,     ///< Hitachi-LG HLS-LFCD2: 60 packets of 42 bytes
  kXv11,      ///< Neato: 90 packets of 22 bytes, one way
  kYdlidar,   ///< AA 55 packets, 2, 3 or 4 bytes a sample
  kCamsense,  ///< Camsense X1: 36-byte packets, one way
  kDelta2,    ///< 3irobotix: big-endian packets, one way
  kHokuyo,    ///< SCIP 2.0: lines of text
  kSick,      ///< CoLa A: telegrams of text
};

/// What a direction must be turned by where it depends on the range: transmitter and receiver stand side by side.
enum class AngleShift : std::uint8_t { kNone, kYdTriangle, kYdScl, kLd14 };

/// One sensor, or several that differ in nothing that is seen here.
struct SensorModel {
  std::string_view name;   ///< as `--sensor` takes it
  std::string_view title;  ///< as people call it
  Protocol protocol;
  int baud = 0;              ///< of its serial line, 8N1; 0: it has none, or any will do
  double range_min_m = 0.0;  ///< by its data sheet; 0: unknown
  double range_max_m = 0.0;
  double turns_hz = 0.0;    ///< usual
  double samples_hz = 0.0;  ///< usual, whole sensor
  AngleShift shift = AngleShift::kNone;
  double mm_per_unit = 0.25;  ///< YDLIDAR: of a raw range whose two flag bits are cleared; 1: it has no flags
  double zero_deg = 0.0;      ///< added to every direction; where makers and drivers disagree, or models differ
  int tcp_port = 0;           ///< 0: it has no network
};

/// All of them, those of one protocol side by side, the usual one of each protocol and baud first.
std::span<const SensorModel> sensor_models();

/// Null: no sensor has that name.
const SensorModel* find_sensor(std::string_view name);

/// "rplidar", "ld06", ...
std::string_view to_string(Protocol protocol);

}  // namespace phasescan::live
