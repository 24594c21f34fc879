// Camsense X1: 36 bytes a packet, 8 samples, one way. Some send 12 samples (0C).
// Source: the community's descriptions (Vidicon/camsense-X1); the check and the step by captures (docs/live.md).
//
//   55 AA 03 08 | u16 rpm x 64 | u16 start | 8 x {u16 mm, u8 quality} | u16 end | u16 folded sum;  deg = (v - A000) /
//   64
#include <cmath>

#include "live/angle_shift.hpp"
#include "live/checks.hpp"
#include "live/stream_decoder.hpp"

namespace phasescan::live {
namespace {

class CamsenseDecoder final : public StreamDecoder {
 public:
  using StreamDecoder::StreamDecoder;

 private:
  Cut find(Bytes pending) override {
    if (pending[0] != 0x55) return Cut::skip();
    if (pending.size() < 4) return Cut::wait();
    const bool eight = pending[2] == 0x03 && pending[3] == 8, twelve = pending[2] == 0x07 && pending[3] == 12;
    if (pending[1] != 0xAA || !(eight || twelve)) return Cut::skip();
    const std::size_t size = 12U + 3U * pending[3];
    if (pending.size() < size) return Cut::wait();
    return folded_sum(pending.first(size - 2)) == u16_at(pending, size - 2) ? Cut::packet(size) : Cut::bad();
  }

  bool take(Bytes packet, const PacketTime& time, Decoded& out) override {
    const std::size_t samples = packet[3];
    const double turns = u16_at(packet, 4) / 64.0 / 60.0;
    const int from = u16_at(packet, 6) - 0xA000, to = u16_at(packet, 8 + 3 * samples) - 0xA000;
    constexpr int kFullTurn = 360 * 64;
    if (from < 0 || to < 0 || from > kFullTurn || to > kFullTurn || turns <= 0.0) return false;
    const double start = deg_to_rad(from / 64.0), rate = kTwoPi * turns;
    const double step = turned_on(start, deg_to_rad(to / 64.0)) / static_cast<double>(samples - 1);
    if (step * static_cast<double>(samples) > 0.5 * kPi) return false;
    const Stamp sent = clock_.at(time.first, known_ ? turned_on(last_start_, start) / rate : -1.0);
    known_ = true;
    last_start_ = start;
    for (std::size_t k = 0; k < samples; ++k) {
      const std::size_t at = 8 + 3 * k;
      const std::uint16_t mm = u16_at(packet, at);
      Beam beam;
      beam.sweep = std::fmod(start + step * static_cast<double>(k), kTwoPi);
      if (beam.sweep < last_sweep_) beam.mark = TurnMark::kStarts;
      last_sweep_ = beam.sweep;
      beam.angle = clockwise(beam.sweep);
      put_range(beam, mm & 0x8000 ? 0.0 : 1e-3 * mm);
      beam.intensity = packet[at + 2];
      beam.stamp = sent - stamp_from_seconds((static_cast<double>(samples - k) - 0.5) * step / rate);
      out.beams.push_back(beam);
    }
    return true;
  }

  bool known_ = false;
  double last_start_ = 0.0, last_sweep_ = 0.0;
};

}  // namespace

std::unique_ptr<Decoder> make_camsense_decoder(const SensorModel& model, double bytes_per_s) {
  return std::make_unique<CamsenseDecoder>(model, bytes_per_s);
}

}  // namespace phasescan::live
