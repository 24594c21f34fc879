// Sessions with sensors that need a word or two, and with those that talk unasked.
#include "live/session.hpp"

#include "live/sick.hpp"

namespace phasescan::live {
namespace {

/// Sends what starts the sensor, and what stops it in the end.
class PlainSession : public Session {
 public:
  PlainSession(std::string start, std::string stop, std::optional<bool> spins = {})
      : start_(std::move(start)), stop_(std::move(stop)), spins_(spins) {}

  void start(Stamp, int attempt, Orders& orders) override {
    if (spins_) orders.dtr = *spins_ != (attempt % 2 == 1);
    orders.send(start_);
  }
  void stop(Orders& orders) override {
    orders.send(stop_);
    if (spins_) orders.dtr = !*spins_;
  }

 private:
  std::string start_, stop_;
  std::optional<bool> spins_;
};

class SickSession final : public PlainSession {
 public:
  SickSession() : PlainSession(sick::kStart, sick::kStopSending) {}

  void heard(const Decoded& decoded, Stamp, Orders&) override {
    if (!decoded.beams.empty()) trouble_.clear();
    for (const Reply& reply : decoded.replies) {
      const std::string_view text(reinterpret_cast<const char*>(reply.bytes.data()), reply.bytes.size());
      if (reply.type == sick::kBinary)
        trouble_ = "the sensor is set to the binary form of its protocol (CoLa B); set it to CoLa A with SOPAS";
      if (reply.type == sick::kTelegram && text.starts_with("sFA"))
        trouble_ = "the sensor refuses to send scans (" + std::string(text.substr(0, 16)) + ")";
    }
  }
  std::string trouble() const override { return trouble_; }

 private:
  std::string trouble_;
};

constexpr char kLd14Start[] = "\x54\xA0\x04\x00\x00\x00\x00\x5E", kLd14Stop[] = "\x54\xA1\x04\x00\x00\x00\x00\x4A";

}  // namespace

std::unique_ptr<Session> make_session(const SensorModel& model) {
  switch (model.protocol) {
    case Protocol::kRplidar:
      return make_rplidar_session();
    case Protocol::kHokuyo:
      return make_hokuyo_session();
    case Protocol::kSick:
      return std::make_unique<SickSession>();
    case Protocol::kYdlidar:
      return std::make_unique<PlainSession>("\xA5\x60", "\xA5\x65", true);
    case Protocol::kLds01:
      return std::make_unique<PlainSession>("b", "e");
    case Protocol::kLd06:
      if (model.shift == AngleShift::kLd14)
        return std::make_unique<PlainSession>(std::string(kLd14Start, 8), std::string(kLd14Stop, 8));
      break;
    default:
      break;
  }
  return std::make_unique<PlainSession>("", "");
}

}  // namespace phasescan::live
