// SICK's telegrams as text (CoLa A): LMDscandata of LMS1xx, LMS5xx, TiM, MRS; a telegram between STX and ETX or on a
// line. Source: SICK, "Telegrams for configuring and operating LMS1xx, LMS5xx, TiM2xx, TiM5xx, TiM7xx, MRS1000,
// MRS6000".
//
//   sRA LMDscandata version device serial status(2) telegrams scans start_us sent_us inputs(2) outputs(2) layer
//   frequency rate encoders [position speed].. channels16 {name scale offset start step count values..} ..
//   channels8 {..} position name comment time [year month day hour minute second us] ..
//
// Numbers are hexadecimal; a scale is the bits of a float, the start angle 1/10000 deg, 90 deg is ahead, ranges are mm.
#include <bit>
#include <charconv>
#include <cmath>

#include "io/log_format.hpp"
#include "io/text_log.hpp"
#include "io/text_numbers.hpp"
#include "phasescan/core/pose2.hpp"
#include "phasescan/io/scan_json.hpp"

namespace phasescan {
namespace {

struct BadTelegram {
  std::string reason;
};

/// The words of a telegram, taken one by one.
class Words {
 public:
  explicit Words(const std::vector<std::string_view>& words) : words_(words) {}

  std::size_t left() const { return words_.size() - at_; }
  std::string_view word() {
    if (left() == 0) throw BadTelegram{"the telegram ends too early"};
    return words_[at_++];
  }
  /// Hexadecimal, or decimal with a sign in front ("+10").
  std::uint32_t number(const char* what) {
    std::string_view text = word();
    const bool decimal = text.starts_with('+') || text.starts_with('-');
    const bool negative = text.starts_with('-');
    if (decimal) text.remove_prefix(1);
    std::uint32_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value, decimal ? 10 : 16);
    if (error != std::errc{} || end != text.data() + text.size())
      throw BadTelegram{std::string(what) + " is " + quote_text(text) + "; expected a number"};
    return negative ? 0U - value : value;
  }
  void skip(std::size_t count) {
    if (left() < count) throw BadTelegram{"the telegram ends too early"};
    at_ += count;
  }

 private:
  const std::vector<std::string_view>& words_;
  std::size_t at_ = 0;
};

struct SickChannel {
  std::string name;
  double start_deg = 0.0, step_deg = 0.0;
  std::vector<float> values;
};

SickChannel read_channel(Words& words) {
  SickChannel channel;
  channel.name = words.word();
  const auto scale = std::bit_cast<float>(words.number("the scale"));
  const auto offset = std::bit_cast<float>(words.number("the offset"));
  channel.start_deg = static_cast<std::int32_t>(words.number("the start angle")) / 10000.0;
  channel.step_deg = static_cast<std::int16_t>(words.number("the angular step")) / 10000.0;
  const std::uint32_t count = words.number("the count of values");
  if (!std::isfinite(scale) || !std::isfinite(offset)) throw BadTelegram{"a scale that is not finite"};
  if (count > kMaxBeams || count > words.left()) throw BadTelegram{"the telegram ends too early"};
  channel.values.reserve(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t raw = words.number("a value");
    channel.values.push_back(raw == 0 ? 0.0F : static_cast<float>(raw) * scale + offset);
  }
  return channel;
}

class SickReader final : public TextLogReader {
 public:
  explicit SickReader(LogInput& input) : TextLogReader(input) {}

  std::string format() const override { return "SICK telegrams (CoLa A)"; }
  std::vector<LogRemark> remarks() const override {
    if (other_layers_ == 0) return {};
    return {{"tilted laser", std::to_string(other_layers_) + " scans of layers out of the plane are left out"}};
  }

  std::optional<LogEntry> next() override {
    while (next_telegram()) {
      split_fields(telegram_, ' ', words_);
      if (words_.size() < 2 || words_[1] != "LMDscandata") continue;  // answers to other questions
      try {
        if (auto entry = read_telegram()) return entry;
      } catch (const BadTelegram& bad) {
        damage_here("bad telegram", bad.reason);
      }
    }
    return std::nullopt;
  }

