#include "live/packet_clock.hpp"

#include <algorithm>
#include <cmath>

namespace phasescan::live {
namespace {

// So much a true clock may gain on the sensor's account, once its rate is measured: 10 ms of lateness at both ends of a
// window of 2 s. A packet that was 10 ms late is forgotten within a second.
constexpr double kGain = 0.01;
constexpr double kFirstWindow_s = 0.5, kLongestWindow_s = 2.0;
// Later than this is not lateness of one packet: packets were lost or the computer stood still.
constexpr double kMostLate_s = 0.1;
// A sensor that is this far from what it says of itself does not tell its time at all.
constexpr double kMostRate = 2.0;

}  // namespace

void PacketClock::measure_rate(Stamp observed, double elapsed_s) {
  window_said_s_ += elapsed_s;
  if (window_said_s_ < window_s_) return;
  const double rate = stamp_to_seconds(observed - window_from_) / window_said_s_;
  if (rate > 1.0 / kMostRate && rate < kMostRate) rate_ = rate;
  window_s_ = std::min(kLongestWindow_s, 2.0 * window_s_);
  window_from_ = observed;
  window_said_s_ = 0.0;
}

Stamp PacketClock::at(Stamp observed, double elapsed_s) {
  Stamp stamp = observed;
  bool follows = known_ && std::isfinite(elapsed_s) && elapsed_s >= 0.0 && elapsed_s < 10.0;
  if (follows) {
    const Stamp expected = last_ + stamp_from_seconds(elapsed_s * rate_ * (1.0 + kGain));
    follows = observed - expected < stamp_from_seconds(kMostLate_s);
    if (follows) stamp = std::min(observed, expected);
  }
  if (follows) {
    measure_rate(observed, elapsed_s);
  } else {
    window_from_ = observed;
    window_said_s_ = 0.0;
    window_s_ = kFirstWindow_s;
  }
  if (known_) stamp = std::max(stamp, last_);
  known_ = true;
  last_ = stamp;
  return stamp;
}

}  // namespace phasescan::live
