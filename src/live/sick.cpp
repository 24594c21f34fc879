// SICK laser scanners over TCP: telegrams of text between STX and ETX (CoLa A). The line has a check of its own.
// Source: io/sick_telegram.hpp.
#include "live/sick.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include "io/sick_telegram.hpp"
#include "live/checks.hpp"
#include "live/stream_decoder.hpp"

namespace phasescan::live {
namespace {

constexpr std::size_t kMostTelegram = 60000;  // 1,141 values of 4 digits, ranges and strengths, are 12 kB
constexpr std::size_t kMostWords = 30000;

class SickDecoder final : public StreamDecoder {
 public:
  using StreamDecoder::StreamDecoder;

 private:
  Cut find(Bytes pending) override {
    if (pending[0] != sick::kStx) return Cut::skip();
    if (pending.size() < 2) return Cut::wait();
    if (pending[1] == sick::kStx) return find_binary(pending);
    for (std::size_t at = 1; at < pending.size(); ++at) {
      if (pending[at] == sick::kEtx) return Cut::packet(at + 1);
      if (pending[at] == sick::kStx || at > kMostTelegram) return Cut::skip(at);
    }
    return Cut::wait();
  }

  /// 02 02 02 02, u32 length (big endian), as many bytes, their XOR.
  static Cut find_binary(Bytes pending) {
    if (pending.size() < 8) return Cut::wait();
    const std::size_t size = static_cast<std::size_t>(u16_be_at(pending, 4)) << 16 | u16_be_at(pending, 6);
    if (u16_at(pending, 2) != 0x0202 || size > kMostTelegram) return Cut::skip();
    if (pending.size() < 9 + size) return Cut::wait();
    return xor_of(pending.subspan(8, size)) == pending[8 + size] ? Cut::packet(9 + size) : Cut::bad();
  }

  bool take(Bytes packet, const PacketTime& time, Decoded& out) override {
    if (packet[1] == sick::kStx) {
      out.replies.push_back({sick::kBinary, {packet.begin() + 8, packet.end() - 1}});
      return true;
    }
    const std::string_view text(reinterpret_cast<const char*>(packet.data()) + 1, packet.size() - 2);
    words_.clear();
    for (std::size_t at = 0; at <= text.size() && words_.size() < kMostWords;) {
      const std::size_t end = std::min(text.find(' ', at), text.size());
      words_.push_back(text.substr(at, end - at));
      at = end + 1;
    }
    const bool scan = words_.size() > 2 && words_[1] == "LMDscandata" && (words_[0] == "sSN" || words_[0] == "sRA");
    if (!scan) {
      out.replies.push_back({sick::kTelegram, {text.begin(), text.end()}});
      return true;
    }
    try {
      blank_broken_values();
      const SickTelegram telegram = read_sick_telegram(words_, model().zero_deg);
      if (!usual()) return false;
      if (telegram.layer == 0) put(telegram, time, out);
      return true;
    } catch (const BadTelegram&) {
      return false;
    }
  }

  /// A range that is no number is one wrong byte: it costs its beam and not the scan.
  void blank_broken_values() {
    broken_.clear();
    const auto ranges = first_ranges();
    if (words_.end() - ranges <= static_cast<std::ptrdiff_t>(kHead)) return;
    std::uint32_t count = 0;
    if (!read_hex(ranges[kHead - 1], count)) return;
    const auto values = ranges + kHead;
    const std::size_t n = std::min<std::size_t>(count, static_cast<std::size_t>(words_.end() - values));
    for (std::size_t i = 0; i < n; ++i) {
      std::uint32_t ignored = 0;
      std::string_view& word = values[static_cast<std::ptrdiff_t>(i)];
      if (read_hex(word, ignored) || word.starts_with('+') || word.starts_with('-')) continue;
      broken_.push_back(i);
      word = "0";
    }
  }

  static bool read_hex(std::string_view text, std::uint32_t& value) {
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value, 16);
    return error == std::errc{} && end == text.data() + text.size();
  }

  std::vector<std::string_view>::iterator first_ranges() {
    return std::find_if(words_.begin(), words_.end(), [](std::string_view word) { return word.starts_with("DIST"); });
  }

