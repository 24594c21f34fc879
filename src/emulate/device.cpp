#include "emulate/device.hpp"

#include <algorithm>

#include "live/hokuyo.hpp"

namespace phasescan::emulate {
namespace {

using namespace live;

/// Talks unasked and hears nothing.
class OneWay final : public Device {
 public:
  OneWay() { state_.streaming = true; }
  void hear(std::span<const std::uint8_t>) override {}
};

class Lds01Device final : public Device {
 public:
  void hear(std::span<const std::uint8_t> bytes) override {
    for (const std::uint8_t byte : bytes) {
      if (byte == 'b') state_.streaming = true;
      if (byte == 'e') state_.streaming = false;
    }
  }
};

/// A5 and one byte; requests of others with a length go by.
class YdlidarDevice final : public Device {
 public:
  explicit YdlidarDevice(int health) : health_(health) {}
  void hear(std::span<const std::uint8_t> bytes) override {
    for (const std::uint8_t byte : bytes) {
      if (before_ == 0xA5) obey(byte);
      before_ = byte;
    }
  }

 private:
  void obey(std::uint8_t command) {
    if (command == 0x65) state_.streaming = false;
    if (command == 0x60) {
      answer(rplidar_descriptor(5, true, 0x81));
      state_.streaming = true;
    }
    if (command == 0x90) {
      ByteString body = {6, 2, 1, 1};  // X4, firmware 1.2, hardware 1
      body.resize(20, 1);
      answer(rplidar_answer(4, body));
    }
    if (command == 0x92) answer(rplidar_answer(6, ByteString{static_cast<std::uint8_t>(health_), 0, 0}));
  }
  int health_;
  std::uint8_t before_ = 0;
};

class HokuyoDevice final : public Device {
 public:
  void hear(std::span<const std::uint8_t> bytes) override {
    for (const std::uint8_t byte : bytes) {
      if (byte != '\n' && byte != '\r') {
        if (line_.size() < 64) line_ += static_cast<char>(byte);
        continue;
      }
      if (!line_.empty()) obey(line_);
      line_.clear();
    }
  }

 private:
  void obey(const std::string& command) {
    if (command == "QT") state_.streaming = false;
    if (command == "PP") {
      std::vector<std::string> lines;
      for (const char* text : {"MODL:URG-04LX(Hokuyo Automatic Co.,Ltd.)", "DMIN:20", "DMAX:5600", "ARES:1024",
                               "AMIN:44", "AMAX:725", "AFRT:384", "SCAN:600"})
        lines.push_back(scip_parameter(text));
      return answer(scip_answer(command, "00", lines));
    }
    if (command.starts_with("MD") && command.size() == 15) {
      state_.echo = command;
      state_.streaming = true;
    }
    answer(scip_answer(command, command.starts_with("MD") || command == "BM" || command == "QT" ? "00" : "0E"));
  }
  std::string line_;
};

class SickDevice final : public Device {
 public:
  void hear(std::span<const std::uint8_t> bytes) override {
    for (const std::uint8_t byte : bytes) {
      if (byte == 2)
        telegram_.clear();
      else if (byte == 3)
        obey(telegram_);
      else if (telegram_.size() < 256)
        telegram_ += static_cast<char>(byte);
    }
  }

 private:
  void obey(const std::string& telegram) {
    if (!telegram.starts_with("sEN LMDscandata ")) return answer(std::string("\x02sFA 3\x03"));
    state_.streaming = telegram.ends_with("1");
    answer("\x02sEA LMDscandata " + telegram.substr(16) + "\x03");
  }
  std::string telegram_;
};

}  // namespace

std::unique_ptr<Device> make_device(const SensorModel& model, int health) {
  switch (model.protocol) {
    case Protocol::kRplidar:
      return make_rplidar_device(model, health);
    case Protocol::kYdlidar:
      if (model.name == "ydlidar-x2") return std::make_unique<OneWay>();
      return std::make_unique<YdlidarDevice>(health);
    case Protocol::kLds01:
      return std::make_unique<Lds01Device>();
    case Protocol::kHokuyo:
      return std::make_unique<HokuyoDevice>();
    case Protocol::kSick:
      return std::make_unique<SickDevice>();
    default:
      return std::make_unique<OneWay>();
  }
}

}  // namespace phasescan::emulate
