// A session with an RPLIDAR: stop what may still run, ask what it is, how it is and how it scans best, then scan.
#include <string_view>

#include "live/rplidar.hpp"
#include "live/session.hpp"

namespace phasescan::live {
namespace {

using namespace rplidar;

constexpr double kDrain_s = 0.15;  // the SDK waits 0.1 s after STOP; what was on its way goes by
constexpr double kAnswer_s = 0.5;  // answers come within milliseconds
constexpr double kReset_s = 2.2;   // an S1 is silent for 2 s after RESET
constexpr int kInfoTries = 4;
constexpr int kReboots = 3;  // greetings within one session: it starts again and again
constexpr std::uint16_t kFirmwareWithModes = 1 << 8 | 24;

class RplidarSession final : public Session {
 public:
  void start(Stamp now, int attempt, Orders& orders) override {
    reversed_ = attempt % 2 == 1;
    orders.dtr = reversed_;  // cleared spins the motor of an A1; Linux sets it when a port is opened
    orders.send(request(kStop));
    tries_ = 0;
    mode_.reset();
    go(Step::kDrain, now, kDrain_s);
  }

  void heard(const Decoded& decoded, Stamp now, Orders& orders) override {
    if (!decoded.beams.empty()) trouble_.clear();
    for (const Reply& reply : decoded.replies) hear(reply, now, orders);
  }

  void tick(Stamp now, Orders& orders) override {
    if (now < until_) return;
    switch (step_) {
      case Step::kDrain:
        return ask(Step::kInfo, request(kInfo), now, orders);
      case Step::kInfo:
        if (++tries_ < kInfoTries) return ask(Step::kInfo, request(kInfo), now, orders);
        trouble_ = "no answer from an RPLIDAR; is it one, is its baud right (--sensor), does it get 5 V?";
        return scan(now, orders);
      case Step::kHealth:
        return motor(now, orders);
      case Step::kMotor:
        return modes(now, orders);
      case Step::kRate:
      case Step::kTypical:
      case Step::kForm:
      case Step::kMicroseconds:
        return scan(now, orders);
      case Step::kReset:
        return ask(Step::kInfo, request(kInfo), now, orders);
      case Step::kScan:
        return;
    }
  }

  void stop(Orders& orders) override {
    orders.send(request(kStop));
    if (pwm_) orders.send(request(kPwm, std::vector<std::uint8_t>{0, 0}));
    if (model_ >= 0x60) orders.send(request(kRpm, std::vector<std::uint8_t>{0, 0}));
    orders.dtr = !reversed_;
  }

  std::string trouble() const override { return trouble_; }
  double grace_s() const override { return 8.0; }  // an S3 takes 5 s to spin up

 private:
  enum class Step { kDrain, kInfo, kHealth, kMotor, kRate, kTypical, kForm, kMicroseconds, kReset, kScan };

  void go(Step step, Stamp now, double wait_s) {
    step_ = step;
    until_ = now + stamp_from_seconds(wait_s);
  }
  void ask(Step step, const std::vector<std::uint8_t>& bytes, Stamp now, Orders& orders) {
    orders.send(bytes);
    go(step, now, kAnswer_s);
  }

  void hear(const Reply& reply, Stamp now, Orders& orders) {
    const Bytes body = reply.bytes;
    if (reply.type == Reply::kBanner) {
      if (++banners_ >= kReboots)
        trouble_ = "the sensor starts again and again: its power breaks down; use a shorter cable or another supply";
      if (step_ != Step::kScan) tries_ = 0;
      if (step_ == Step::kScan) ask(Step::kInfo, request(kInfo), now, orders);
    } else if (reply.type == kInfoAnswer && step_ == Step::kInfo && body.size() >= 20) {
      model_ = body[0];
      firmware_ = static_cast<std::uint16_t>(body[2] << 8 | body[1]);
      ask(Step::kHealth, request(kHealth), now, orders);
    } else if (reply.type == kHealthAnswer && step_ == Step::kHealth && body.size() >= 3) {
      health(body, now, orders);
    } else if (reply.type == kMotorAnswer && step_ == Step::kMotor && body.size() >= 4) {
      pwm_ = body[0] & 1;
      if (pwm_) orders.send(request(kPwm, std::vector<std::uint8_t>{0x94, 0x02}));
      modes(now, orders);
    } else if (reply.type == kRateAnswer && step_ == Step::kRate) {
      scan(now, orders);
    } else if (reply.type == kConfAnswer && body.size() >= 4) {
      conf(u32_at(body, 0), body.subspan(4), now, orders);
    }
  }

  void health(Bytes body, Stamp now, Orders& orders) {
    if (body[0] < 2) return motor(now, orders);
    trouble_ = "the sensor reports a fault, code " + std::to_string(u16_at(body, 1)) +
               ", and is reset; if it stays: is the head free to turn, does it get 5 V?";
    orders.send(request(kReset));
    go(Step::kReset, now, kReset_s);
  }

  void motor(Stamp now, Orders& orders) {
    if (model_ >= 0x60) orders.send(request(kRpm, std::vector<std::uint8_t>{0x58, 0x02}));
    if (model_ >= 0x20 && model_ < 0x60)
      return ask(Step::kMotor, request(kMotorBoard, std::vector<std::uint8_t>(4, 0)), now, orders);
    modes(now, orders);
  }

  void modes(Stamp now, Orders& orders) {
    if (firmware_ >= kFirmwareWithModes || model_ >= 0x40)
      return ask(Step::kTypical, conf_request(kTypicalMode), now, orders);
    mode_ = 0;
    form_ = kCapsules;
    ask(Step::kRate, request(kSampleRate), now, orders);
  }

  void conf(std::uint32_t entry, Bytes value, Stamp now, Orders& orders) {
    if (entry == kTypicalMode && step_ == Step::kTypical && value.size() >= 2) {
      mode_ = u16_at(value, 0);
      ask(Step::kForm, conf_request(kModeAnswer, mode_), now, orders);
    } else if (entry == kModeAnswer && step_ == Step::kForm && !value.empty()) {
      form_ = value[0];
      if (packet_size(form_) == 0) mode_.reset();  // a form that is not known here
      ask(Step::kMicroseconds, conf_request(kModeMicroseconds, mode_.value_or(0)), now, orders);
    } else if (entry == kModeMicroseconds && step_ == Step::kMicroseconds) {
      scan(now, orders);
    }
  }

  void scan(Stamp now, Orders& orders) {
    const bool express = mode_ && form_ != 0 && form_ != kNodes;
    if (express)
      orders.send(request(kExpress, std::vector<std::uint8_t>{static_cast<std::uint8_t>(*mode_), 0, 0, 0, 0}));
    else
      orders.send(request(kScan));
    go(Step::kScan, now, 0.0);
  }

  Step step_ = Step::kDrain;
  Stamp until_ = 0;
  int tries_ = 0, banners_ = 0, model_ = 0, form_ = 0;
  std::uint16_t firmware_ = 0;
  std::optional<std::uint16_t> mode_;
  bool pwm_ = false, reversed_ = false;
  std::string trouble_;
};

}  // namespace

std::unique_ptr<Session> make_rplidar_session() {
  return std::make_unique<RplidarSession>();
}

}  // namespace phasescan::live
