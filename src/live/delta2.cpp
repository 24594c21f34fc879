// 3irobotix Delta-2A, 2B, 2D, 2G: big-endian packets, one way.
// Source: the vendor's serial protocol of the Delta-2 series (docs/live.md).
//
//   AA | u16 length | version | 61 | AD | u16 n | u8 0.05 turns/s | i16 offset | u16 start 0.01 deg |
//   (n - 5) / 3 x {u8 signal, u16 0.25 mm} | u16 sum of the bytes before;  AE instead of AD: the speed is wrong
#include <cmath>

#include "live/angle_shift.hpp"
#include "live/checks.hpp"
#include "live/stream_decoder.hpp"

namespace phasescan::live {
namespace {

constexpr std::size_t kHead = 8;         // up to the first byte that n counts
constexpr std::size_t kMostBody = 1024;  // samples of a packet: 24 deg at 20 kHz and 2 turns a second are below 700
constexpr double kWide = 24.0, kNarrow = 22.5;  // degrees a packet: 2G, the others

class Delta2Decoder final : public StreamDecoder {
 public:
  using StreamDecoder::StreamDecoder;

 private:
  Cut find(Bytes pending) override {
    if (pending[0] != 0xAA) return Cut::skip();
    if (pending.size() < kHead) return Cut::wait();
    const std::size_t length = u16_be_at(pending, 1), body = u16_be_at(pending, 6);
    const bool known = pending[3] <= 1 && pending[4] == 0x61 && (pending[5] == 0xAD || pending[5] == 0xAE);
    if (!known || length != kHead + body || body > kMostBody || body < 1) return Cut::skip();
    if (pending.size() < length + 2) return Cut::wait();
    const auto sum = static_cast<std::uint16_t>(byte_sum(pending.first(length)));
    return sum == u16_be_at(pending, length) ? Cut::packet(length + 2) : Cut::bad();
  }

  bool take(Bytes packet, const PacketTime& time, Decoded& out) override {
    const std::size_t body = u16_be_at(packet, 6);
    const double turns = 0.05 * packet[8];
    if (packet[5] == 0xAE) {
      out.replies.push_back({0xAE, {packet.begin() + 8, packet.begin() + 8 + static_cast<std::ptrdiff_t>(body)}});
      return true;
    }
    if (body < 8 || (body - 5) % 3 != 0 || u16_be_at(packet, 11) > 36000 || turns <= 0.0) return false;
    const std::size_t samples = (body - 5) / 3;
    const double start = deg_to_rad(0.01 * u16_be_at(packet, 11)), rate = kTwoPi * turns;
    const double on = known_ ? turned_on(last_start_, start) : 0.0;
    if (std::abs(rad_to_deg(on) - kWide) < 0.5) packet_deg_ = kWide;
    if (std::abs(rad_to_deg(on) - kNarrow) < 0.5) packet_deg_ = kNarrow;
    const Stamp sent = clock_.at(time.first, known_ ? on / rate : -1.0);
    known_ = true;
    last_start_ = start;
    const double step = deg_to_rad(packet_deg_) / static_cast<double>(samples);
    for (std::size_t k = 0; k < samples; ++k) {
      const std::size_t at = 13 + 3 * k;
      Beam beam;
      beam.sweep = std::fmod(start + step * static_cast<double>(k), kTwoPi);
      if (beam.sweep < last_sweep_) beam.mark = TurnMark::kStarts;
      last_sweep_ = beam.sweep;
      beam.angle = clockwise(beam.sweep);
      put_range(beam, 0.25e-3 * u16_be_at(packet, at + 1));
      beam.intensity = packet[at];
      beam.stamp = sent - stamp_from_seconds((static_cast<double>(samples - k) - 0.5) * step / rate);
      out.beams.push_back(beam);
    }
    return true;
  }

  bool known_ = false;
  double last_start_ = 0.0, last_sweep_ = 0.0, packet_deg_ = kNarrow;
};

}  // namespace

std::unique_ptr<Decoder> make_delta2_decoder(const SensorModel& model, double bytes_per_s) {
  return std::make_unique<Delta2Decoder>(model, bytes_per_s);
}

}  // namespace phasescan::live
