#include "io/sick_telegram.hpp"

#include <bit>
#include <charconv>
#include <cmath>
#include <stdexcept>

#include "io/file.hpp"
#include "phasescan/core/pose2.hpp"
#include "phasescan/io/scan_json.hpp"

namespace phasescan {
namespace {

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

Scan scan_of(const SickChannel& channel, double zero_deg) {
  std::vector<float> ranges = channel.values;
  for (float& range : ranges) range *= 1e-3F;
  try {
    return make_scan(ranges, {deg_to_rad(channel.start_deg + zero_deg), deg_to_rad(channel.step_deg), 0.0, 0.0});
  } catch (const std::invalid_argument& error) {
    throw BadTelegram{error.what()};
  }
}

}  // namespace

SickTelegram read_sick_telegram(const std::vector<std::string_view>& all_words, double zero_deg) {
  Words words(all_words);
  SickTelegram telegram;
  words.skip(2 + 7);
  telegram.started_us = words.number("the time since start");
  words.skip(1 + 2 + 2);
  telegram.layer = words.number("the layer");
  telegram.turns_hz = words.number("the scan frequency") / 100.0;
  words.skip(1);
  words.skip(2 * std::size_t{words.number("the count of encoders")});
  std::vector<float> intensities;
  bool any = false;
  for (int bits : {16, 8}) {
    if (bits == 8 && words.left() == 0) break;
    for (std::uint32_t n = words.number("the count of channels"); n > 0; --n) {
      SickChannel channel = read_channel(words);
      if (channel.name.starts_with("DIST") && !any) {
        telegram.scan = scan_of(channel, zero_deg);
        any = true;
      } else if (channel.name.starts_with("RSSI") && intensities.empty()) {
        intensities = std::move(channel.values);
      }
    }
  }
  if (!any) throw BadTelegram{"no channel DIST1; expected ranges"};
  if (intensities.size() == telegram.scan.size()) telegram.scan.intensities = std::move(intensities);
  return telegram;
}

}  // namespace phasescan