  /// The text has no check of its own. A wrong byte in a value is a wrong value, but one that makes two values of one,
  /// or is in what says where all beams lie, would spoil the whole scan: a sensor sends the same number of words with
  /// the same scale and angles each time. Others count once they come twice.
  bool usual() {
    std::string form = std::to_string(words_.size());
    const auto ranges = first_ranges();
    for (std::size_t i = 0; i < kHead && ranges + static_cast<std::ptrdiff_t>(i) != words_.end(); ++i)
      form.append(" ").append(ranges[static_cast<std::ptrdiff_t>(i)]);
    if (form_.empty() || form == form_ || form == other_form_) {
      form_ = std::move(form);
      return true;
    }
    other_form_ = std::move(form);
    return false;
  }

  /// A wrong byte may stand in the speed: another one counts once it comes twice.
  void take_speed(double turns_hz) {
    if (turns_hz_ <= 0.0 || turns_hz == other_hz_) turns_hz_ = turns_hz;
    other_hz_ = turns_hz;
  }

  /// Since the telegram before, by the sensor's clock. Turns begin a whole number of turns apart: a time that says
  /// something else has a wrong byte, and arrivals tell how many turns it was.
  double elapsed_since_last(std::uint32_t started_us, Stamp arrived) {
    constexpr double kJitter = 0.2, kRate = 0.02, kMostTurns = 200.0;
    constexpr int kOddOnes = 3;  // so many in a row: the sensor's clock was set anew
    const double said = 1e-6 * (started_us - last_us_), turns = std::round(said * turns_hz_);
    const bool whole = turns_hz_ <= 0.0 || (turns >= 1.0 && turns <= kMostTurns &&
                                            std::abs(said * turns_hz_ - turns) < kJitter + kRate * turns);
    odd_ = whole ? 0 : odd_ + 1;
    if (whole || odd_ >= kOddOnes) {
      last_us_ = started_us;
      return whole ? said : -1.0;
    }
    const double seen = std::max(1.0, std::round(stamp_to_seconds(arrived - last_arrived_) * turns_hz_)) / turns_hz_;
    last_us_ += static_cast<std::uint32_t>(1e6 * seen);
    return seen;
  }

  void put(const SickTelegram& telegram, const PacketTime& time, Decoded& out) {
    const Scan& scan = telegram.scan;
    take_speed(telegram.turns_hz);
    const double step_s = turns_hz_ > 0.0 ? std::abs(scan.geometry.angle_increment) / kTwoPi / turns_hz_ : 0.0;
    const double elapsed = known_ ? elapsed_since_last(telegram.started_us, time.first) : -1.0;
    if (!known_) last_us_ = telegram.started_us;
    known_ = true;
    last_arrived_ = time.first;
    const Stamp end = clock_.at(time.first, elapsed);
    for (std::size_t i = 0; i < scan.size(); ++i) {
      Beam beam;
      beam.angle = scan.angle(i);
      beam.sweep = wrap_positive(static_cast<double>(i) * std::abs(scan.geometry.angle_increment));
      put_range(beam, scan.is_hit(i) ? scan.ranges[i] : 0.0);
      if (std::binary_search(broken_.begin(), broken_.end(), i)) beam.state = BeamState::kInvalid;
      if (!scan.intensities.empty()) beam.intensity = scan.intensities[i];
      beam.stamp = end - stamp_from_seconds((static_cast<double>(scan.size() - i) - 0.5) * step_s);
      if (i == 0) beam.mark = TurnMark::kStarts;
      beam.ends_turn = i + 1 == scan.size();
      out.beams.push_back(beam);
    }
  }

  static constexpr std::size_t kHead = 6;  // DIST1, scale, offset, start, step, count
  std::vector<std::string_view> words_;
  std::vector<std::size_t> broken_;  // ranges that are no numbers
  std::string form_, other_form_;    // of the telegrams taken, and of the last that was not
  bool known_ = false;
  int odd_ = 0;
  std::uint32_t last_us_ = 0;
  Stamp last_arrived_ = 0;
  double turns_hz_ = 0.0, other_hz_ = 0.0;
};

}  // namespace

std::unique_ptr<Decoder> make_sick_decoder(const SensorModel& model, double bytes_per_s) {
  return std::make_unique<SickDecoder>(model, bytes_per_s);
}

}  // namespace phasescan::live
