// YDLIDAR, triangulating and time-of-flight models, with or without intensity.
// Source: YDLIDAR, "X4 development manual" and those of its other models; widths and scales: docs/live.md.
//
//   AA 55 | CT | LSN | u16 FSA | u16 LSA | u16 CS | LSN samples of 2 {range}, 3 {u8 signal, range} or 4 {u16, range}
//   bytes AA 66 | XOR of the rest | u32 ms | 0        the sensor's clock A5 5A | answer to a request, as RPLIDAR's
#include <algorithm>
#include <array>
#include <cmath>

#include "live/angle_shift.hpp"
#include "live/checks.hpp"
#include "live/stream_decoder.hpp"

namespace phasescan::live {
namespace {

constexpr std::size_t kHead = 10, kClock = 8, kAnswerHead = 7;
constexpr std::size_t kMostSamples = 80;
constexpr int kBadBeforeOtherWidth = 3;  // packets in a row, before the width of a sample is looked for again

std::uint16_t ydlidar_sum(Bytes packet, std::size_t samples, std::size_t width) {
  std::uint32_t sum = 0x55AA ^ u16_at(packet, 2) ^ u16_at(packet, 4) ^ u16_at(packet, 6);
  for (std::size_t k = 0; k < samples; ++k) {
    const std::size_t at = kHead + k * width;
    if (width == 3) sum ^= packet[at];
    if (width == 4) sum ^= u16_at(packet, at);
    sum ^= u16_at(packet, at + width - 2);
  }
  return static_cast<std::uint16_t>(sum);
}

class YdlidarDecoder final : public StreamDecoder {
 public:
  using StreamDecoder::StreamDecoder;

 private:
  Cut find(Bytes pending) override {
    if (pending[0] == 0xA5) return find_answer(pending);
    if (pending[0] != 0xAA) return Cut::skip();
    if (pending.size() < 2) return Cut::wait();
    if (pending[1] == 0x66) {
      if (pending.size() < kClock) return Cut::wait();
      const bool right = (xor_of(pending.first(kClock)) ^ pending[2]) == pending[2];
      return right ? Cut::packet(kClock) : Cut::bad();
    }
    if (pending[1] != 0x55) return Cut::skip();
    if (pending.size() < kHead) return Cut::wait();
    const std::size_t samples = pending[3];
    if (samples == 0 || samples > kMostSamples) return Cut::bad();
    for (const std::size_t width : {2, 3, 4}) {
      if (width_ != 0 && width != width_) continue;
      const std::size_t size = kHead + samples * width;
      if (pending.size() < size) return Cut::wait();
      if (ydlidar_sum(pending, samples, width) != u16_at(pending, 8)) continue;
      width_ = width;
      bad_in_a_row_ = 0;
      return Cut::packet(size);
    }
    if (++bad_in_a_row_ >= kBadBeforeOtherWidth) width_ = 0;
    return Cut::bad();
  }

  static Cut find_answer(Bytes pending) {
    if (pending.size() < 2) return Cut::wait();
    if (pending[1] != 0x5A) return Cut::skip();
    if (pending.size() < kAnswerHead) return Cut::wait();
    const std::uint32_t size = u32_at(pending, 2) & 0x3FFFFFFF;
    const int type = pending[6];
    if (type == 0x81) return size == 5 ? Cut::packet(kAnswerHead) : Cut::skip();  // the beginning of the scan
    if (!((type == 4 && size == 20) || (type == 6 && size == 3))) return Cut::skip();
    return pending.size() < kAnswerHead + size ? Cut::wait() : Cut::packet(kAnswerHead + size);
  }

  bool take(Bytes packet, const PacketTime& time, Decoded& out) override {
    if (packet[0] == 0xA5) {
      out.replies.push_back({packet[6], {packet.begin() + kAnswerHead, packet.end()}});
      return true;
    }
    if (packet[1] == 0x66) return true;
    const std::size_t samples = packet[3];
    const double start = deg_to_rad((u16_at(packet, 4) >> 1) / 64.0), end = deg_to_rad((u16_at(packet, 6) >> 1) / 64.0);
    if (start > kTwoPi || end > kTwoPi) return false;
    const double step = samples > 1 ? turned_on(start, end) / static_cast<double>(samples - 1) : 0.0;
    // Packets are far shorter than a quarter turn; one that is not has its ends confused.
    if (step * static_cast<double>(samples) > 0.5 * kPi) return false;
    if (step > 0.0) step_ = step;
    const double sample_s = 1.0 / model().samples_hz;
    // Packets differ in length: from the last sample of one to that of the next.
    const double elapsed = known_ && step_ > 0.0 ? turned_on(last_end_, end) / step_ * sample_s : -1.0;
    known_ = true;
    last_end_ = end;
    const Stamp sent = clock_.at(time.first, elapsed);
    for (std::size_t k = 0; k < samples; ++k) {
      Beam beam = read(packet, kHead + k * width_);
      const double turned = start + step * static_cast<double>(k);
      beam.sweep = std::fmod(turned, kTwoPi);
      beam.angle = clockwise(turned + angle_shift(model().shift, 1e3 * beam.range_m));
      // The packet that begins a turn says so; its direction is anything near 340-360 degrees.
      if (k == 0 && packet[2] & 1) beam.mark = TurnMark::kStarts;
      beam.stamp = sent - stamp_from_seconds((static_cast<double>(samples - k) - 0.5) * sample_s);
      out.beams.push_back(beam);
    }
    return true;
  }

  Beam read(Bytes packet, std::size_t at) const {
    Beam beam;
    const std::uint16_t raw = u16_at(packet, at + width_ - 2);
    const bool flags = model().mm_per_unit < 0.3;  // two bits beside the range: quality, glass, sunlight
    put_range(beam, 1e-3 * (flags ? raw & 0xFFFC : raw) * model().mm_per_unit);
    if (width_ == 3) {
      const bool ten_bits = model().shift == AngleShift::kYdTriangle;  // G4B
      beam.intensity = static_cast<float>(packet[at] + (ten_bits ? (raw & 3) << 8 : 0));
    } else if (width_ == 4) {
      beam.intensity = u16_at(packet, at);
    }
    return beam;
  }

  std::size_t width_ = 0;  ///< of a sample, in bytes; 0: unknown
  int bad_in_a_row_ = 0;
  bool known_ = false;
  double last_end_ = 0.0, step_ = 0.0;
};

}  // namespace

std::unique_ptr<Decoder> make_ydlidar_decoder(const SensorModel& model, double bytes_per_s) {
  return std::make_unique<YdlidarDecoder>(model, bytes_per_s);
}

}  // namespace phasescan::live
