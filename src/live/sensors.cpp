// Bauds and protocols: the makers' manuals and drivers (docs/live.md). Ranges and rates: their data sheets.
#include "phasescan/live/sensors.hpp"

#include <array>

namespace phasescan::live {
namespace {

using enum Protocol;
using enum AngleShift;

constexpr SensorModel kModels[] = {
    {"rplidar-a1", "Slamtec RPLIDAR A1, A2M8", kRplidar, 115200, 0.15, 12.0, 5.5, 8000},
    {"rplidar-a3", "Slamtec RPLIDAR A3, A2M7, A2M12", kRplidar, 256000, 0.15, 25.0, 10.0, 16000},
    {"rplidar-s1", "Slamtec RPLIDAR S1", kRplidar, 256000, 0.1, 40.0, 10.0, 9200},
    {"rplidar-c1", "Slamtec RPLIDAR C1", kRplidar, 460800, 0.05, 12.0, 10.0, 5000},
    {"rplidar-s2", "Slamtec RPLIDAR S2, S3", kRplidar, 1000000, 0.05, 40.0, 10.0, 32000},
    {"rplidar-t1", "Slamtec RPLIDAR T1", kRplidar, 0, 0.05, 40.0, 10.0, 32000, kNone, 0.25, 0.0, 8089},
    {"ld06", "LDROBOT LD06, LD19, STL19P", kLd06, 230400, 0.02, 12.0, 10.0, 4500},
    {"stl27l", "LDROBOT STL27L", kLd06, 921600, 0.03, 25.0, 10.0, 21600},
    {"lds-02", "ROBOTIS LDS-02 (LD08)", kLd06, 115200, 0.16, 8.0, 5.0, 2300},
    {"ld14", "LDROBOT LD14", kLd06, 115200, 0.1, 8.0, 6.0, 2300, kLd14},
    {"ld14p", "LDROBOT LD14P", kLd06, 230400, 0.1, 8.0, 6.0, 4000, kLd14},
    {"lds-01", "ROBOTIS LDS-01 (HLS-LFCD2)", kLds01, 230400, 0.12, 3.5, 5.0, 1800},
    {"xv11", "Neato XV11", kXv11, 115200, 0.06, 6.0, 5.0, 1800},
    {"ydlidar-x4", "YDLIDAR X4", kYdlidar, 128000, 0.12, 10.0, 7.0, 5000, kYdTriangle},
    {"ydlidar-x2", "YDLIDAR X2, X3", kYdlidar, 115200, 0.12, 8.0, 7.0, 3000, kYdTriangle},
    {"ydlidar-g4", "YDLIDAR G4", kYdlidar, 230400, 0.28, 16.0, 7.0, 9000, kYdTriangle},
    {"ydlidar-g4b", "YDLIDAR G4B (with intensity)", kYdlidar, 512000, 0.28, 16.0, 7.0, 9000, kYdTriangle},
    {"ydlidar-scl", "YDLIDAR SCL", kYdlidar, 115200, 0.05, 8.0, 6.0, 3000, kYdScl},
    {"ydlidar-tmini", "YDLIDAR T-mini Pro, T-mini Plus", kYdlidar, 230400, 0.02, 12.0, 10.0, 4000},
    {"ydlidar-g6", "YDLIDAR G6, G7", kYdlidar, 512000, 0.28, 25.0, 10.0, 18000, kYdTriangle, 0.5},
    {"ydlidar-tg", "YDLIDAR TG15, TG30, TG50", kYdlidar, 512000, 0.05, 30.0, 10.0, 20000, kNone, 1.0},
    {"camsense-x1", "Camsense X1", kCamsense, 115200, 0.08, 8.0, 5.2, 2080},
    {"delta-2b", "3irobotix Delta-2B", kDelta2, 230400, 0.15, 8.0, 6.0, 5000},
    {"delta-2a", "3irobotix Delta-2A, 2D, 2G", kDelta2, 115200, 0.15, 8.0, 6.0, 2000},
    {"hokuyo", "Hokuyo URG-04LX, UTM-30LX, UST-10LX (SCIP 2.0)", kHokuyo, 0, 0.0, 0.0, 10.0, 10240, kNone, 0.25, 0.0,
     10940},
    {"sick-tim", "SICK TiM5xx, TiM7xx, LMS1xx, LMS5xx (CoLa A)", kSick, 0, 0.05, 0.0, 15.0, 12150, kNone, 0.25, -90.0,
     2112},
    {"sick-tim240", "SICK TiM240, LRS4 (CoLa A)", kSick, 0, 0.05, 0.0, 14.5, 5220, kNone, 0.25, 0.0, 2112},
};

}  // namespace

std::span<const SensorModel> sensor_models() {
  return kModels;
}

const SensorModel* find_sensor(std::string_view name) {
  for (const SensorModel& model : kModels) {
    if (model.name == name) return &model;
  }
  return nullptr;
}

std::string_view to_string(Protocol protocol) {
  constexpr std::string_view kNames[] = {"rplidar",  "ld06",    "lds-01", "xv11", "ydlidar",
                                         "camsense", "delta-2", "hokuyo", "sick"};
  return kNames[static_cast<std::size_t>(protocol)];
}

}  // namespace phasescan::live
