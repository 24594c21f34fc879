// The stream of an RPLIDAR: answers, each with a descriptor before it, and after the one that begins a scan nodes or
// capsules without end.
#include <algorithm>
#include <cmath>
#include <string_view>

#include "live/angle_shift.hpp"
#include "live/checks.hpp"
#include "live/rplidar.hpp"

namespace phasescan::live {
namespace {

using namespace rplidar;

constexpr std::size_t kDescriptor = 7;
// A node has no check but two bits and their complements: random bytes pass one time in four. A node counts where it
// and so many behind it pass.
constexpr std::size_t kRun = 6;
constexpr std::string_view kBannerText = "RP LIDAR";
// Samples a second from 2,000 (A1, standard) to 32,000 (S2): what is stated beyond twice that is nonsense.
constexpr double kLeastSample_s = 15e-6, kMostSample_s = 1e-3;

bool node_is_right(Bytes node) {
  return ((node[0] ^ node[0] >> 1) & 1) == 1 && (node[1] & 1) == 1;
}

/// Size of what follows a descriptor; 0: it is none that is known.
std::size_t described(Bytes bytes) {
  const std::uint32_t word = u32_at(bytes, 2), size = word & 0x3FFFFFFF, repeated = word >> 30;
  const int type = bytes[6];
  if (packet_size(type) != 0) return repeated == 1 && size == packet_size(type) ? size : 0;
  const bool single = (type == kInfoAnswer && size == 20) || (type == kHealthAnswer && size == 3) ||
                      (type == kRateAnswer && size == 4) || (type == kMotorAnswer && size == 4) ||
                      (type == kConfAnswer && size >= 4 && size <= 256);
  return repeated == 0 && single ? size : 0;
}

class RplidarDecoder final : public StreamDecoder {
 public:
  RplidarDecoder(const SensorModel& model, double bytes_per_s)
      : StreamDecoder(model, bytes_per_s), sample_s_(1.0 / model.samples_hz) {}

 private:
  Cut find(Bytes pending) override {
    if (pending[0] == 0xA5) {
      // Nodes never begin so and capsules hardly: seven bytes that are a whole descriptor are one.
      if (pending.size() < 2) return Cut::wait();
      if (pending[1] == 0x5A) {
        if (pending.size() < kDescriptor) return Cut::wait();
        if (const std::size_t size = described(pending)) {
          const std::size_t whole = kDescriptor + (packet_size(pending[6]) == 0 ? size : 0);
          return pending.size() < whole ? Cut::wait() : Cut::packet(whole);
        }
      }
    }
    if (pending[0] == 'R') {
      const std::size_t size = std::min(pending.size(), kBannerText.size());
      if (std::equal(pending.begin(), pending.begin() + static_cast<std::ptrdiff_t>(size), kBannerText.begin()))
        return size < kBannerText.size() ? Cut::wait() : Cut::packet(size);
    }
    if (mode_ == 0) return Cut::skip();
    if (mode_ == kNodes) return find_node(pending);
    const Cut cut = find_capsule(pending);
    // One wrong capsule in 256 passes its check where bytes were lost or came in between: one that no other follows at
    // once does not count.
    if (cut.what != Cut::What::kPacket && cut.what != Cut::What::kWait) before_.clear();
    return cut;
  }

  Cut find_node(Bytes pending) {
    std::size_t right = 0;
    while (right < kRun && pending.size() >= 5 * (right + 1) && node_is_right(pending.subspan(5 * right, 5))) ++right;
    if (right == kRun) {
      locked_ = true;
      return Cut::packet(5);
    }
    if (pending.size() < 5 * (right + 1)) return Cut::wait();
    if (right > 0 && locked_) return Cut::skip(5);
    const Cut cut = locked_ ? Cut::bad() : Cut::skip();
    locked_ = false;
    return cut;
  }

