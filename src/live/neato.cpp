// Neato XV11 and its relative, the Hitachi-LG LDS-01: packets FA, A0 + i, of equal angles, one way.
// Source: the community's description of the XV11 (xv11hacking), ROBOTIS' driver of the LDS-01.
//
//   XV11    22 B: FA | A0..F9 | u16 rpm x 64 | 4 x {u16 mm or error, u16 signal} | u16 folded sum
//   LDS-01  42 B: FA | A0..DB | u16 rpm x 10 | 6 x {u16 intensity, u16 mm, 2 reserved} | 2 x (FF - sum of bytes 0-39)
#include <array>
#include <cmath>

#include "live/checks.hpp"
#include "live/stream_decoder.hpp"

namespace phasescan::live {
namespace {

constexpr double kDegree = kPi / 180.0;

/// Packets of `samples` beams, one a degree, numbered from 0 to 360 / samples - 1.
class DegreeDecoder : public StreamDecoder {
 public:
  DegreeDecoder(const SensorModel& model, double bytes_per_s, std::size_t size, int samples)
      : StreamDecoder(model, bytes_per_s), size_(size), samples_(samples) {}

 protected:
  virtual bool check(Bytes packet) const = 0;
  virtual double rpm(Bytes packet) const = 0;
  /// Range, state, intensity and direction of sample k, that of degree `degree`.
  virtual void read(Bytes packet, int k, int degree, Beam& beam) const = 0;

 private:
  Cut find(Bytes pending) final {
    if (pending[0] != 0xFA) return Cut::skip();
    if (pending.size() < 2) return Cut::wait();
    if (pending[1] < 0xA0 || pending[1] >= 0xA0 + 360 / samples_) return Cut::skip();
    if (pending.size() < size_) return Cut::wait();
    return check(pending.first(size_)) ? Cut::packet(size_) : Cut::bad();
  }

  bool take(Bytes packet, const PacketTime& time, Decoded& out) final {
    const int index = packet[1] - 0xA0, first = index * samples_;
    // Above 20 turns a second no such sensor turns; one that stands still sends what it saw before.
    const double turns = rpm(packet) / 60.0;
    const bool turning = turns > 0.1 && turns < 20.0;
    const double step = turning ? 1.0 / (360.0 * turns) : 0.0;
    const int before = 360 / samples_;
    const double elapsed = last_ >= 0 && turning ? ((index - last_ + before) % before) * samples_ * step : -1.0;
    const Stamp sent = clock_.at(time.first, elapsed);
    for (int k = 0; k < samples_; ++k) {
      Beam beam;
      beam.sweep = (first + k) * kDegree;
      if (k == 0 && index <= last_) beam.mark = TurnMark::kStarts;
      beam.stamp = sent - stamp_from_seconds((samples_ - 0.5 - k) * step);
      read(packet, k, first + k, beam);
      out.beams.push_back(beam);
    }
    last_ = index;
    return true;
  }

  std::size_t size_;
  int samples_, last_ = -1;
};

class Xv11Decoder final : public DegreeDecoder {
 public:
  Xv11Decoder(const SensorModel& model, double bytes_per_s) : DegreeDecoder(model, bytes_per_s, 22, 4) {}

 private:
  bool check(Bytes packet) const override { return folded_sum(packet.first(20)) == u16_at(packet, 20); }
  double rpm(Bytes packet) const override { return u16_at(packet, 2) / 64.0; }
  void read(Bytes packet, int k, int degree, Beam& beam) const override {
    const std::size_t at = 4 + 4 * static_cast<std::size_t>(k);
    const std::uint16_t word = u16_at(packet, at);
    beam.angle = counter_clockwise(degree * kDegree);
    // Bit 15: no range, the low byte is why. Bit 14: weaker than expected, the range is right all the same.
    put_range(beam, word & 0x8000 ? 0.0 : 1e-3 * (word & 0x3FFF));
    beam.intensity = u16_at(packet, at + 2);
  }
};

class Lds01Decoder final : public DegreeDecoder {
 public:
  Lds01Decoder(const SensorModel& model, double bytes_per_s) : DegreeDecoder(model, bytes_per_s, 42, 6) {}

 private:
  bool check(Bytes packet) const override {
    const auto sum = static_cast<std::uint8_t>(0xFF - byte_sum(packet.first(40)));
    return packet[40] == sum && packet[41] == sum;
  }
  double rpm(Bytes packet) const override { return u16_at(packet, 2) / 10.0; }
  void read(Bytes packet, int k, int degree, Beam& beam) const override {
    const std::size_t at = 4 + 6 * static_cast<std::size_t>(k);
    // The maker's driver puts degree 0 at 359: a clockwise sensor whose first beam is one step off ahead.
    beam.angle = clockwise((degree + 1) * kDegree);
    beam.intensity = u16_at(packet, at);
    put_range(beam, 1e-3 * u16_at(packet, at + 2));
  }
};

}  // namespace

std::unique_ptr<Decoder> make_xv11_decoder(const SensorModel& model, double bytes_per_s) {
  return std::make_unique<Xv11Decoder>(model, bytes_per_s);
}

std::unique_ptr<Decoder> make_lds01_decoder(const SensorModel& model, double bytes_per_s) {
  return std::make_unique<Lds01Decoder>(model, bytes_per_s);
}

}  // namespace phasescan::live
