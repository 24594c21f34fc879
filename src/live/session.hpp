// How one talks with a sensor: what to send, and when. No port and no clock of its own.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "phasescan/live/decoder.hpp"

namespace phasescan::live {

/// What is to be done with the port now.
struct Orders {
  std::vector<std::uint8_t> bytes;  ///< to send
  std::optional<bool> dtr;          ///< the line that switches some motors

  void send(std::span<const std::uint8_t> more) { bytes.insert(bytes.end(), more.begin(), more.end()); }
  void send(std::string_view text) { bytes.insert(bytes.end(), text.begin(), text.end()); }
};

class Session {
 public:
  virtual ~Session() = default;
  /// The port is open, or nothing came for long. @param attempt  from 0; where it is odd the motor line is tried the
  /// other way round
  virtual void start(Stamp now, int attempt, Orders& orders) = 0;
  /// What was decoded since.
  virtual void heard(const Decoded& /*decoded*/, Stamp /*now*/, Orders& /*orders*/) {}
  /// At least every 50 ms.
  virtual void tick(Stamp /*now*/, Orders& /*orders*/) {}
  /// Sensor and motor stop.
  virtual void stop(Orders& /*orders*/) {}
  /// What the sensor says is wrong with it, and what to do; empty: nothing.
  virtual std::string trouble() const { return {}; }
  /// How long after the start no scan is nothing to worry about [s].
  virtual double grace_s() const { return 3.0; }
};

std::unique_ptr<Session> make_session(const SensorModel& model);
std::unique_ptr<Session> make_rplidar_session();
std::unique_ptr<Session> make_hokuyo_session();

}  // namespace phasescan::live
