// A session with a Hokuyo sensor: stop, ask for its parameters, switch the laser on, ask for scans without end.
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>

#include "live/hokuyo.hpp"
#include "live/session.hpp"

namespace phasescan::live {
namespace {

constexpr double kDrain_s = 0.1, kAnswer_s = 1.0;

class HokuyoSession final : public Session {
 public:
  void start(Stamp now, int, Orders& orders) override {
    orders.send("QT\n");
    asked_at_ = now + stamp_from_seconds(kDrain_s);
    waiting_ = true;
  }

  void tick(Stamp now, Orders& orders) override {
    if (!waiting_ || now < asked_at_) return;
    orders.send("PP\n");
    asked_at_ = now + stamp_from_seconds(kAnswer_s);
  }

  void heard(const Decoded& decoded, Stamp, Orders& orders) override {
    if (!decoded.beams.empty()) trouble_.clear();
    for (const Reply& reply : decoded.replies) {
      const std::string text(reply.bytes.begin(), reply.bytes.end());
      const std::string status = text.substr(std::min(text.find('\n'), text.size() - 1) + 1, 2);
      if (reply.type == scip::reply_type('P', 'P') && waiting_) {
        waiting_ = false;
        first_ = parameter(text, "AMIN:");
        last_ = parameter(text, "AMAX:");
        orders.send("BM\n");
      } else if (reply.type == scip::reply_type('B', 'M')) {
        if (status == "00" || status == "02") {
          orders.send(fmt::format("MD{:04d}{:04d}01000\n", first_, last_));
        } else {
          trouble_ =
              "the laser cannot be switched on (status " + status + "); is it clean, is its supply strong enough?";
        }
      } else if (reply.type == scip::reply_type('M', 'D') && status == "0E") {
        orders.send("TM2\n");  // it sets its clock and sends nothing
      }
    }
  }

  void stop(Orders& orders) override { orders.send("QT\n"); }
  std::string trouble() const override { return trouble_; }

 private:
  static int parameter(const std::string& text, const char* name) {
    const std::size_t at = text.find(name);
    const int value = at == std::string::npos ? 0 : std::atoi(text.c_str() + at + 5);
    return std::clamp(value, 0, 9999);
  }

  Stamp asked_at_ = 0;
  bool waiting_ = false;
  int first_ = 0, last_ = 0;
  std::string trouble_;
};

}  // namespace

std::unique_ptr<Session> make_hokuyo_session() {
  return std::make_unique<HokuyoSession>();
}

}  // namespace phasescan::live
