// Hokuyo sensors that speak SCIP 2.0, over a serial line, USB or TCP.
// Source: Hokuyo, "Communication protocol specification for SCIP 2.0 standard".
//
// A block is a line that repeats the command, a line with a status of two characters and its sum, lines of data, and an
// empty line. Ranges lie in lines of 64 characters across their ends.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <string>
#include <string_view>

#include "live/hokuyo.hpp"
#include "live/stream_decoder.hpp"

namespace phasescan::live {
namespace {

// Of text: echoes and parameters. Data lines have 65, two whose end is lost between them 130.
constexpr std::size_t kLongestLine = 132;
constexpr std::size_t kMostMissing = 2;  // bytes of a line; with more of them it could be another
constexpr char kHole = '\0';
constexpr std::size_t kMostBlock = 32768;  // 1,440 steps of range and intensity are 9 kB

std::string_view text_of(Bytes bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::optional<int> whole(std::string_view text) {
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return {};
  return value;
}

class HokuyoDecoder final : public StreamDecoder {
 public:
  using StreamDecoder::StreamDecoder;

  double range_min() const override { return range_min_; }
  double range_max() const override { return range_max_; }

 private:
  Cut find(Bytes pending) override {
    if (pending[0] < 'A' || pending[0] > 'Z') return Cut::skip();  // a command's echo begins with a letter
    std::size_t line = 0;
    for (std::size_t at = 0; at < pending.size(); ++at) {
      if (pending[at] != '\n') {
        if (at - line > kLongestLine) return Cut::skip(at);  // no line of the protocol is so long
        continue;
      }
      if (at == line) return Cut::packet(at + 1);
      line = at + 1;
    }
    return pending.size() > kMostBlock ? Cut::skip(pending.size()) : Cut::wait();
  }

  bool take(Bytes packet, const PacketTime& time, Decoded& out) override {
    std::string_view rest = text_of(packet);
    const std::string_view echo = next_line(rest), status = next_line(rest);
    if (echo.size() < 2 || status.size() != 3 || scip::line_sum(status.substr(0, 2)) != status[2]) return false;
    const std::string_view command = echo.substr(0, 2);
    if (command == "PP" && !take_parameters(rest)) return false;
    const bool continuous = command == "MD" || command == "MS" || command == "ME";
    const bool once = command == "GD" || command == "GS" || command == "GE";
    const bool data = (continuous && status.starts_with("99")) || (once && status.starts_with("00"));
    if (data) return take_scan(echo, rest, time, out);
    out.replies.push_back({scip::reply_type(echo[0], echo[1]), {packet.begin(), packet.end()}});
    return true;
  }

  static std::string_view next_line(std::string_view& rest) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    const std::string_view line = rest.substr(0, end);
    rest.remove_prefix(std::min(end + 1, rest.size()));
    return line;
  }

  /// "DMIN:20;4": the sum is of what stands before the semicolon.
  bool take_parameters(std::string_view rest) {
    while (!rest.empty()) {
      const std::string_view line = next_line(rest);
      if (line.empty()) break;
      const std::size_t colon = line.find(':'), end = line.rfind(';');
      if (colon == std::string_view::npos || end == std::string_view::npos || end < colon || end + 2 != line.size())
        return false;
      if (scip::line_sum(line.substr(0, end)) != line[end + 1]) return false;
      const std::string_view name = line.substr(0, colon);
      const auto value = whole(line.substr(colon + 1, end - colon - 1));
      if (!value || *value < 0) continue;  // MODL: text
      if (name == "DMIN") range_min_ = 1e-3 * *value;
      if (name == "DMAX") range_max_ = 1e-3 * *value;
      if (name == "ARES") steps_ = *value;
      if (name == "AFRT") front_ = *value;
      if (name == "SCAN" && *value > 0) turn_s_ = 60.0 / *value;
    }
    return true;
  }

  /// The data of a block: a stamp, and what its lines hold joined. Each line has a sum of its own: one that is wrong
  /// leaves a hole, and so does one that lacks bytes or its end. False where the stamp is wrong, where lines have other
  /// lengths than the ranges asked for make them, or where most are wrong.
  bool join(std::string_view rest, std::size_t characters, std::uint32_t& ms) {
    data_.clear();
    const auto is_right = [](std::string_view line) {
      const std::string_view text = line.substr(0, line.size() - 1);
      const bool plain = std::all_of(text.begin(), text.end(), [](char c) { return c >= 0x30 && c <= 0x6F; });
      return plain && scip::line_sum(text) == line.back();
    };
    const std::string_view stamp = next_line(rest);
    if (stamp.size() != 5 || !is_right(stamp)) return false;
    ms = scip::number(stamp.substr(0, 4));
    std::size_t lost = 0;
    while (data_.size() < characters) {
      const std::string_view line = next_line(rest);
      std::size_t size = std::min(scip::kLine, characters - data_.size());
      if (line.size() == size + 1 && is_right(line)) {
        data_.append(line.substr(0, size));
        continue;
      }
      const std::size_t second = std::min(scip::kLine, characters - data_.size() - size);
      const auto lacks_few = [&](std::size_t whole) {
        return line.size() <= whole && line.size() + kMostMissing >= whole;
      };
      if (!lacks_few(size + 1)) {
        if (second == 0 || !lacks_few(size + second + 2)) return false;
        size += second;
      }
      lost += size;
      data_.append(size, kHole);
    }
    return next_line(rest).empty() && 2 * lost <= characters;
  }

  bool take_scan(std::string_view echo, std::string_view rest, const PacketTime& time, Decoded& out) {
    const auto from = echo.size() >= 12 ? whole(echo.substr(2, 4)) : std::nullopt;
    const auto to = from ? whole(echo.substr(6, 4)) : std::nullopt;
    const auto cluster = to ? whole(echo.substr(10, 2)) : std::nullopt;
    std::uint32_t ms = 0;
    if (!cluster || *from < 0 || *to < *from) return false;
    const int step = std::max(1, *cluster);
    const bool strengths = echo[1] == 'E';
    const std::size_t width = echo[1] == 'S' ? 2 : 3, stride = strengths ? 2 * width : width;
    const auto expected = static_cast<std::size_t>((*to - *from) / step + 1);
    if (expected * stride > kMostBlock || !join(rest, expected * stride, ms)) return false;
    if (steps_ <= 0) return true;  // the answer to PP is still to come: no direction is known
    const double step_s = turn_s_ / steps_;
    const double elapsed = known_ ? 1e-3 * ((ms - last_ms_) & 0xFFFFFF) : -1.0;
    known_ = true;
    last_ms_ = ms;
    const Stamp end = clock_.at(time.first, elapsed);
    const std::size_t before = out.beams.size();
    for (std::size_t k = 0; k < expected; ++k) {
      // Those in holes are left out: who makes turns of beams sees where they are missing.
      if (std::string_view(data_).substr(k * stride, stride).find(kHole) != std::string_view::npos) continue;
      const double at = *from + step * static_cast<double>(k);
      Beam beam;
      beam.sweep = std::fmod(at * kTwoPi / steps_, kTwoPi);
      beam.angle = counter_clockwise((at - front_) * kTwoPi / steps_);
      const std::uint32_t mm = scip::number(std::string_view(data_).substr(k * stride, width));
      put_range(beam, 1e-3 * mm < range_min_ ? 0.0 : 1e-3 * mm);  // below the least range: why there is none
      if (strengths)
        beam.intensity = static_cast<float>(scip::number(std::string_view(data_).substr(k * stride + width, width)));
      beam.stamp = end - stamp_from_seconds((*to + 0.5 - at) * step_s);
      out.beams.push_back(beam);
    }
    if (out.beams.size() > before) {
      out.beams[before].mark = TurnMark::kStarts;
      out.beams.back().ends_turn = true;
    }
    return true;
  }

  double range_min_ = 0.02, range_max_ = 0.0, turn_s_ = 0.1;
  int steps_ = 0, front_ = 0;
  bool known_ = false;
  std::uint32_t last_ms_ = 0;
  std::string data_;
};

}  // namespace

std::unique_ptr<Decoder> make_hokuyo_decoder(const SensorModel& model, double bytes_per_s) {
  return std::make_unique<HokuyoDecoder>(model, bytes_per_s);
}

}  // namespace phasescan::live
