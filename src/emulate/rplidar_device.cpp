// An RPLIDAR that answers: an A1M8 of firmware 1.29 with its five modes, or a newer one with a mode or two.
#include <algorithm>
#include <cstring>

#include "emulate/device.hpp"
#include "live/checks.hpp"
#include "live/rplidar.hpp"

namespace phasescan::emulate {
namespace {

using namespace live;
using namespace live::rplidar;

struct Mode {
  const char* name;
  double us;
  int form;
};

class RplidarDevice final : public Device {
 public:
  RplidarDevice(const SensorModel& model, int health) : health_(health) {
    const double us = 1e6 / model.samples_hz;
    if (model.name == "rplidar-a1") {
      info_ = {0x18, 0x1D, 0x01, 0x07};
      modes_ = {{"Standard", 508, kNodes},
                {"Express", 254, kCapsules},
                {"Boost", 127, kUltra},
                {"Sensitivity", 127, kUltra},
                {"Stability", 201, kUltra}};
      typical_ = 3;
    } else if (model.name == "rplidar-a3") {
      info_ = {0x31, 0x1B, 0x01, 0x05};
      modes_ = {{"Standard", 250, kNodes}, {"Sensitivity", us, kUltra}};
      typical_ = 1;
    } else {
      const bool dense = model.name == "rplidar-c1" || model.name == "rplidar-s1";
      info_ = {static_cast<std::uint8_t>(model.name == "rplidar-c1"   ? 0x41
                                         : model.name == "rplidar-s1" ? 0x61
                                                                      : 0x71),
               0x01, 0x01, 0x12};
      modes_ = {{"Standard", us, kNodes}, {"DenseBoost", us, dense ? kDense : kUltraDense}};
      typical_ = 1;
    }
  }

  void hear(std::span<const std::uint8_t> bytes) override {
    heard_.insert(heard_.end(), bytes.begin(), bytes.end());
    while (heard_.size() >= 2) {
      if (heard_[0] != 0xA5) {
        heard_.erase(heard_.begin());
        continue;
      }
      const bool payload = heard_[1] & 0x80;
      if (payload && heard_.size() < 3) return;
      const std::size_t size = payload ? 4U + heard_[2] : 2U;
      if (heard_.size() < size) return;
      const Bytes request = Bytes(heard_).first(size);
      if (!payload || xor_of(request.first(size - 1)) == request[size - 1])
        obey(request[1], payload ? request.subspan(3, size - 4) : Bytes());
      heard_.erase(heard_.begin(), heard_.begin() + static_cast<std::ptrdiff_t>(size));
    }
  }

 private:
  void obey(std::uint8_t command, Bytes payload) {
    if (command == kStop || command == kReset) state_.streaming = false;
    if (command == kReset) {
      answer(std::string("RP LIDAR System.\r\nFirmware Ver 1.29, HW Ver 7\r\nModel: 18\r\n"));
      health_ = 0;
    }
    if (command == kInfo) {
      ByteString body = info_;
      for (int i = 0; i < 16; ++i) body.push_back(static_cast<std::uint8_t>(0x11 * (i % 15)));
      answer(rplidar_answer(kInfoAnswer, body));
    }
    if (command == kHealth)
      answer(rplidar_answer(kHealthAnswer,
                            ByteString{static_cast<std::uint8_t>(health_), static_cast<std::uint8_t>(2 * health_), 0}));
    if (command == kSampleRate) answer(rplidar_answer(kRateAnswer, ByteString{0xFC, 0x01, 0xFE, 0x00}));
    if (command == kMotorBoard) answer(rplidar_answer(kMotorAnswer, ByteString{1, 0, 0, 0}));
    if (command == kConf && payload.size() >= 4) answer_conf(payload);
    if (command == kScan) begin(kNodes);
    if (command == kExpress && payload.size() == 5)
      begin(payload[0] < modes_.size() && payload[0] != 0 ? modes_[payload[0]].form : kCapsules);
  }

  void begin(int form) {
    if (health_ >= 2) return;
    state_.rplidar_type = form;
    state_.streaming = true;
    answer(rplidar_descriptor(static_cast<std::uint32_t>(packet_size(form)), true, form));
  }

  void answer_conf(Bytes payload) {
    const std::uint32_t entry = u32_at(payload, 0);
    const std::size_t mode = payload.size() >= 6 ? u16_at(payload, 4) : 0;
    ByteString body(payload.begin(), payload.begin() + 4);
    const auto put = [&body](std::uint32_t value, int size) {
      for (int i = 0; i < size; ++i) body.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
    };
    if (mode >= modes_.size()) return;
    if (entry == kModeCount) put(static_cast<std::uint32_t>(modes_.size()), 2);
    if (entry == kTypicalMode) put(static_cast<std::uint32_t>(typical_), 2);
    if (entry == kModeMicroseconds) put(static_cast<std::uint32_t>(256.0 * modes_[mode].us), 4);
    if (entry == kModeRange) put(256 * 12, 4);
    if (entry == kModeAnswer) put(static_cast<std::uint32_t>(modes_[mode].form), 1);
    if (entry == kModeName)
      body.insert(body.end(), modes_[mode].name, modes_[mode].name + std::strlen(modes_[mode].name) + 1);
    answer(rplidar_answer(kConfAnswer, body));
  }

  ByteString info_, heard_;
  std::vector<Mode> modes_;
  int typical_ = 0, health_ = 0;
};

}  // namespace

std::unique_ptr<Device> make_rplidar_device(const SensorModel& model, int health) {
  return std::make_unique<RplidarDevice>(model, health);
}

}  // namespace phasescan::emulate
