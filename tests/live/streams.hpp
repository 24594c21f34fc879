// Whole turns of each protocol as bytes.
#pragma once

#include <ostream>
#include <string>

#include "live/packer.hpp"
#include "live/rplidar.hpp"
#include "live/wire.hpp"

namespace phasescan::live::testing {

/// A protocol, and where it has several, its form.
struct Form {
  const char* sensor;
  int samples_per_turn;
  int rplidar_type = 0;
  int ydlidar_width = 2;
  bool checked = true;  ///< its packets have a check that no single wrong bit passes
};

inline std::vector<Form> forms() {
  return {{"ld06", 450},
          {"stl27l", 2160},
          {"lds-02", 460},
          {"lds-01", 360},
          {"xv11", 360},
          {"camsense-x1", 400},
          {"delta-2b", 800},
          {"delta-2a", 336},
          {"ydlidar-x4", 720},
          {"ydlidar-tmini", 400, 0, 3},
          {"ydlidar-g4b", 1280, 0, 3},
          {"ydlidar-tg", 2000, 0, 4},
          {"hokuyo", 682},
          {"sick-tim", 811, 0, 2, false},
          {"rplidar-a1", 360, rplidar::kNodes, 2, false},
          {"rplidar-a1", 1440, rplidar::kCapsules},
          {"rplidar-a3", 1600, rplidar::kHqNodes},
          {"rplidar-a1", 1440, rplidar::kUltra},
          {"rplidar-c1", 720, rplidar::kDense},
          {"rplidar-s2", 3200, rplidar::kUltraDense}};
}

inline double samples_hz(const Form& form) {
  constexpr double kStandardNodes = 1970.0;  // of an RPLIDAR A1
  return form.rplidar_type == rplidar::kNodes ? kStandardNodes : find_sensor(form.sensor)->samples_hz;
}
inline bool is_text(const Form& form) {
  return std::string_view(form.sensor) == "hokuyo" || std::string_view(form.sensor) == "sick-tim";
}

inline PackerOptions options_of(const Form& form) {
  PackerOptions options;
  options.turns_hz = samples_hz(form) / form.samples_per_turn;
  options.samples_per_turn = form.samples_per_turn;
  options.rplidar_type = form.rplidar_type;
  options.ydlidar_width = form.ydlidar_width;
  options.start_deg = -45.0;
  options.step_deg = 360.0 / form.samples_per_turn;
  return options;
}

/// What a sensor says before its beams.
inline ByteString opening(const Form& form) {
  if (form.rplidar_type != 0)
    return rplidar_descriptor(static_cast<std::uint32_t>(rplidar::packet_size(form.rplidar_type)), true,
                              form.rplidar_type);
  if (std::string_view(form.sensor) != "hokuyo") return {};
  std::vector<std::string> lines;
  for (const char* text : {"DMIN:20", "DMAX:5600", "ARES:1024", "AMIN:44", "AMAX:725", "AFRT:384", "SCAN:600"})
    lines.push_back(scip_parameter(text));
  const std::string text = scip_answer("PP", "00", lines);
  return {text.begin(), text.end()};
}

/// Range of sample `i`: even millimetres, no two near each other alike, all within every sensor's reach.
inline double range_mm(int i) {
  return 600.0 + 2.0 * ((i * 37) % 500);
}

/// Packets of `turns` turns. Sample i of a turn is `i / samples_per_turn` of it on; the time of a sample is its number
/// over the sensor's rate.
inline std::vector<WirePacket> packets_of(const Form& form, int turns) {
  const SensorModel& model = *find_sensor(form.sensor);
  Packer packer(model, options_of(form));
  std::vector<WirePacket> packets;
  for (int turn = 0; turn < turns; ++turn) {
    for (int i = 0; i < form.samples_per_turn; ++i) {
      const WireSample sample{range_mm(i), 100, 360.0 * i / form.samples_per_turn, i == 0};
      packer.add(sample, (turn * form.samples_per_turn + i) / samples_hz(form), packets);
    }
  }
  return packets;
}

/// Told instead of its bytes, which hold an address.
inline void PrintTo(const Form& form, std::ostream* out) {
  *out << form.sensor << " " << form.rplidar_type;
}

inline std::string name_of(const Form& form) {
  std::string name = std::string(form.sensor) + (form.rplidar_type ? "_" + std::to_string(form.rplidar_type) : "");
  for (char& c : name) {
    if (c == '-') c = '_';
  }
  return name;
}

}  // namespace phasescan::live::testing