 private:
  /// The next telegram of the text: several may stand on a line, between STX and ETX.
  bool next_telegram() {
    constexpr char kStx = '\x02', kEtx = '\x03';
    while (rest_.empty()) {
      if (!next_line(line_)) return false;
      rest_ = line_;
      while (!rest_.empty() && (rest_.front() == kStx || rest_.front() == kEtx)) rest_.remove_prefix(1);
    }
    const std::size_t end = std::min(rest_.find_first_of("\x02\x03"), rest_.size());
    telegram_ = rest_.substr(0, end);
    rest_.remove_prefix(end);
    while (!rest_.empty() && (rest_.front() == kStx || rest_.front() == kEtx || rest_.front() == ' '))
      rest_.remove_prefix(1);
    return true;
  }

  std::optional<LogEntry> read_telegram() {
    Words words(words_);
    words.skip(2 + 7);
    const std::uint32_t started_us = words.number("the time since start");
    words.skip(1 + 2 + 2);
    const std::uint32_t layer = words.number("the layer");
    words.skip(2);
    words.skip(2 * std::size_t{words.number("the count of encoders")});
    LogEntry entry;
    std::vector<float> intensities;
    bool any = false;
    for (int bits : {16, 8}) {
      if (bits == 8 && words.left() == 0) break;
      for (std::uint32_t n = words.number("the count of channels"); n > 0; --n) {
        SickChannel channel = read_channel(words);
        if (channel.name.starts_with("DIST") && !any) {
          entry.scan = scan_of(channel);
          any = true;
        } else if (channel.name.starts_with("RSSI") && intensities.empty()) {
          intensities = std::move(channel.values);
        }
      }
    }
    if (!any) throw BadTelegram{"no channel DIST1; expected ranges"};
    if (layer != 0) {
      ++other_layers_;
      return std::nullopt;
    }
    if (intensities.size() == entry.scan.size()) entry.scan.intensities = std::move(intensities);
    entry.scan.stamp = stamp_of(started_us);
    entry.laser = "sick";
    entry.line = line_number();
    return entry;
  }

  static Scan scan_of(const SickChannel& channel) {
    std::vector<float> ranges = channel.values;
    for (float& range : ranges) range *= 1e-3F;
    try {
      return make_scan(ranges, {deg_to_rad(channel.start_deg - 90.0), deg_to_rad(channel.step_deg), 0.0, 0.0});
    } catch (const std::invalid_argument& error) {
      throw BadTelegram{error.what()};
    }
  }

  /// The sensor's microseconds since it was switched on, of 32 bits.
  Stamp stamp_of(std::uint32_t started_us) {
    if (before_us_ && started_us<*before_us_&& * before_us_ - started_us> 0x80000000U) wraps_us_ += Stamp{1} << 32;
    before_us_ = started_us;
    return (wraps_us_ + Stamp{started_us}) * 1000;
  }

  std::string line_;
  std::string_view rest_, telegram_;
  std::vector<std::string_view> words_;
  std::optional<std::uint32_t> before_us_;
  Stamp wraps_us_ = 0;
  std::size_t other_layers_ = 0;
};

bool is_sick(const LogInput& input) {
  const std::string_view prefix = input.prefix();
  const std::size_t at = prefix.substr(0, 4096).find("LMDscandata ");
  return at != std::string_view::npos && at >= 4 &&
         (prefix.substr(at - 4, 4) == "sRA " || prefix.substr(at - 4, 4) == "sSN ");
}

}  // namespace

LogFormat sick_format() {
  return {"SICK CoLa A", is_sick, [](LogInput& input, const LogOptions&) -> std::unique_ptr<LogReader> {
            return std::make_unique<SickReader>(input);
          }};
}

}  // namespace phasescan