  Cut find_capsule(Bytes pending) const {
    const std::size_t size = packet_size(mode_);
    if (mode_ == kHqNodes) {
      if (pending[0] != 0xA5) return Cut::skip();
      if (pending.size() < size) return Cut::wait();
      return crc32_padded(pending.first(size - 4), 3) == u32_at(pending, size - 4) ? Cut::packet(size) : Cut::bad();
    }
    if (pending[0] >> 4 != 0xA) return Cut::skip();
    if (pending.size() < 2) return Cut::wait();
    if (pending[1] >> 4 != 0x5) return Cut::skip();
    if (pending.size() < size) return Cut::wait();
    return capsule_is_right(pending.first(size)) ? Cut::packet(size) : Cut::bad();
  }

  bool take(Bytes packet, const PacketTime& time, Decoded& out) override {
    if (packet[0] == 'R') {
      begin(0);
      out.replies.push_back({Reply::kBanner, {}});
      return true;
    }
    if (packet[0] == 0xA5 && packet.size() >= kDescriptor && packet[1] == 0x5A && described(packet) != 0) {
      take_answer(packet, out);
      return true;
    }
    if (mode_ == kNodes) return take_node(packet, time, out);
    if (mode_ == kHqNodes) return take_hq(packet, time, out);
    return take_capsule(packet, time, out);
  }

  void begin(int mode) {
    mode_ = mode;
    locked_ = false;
    before_.clear();
    expected_on_ = 0.0;
    odd_ = 0;
    restarts_ = true;
    clock_.reset();
  }

  void take_answer(Bytes packet, Decoded& out) {
    const int type = packet[6];
    const Bytes body = packet.subspan(kDescriptor);
    begin(packet_size(type) != 0 ? type : 0);
    const auto usual = [this](double seconds) {
      if (seconds >= kLeastSample_s && seconds <= kMostSample_s) stated_sample_s_ = seconds;
    };
    if (type == kConfAnswer && body.size() >= 8 && u32_at(body, 0) == kModeMicroseconds)
      usual(u32_at(body, 4) / 256.0 * 1e-6);
    if (type == kRateAnswer) {
      node_sample_s_ = std::clamp(u16_at(body, 0) * 1e-6, kLeastSample_s, kMostSample_s);
      usual(u16_at(body, 2) * 1e-6);
    }
    if (stated_sample_s_ > 0.0) sample_s_ = stated_sample_s_;
    out.replies.push_back({type, {body.begin(), body.end()}});
  }

  /// What is set in a beam alike in all forms.
  void put(Beam& beam, double turned, std::uint32_t distance_q2, float quality, Stamp stamp, Decoded& out) {
    beam.angle = clockwise(turned);
    put_range(beam, 0.25e-3 * distance_q2);
    beam.intensity = quality;
    beam.stamp = stamp;
    if (restarts_ && beam.mark != TurnMark::kStarts) beam.mark = TurnMark::kRestarts;
    restarts_ = false;
    out.beams.push_back(beam);
  }

  bool take_node(Bytes node, const PacketTime& time, Decoded& out) {
    const Stamp sent = clock_.at(time.first, node_sample_s_);
    Beam beam;
    if (node[0] & 1) beam.mark = TurnMark::kStarts;
    put(beam, deg_to_rad((u16_at(node, 1) >> 1) / 64.0), u16_at(node, 3), static_cast<float>(node[0] >> 2),
        sent - stamp_from_seconds(0.5 * node_sample_s_), out);
    return true;
  }

  bool take_hq(Bytes packet, const PacketTime& time, Decoded& out) {
    constexpr std::size_t kHqSamples = 96;
    const Stamp sent = clock_.at(time.first, kHqSamples * sample_s_);
    for (std::size_t k = 0; k < kHqSamples; ++k) {
      const std::size_t at = 9 + 8 * k;
      Beam beam;
      if (packet[at + 7] & 1) beam.mark = TurnMark::kStarts;
      const std::uint32_t q2 = u32_at(packet, at + 2);
      put(beam, u16_at(packet, at) * (kTwoPi / 65536.0), q2 < 1U << 20 ? q2 : 0, packet[at + 6],
          sent - stamp_from_seconds((kHqSamples - 0.5 - static_cast<double>(k)) * sample_s_), out);
    }
    return true;
  }

