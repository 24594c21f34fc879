// LDROBOT LD06, LD19, STL19P, STL27L, LD14 and ROBOTIS LDS-02: 47 bytes a packet, 12 samples, one way.
// Source: LDROBOT, "LD06 development manual"; the vendor's SDKs for LD14's shift and the speeds.
//
//   54 2C | u16 speed deg/s | u16 start 0.01 deg | 12 x {u16 mm, u8 intensity} | u16 end 0.01 deg | u16 ms | CRC-8
#include <algorithm>
#include <cmath>

#include "live/angle_shift.hpp"
#include "live/checks.hpp"
#include "live/stream_decoder.hpp"

namespace phasescan::live {
namespace {

constexpr std::size_t kSize = 47, kSamples = 12;
constexpr std::uint16_t kFullTurn = 36000;  // 0.01 deg

class Ld06Decoder final : public StreamDecoder {
 public:
  using StreamDecoder::StreamDecoder;

 private:
  Cut find(Bytes pending) override {
    if (pending[0] != 0x54) return Cut::skip();
    if (pending.size() < 2) return Cut::wait();
    if (pending[1] != 0x2C) return Cut::skip();
    if (pending.size() < kSize) return Cut::wait();
    return crc8_4d(pending.first(kSize - 1)) == pending[kSize - 1] ? Cut::packet(kSize) : Cut::bad();
  }

  bool take(Bytes packet, const PacketTime& time, Decoded& out) override {
    const std::uint16_t speed = u16_at(packet, 2), from = u16_at(packet, 4), to = u16_at(packet, 42);
    if (from > kFullTurn || to > kFullTurn || speed == 0) return false;
    const double start = deg_to_rad(0.01 * from), rate = deg_to_rad(speed);
    const double step = turned_on(start, deg_to_rad(0.01 * to)) / (kSamples - 1);
    // Twelve samples of a quarter turn or more are no packet of a sensor that turns.
    if (step * kSamples > 0.5 * kPi || !usual(step)) return false;
    const double elapsed = known_ ? turned_on(last_start_, start) / rate : -1.0;
    known_ = true;
    last_start_ = start;
    const Stamp sent = clock_.at(time.first, elapsed);
    for (std::size_t k = 0; k < kSamples; ++k) {
      const std::size_t at = 6 + 3 * k;
      const std::uint16_t mm = u16_at(packet, at);
      Beam beam;
      const double turned = start + step * static_cast<double>(k);
      beam.sweep = std::fmod(turned, kTwoPi);
      if (beam.sweep < last_sweep_) beam.mark = TurnMark::kStarts;
      last_sweep_ = beam.sweep;
      beam.angle = clockwise(turned + angle_shift(model().shift, mm));
      put_range(beam, 1e-3 * mm);
      beam.intensity = packet[at + 2];
      beam.stamp = sent - stamp_from_seconds((kSamples - 0.5 - static_cast<double>(k)) * step / rate);
      out.beams.push_back(beam);
    }
    return true;
  }

  /// One wrong packet in 256 passes its check. The steps of a turning head change slowly.
  bool usual(double step) {
    constexpr int kOddOnes = 5;  // so many in a row: the speed is another now
    const bool alike = step_ > 0.0 && step > 0.5 * step_ && step < 2.0 * step_;
    if (!alike && step_ > 0.0 && ++odd_ < kOddOnes) return false;
    step_ = step;
    odd_ = 0;
    return true;
  }

  bool known_ = false;
  int odd_ = 0;
  double step_ = 0.0;
  double last_start_ = 0.0, last_sweep_ = 0.0;
};

}  // namespace

std::unique_ptr<Decoder> make_ld06_decoder(const SensorModel& model, double bytes_per_s) {
  return std::make_unique<Ld06Decoder>(model, bytes_per_s);
}

}  // namespace phasescan::live
