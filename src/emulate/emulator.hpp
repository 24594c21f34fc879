/// A sensor that is not there: what it would send in a simulated world, at the pace of its line, with faults.
#pragma once

#include <functional>
#include <string>

#include "phasescan/live/sensors.hpp"
#include "sim/path.hpp"
#include "sim/world.hpp"

namespace phasescan::emulate {

/// What goes wrong on the way.
struct Faults {
  double drop = 0.0;          ///< share of the bytes that are lost
  double repeat = 0.0;        ///< share of the bytes that come twice
  double corrupt = 0.0;       ///< share of the bytes with a wrong bit
  double delay_s = 0.0;       ///< bytes are held back and come in bursts this long
  double stall_at_s = -1.0;   ///< nothing comes from then on ..
  double stall_s = 0.0;       ///< .. for so long
  double unplug_at_s = -1.0;  ///< the port is gone from then on ..
  double replug_s = 1.0;      ///< .. for so long
  double every_s = 0.0;       ///< stall and unplugging come again after so long; 0: once
  int health = 0;             ///< of the sensor's own report: 0 good, 1 warning, 2 fault
};

struct EmulatorOptions {
  live::SensorModel model;
  sim::World world;
  sim::PathOptions path;
  std::uint64_t seed = 1;
  bool tcp = false, udp = false;  ///< a port of this machine instead of a pseudo-terminal
  int network_port = 0;           ///< 0: any that is free
  std::string alias;              ///< a link to the pseudo-terminal
  std::string truth;              ///< where the laser was, TUM, by the computer's clock; empty: not written
  Faults faults;
};

struct EmulatorReport {
  std::size_t packets = 0;
  double seconds = 0.0;  ///< of the drive
};

/// Until the drive ends or `stop` says so. @param ready  is told the port's name
EmulatorReport run_emulator(const EmulatorOptions& options, const std::function<void(const std::string&)>& ready,
                            const std::function<bool()>& stop);

}  // namespace phasescan::emulate