  /// Only the next capsule tells how far the head turned during one.
  bool take_capsule(Bytes packet, const PacketTime& time, Decoded& out) {
    const std::size_t samples = capsule_samples(mode_);
    const std::uint16_t word = u16_at(packet, mode_ == kUltraDense ? 8 : 2);
    const double start = deg_to_rad((word & 0x7FFF) / 64.0);
    if (start >= 2.0 * kTwoPi) return false;
    if (word & 0x8000) {  // begins anew: the one before had no end
      before_.clear();
      restarts_ = true;
    }
    const double on = turned_on(start_, start);
    const double capsule_s = static_cast<double>(samples) * sample_s_;
    const double capsules = capsules_since(on, stamp_to_seconds(time.first - observed_) / capsule_s);
    observed_ = time.first;
    const bool whole = !before_.empty() && follows(on);
    const Stamp sent = clock_.at(time.first, capsules * capsule_s);
    if (whole) {
      read_capsule(mode_, before_, packet, samples_);
      for (std::size_t k = 0; k < samples; ++k) {
        const double turned = start_ + on * static_cast<double>(k) / static_cast<double>(samples);
        Beam beam;
        beam.sweep = std::fmod(turned, kTwoPi);
        if (beam.sweep < last_sweep_) beam.mark = TurnMark::kStarts;
        last_sweep_ = beam.sweep;
        const Stamp stamp = sent_ - stamp_from_seconds((static_cast<double>(samples - k) - 0.5) * sample_s_);
        put(beam, turned + samples_[k].shift, samples_[k].distance_q2, samples_[k].quality, stamp, out);
      }
    }
    before_.assign(packet.begin(), packet.end());
    start_ = start;
    sent_ = sent;
    return true;
  }

  /// How many capsules on from the last right one this one is, by the angle that the head turned; by the time that
  /// passed only how many whole turns that was. A lost capsule is no late one: its time has passed.
  double capsules_since(double on, double seen) const {
    if (expected_on_ <= 0.0) return 1.0;
    const double turn = kTwoPi / expected_on_, by_angle = on / expected_on_;
    return std::max(1.0, std::round(by_angle + turn * std::max(0.0, std::round((seen - by_angle) / turn))));
  }

  /// Whether the next capsule, `on` further, is the one that followed. There is no counter: where one is lost, that
  /// before it would be stretched over the angle of both. What is lost never makes the way shorter.
  bool follows(double on) {
    constexpr int kOddOnes = 8;  // so many in a row: the speed is another now
    if (on <= 0.0) return false;
    if (expected_on_ <= 0.0) {
      expected_on_ = on;
      return false;
    }
    const double ratio = on / expected_on_;
    if (ratio < 1.5) {
      expected_on_ = ratio < 0.6 ? on : expected_on_ + 0.2 * (on - expected_on_);
      odd_ = 0;
      return true;
    }
    if (++odd_ >= kOddOnes) {
      expected_on_ = 0.0;
      odd_ = 0;
      clock_.reset();
    }
    return false;
  }

  int mode_ = 0;         ///< type of the answer that goes on without end; 0: none
  bool locked_ = false;  ///< nodes: the one before was right
  bool restarts_ = false;
  double sample_s_, stated_sample_s_ = 0.0;
  double node_sample_s_ = 1.0 / 1970.0;  ///< standard scans of the A1, where it does not say
  std::vector<std::uint8_t> before_;     ///< the last capsule, and where and when it began
  double start_ = 0.0;
  Stamp sent_ = 0, observed_ = 0;
  double expected_on_ = 0.0, last_sweep_ = 0.0;
  int odd_ = 0;
  std::vector<CapsuleSample> samples_;
};

}  // namespace

std::unique_ptr<Decoder> make_rplidar_decoder(const SensorModel& model, double bytes_per_s) {
  return std::make_unique<RplidarDecoder>(model, bytes_per_s);
}

}  // namespace phasescan::live
