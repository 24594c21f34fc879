// Which sensor is at a port: by listening, and by asking where nothing talks.
#pragma once

#include <functional>
#include <string>

#include "phasescan/live/sensors.hpp"

namespace phasescan::live {

/// Null: nothing known answers. @param heard  bytes that came, at any baud: something is there
/// @throws SystemError where the port cannot be opened
const SensorModel* find_sensor_at(const std::string& path, const std::function<bool()>& stop, std::size_t& heard);

}  // namespace phasescan::live
