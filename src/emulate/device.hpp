// What an emulated sensor does when it is spoken to.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "live/packer.hpp"

namespace phasescan::emulate {

/// What a device sends, and whether its beams go out.
struct DeviceState {
  bool streaming = false;
  int rplidar_type = 0x81;                ///< form that was asked for
  std::string echo;                       ///< Hokuyo: the command that is being answered
  std::vector<live::ByteString> answers;  ///< to be sent before anything else
};

class Device {
 public:
  virtual ~Device() = default;
  /// Bytes from the host.
  virtual void hear(std::span<const std::uint8_t> bytes) = 0;
  DeviceState& state() { return state_; }

 protected:
  void answer(live::ByteString bytes) { state_.answers.push_back(std::move(bytes)); }
  void answer(const std::string& text) { state_.answers.emplace_back(text.begin(), text.end()); }
  DeviceState state_;
};

std::unique_ptr<Device> make_device(const live::SensorModel& model, int health);
std::unique_ptr<Device> make_rplidar_device(const live::SensorModel& model, int health);

}  // namespace phasescan::emulate
