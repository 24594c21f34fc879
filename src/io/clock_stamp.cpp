#include "io/clock_stamp.hpp"

#include <chrono>

#include "io/number.hpp"

namespace phasescan {
namespace {

constexpr Stamp kSecond = 1'000'000'000;
constexpr Stamp kDay = 86'400 * kSecond;

/// Takes parts off the front of a text; every part may fail.
class Parts {
 public:
  explicit Parts(std::string_view text) : text_(text) {}

  bool done() const { return text_.empty(); }
  char front() const { return text_.empty() ? '\0' : text_.front(); }
  bool take(char c) {
    if (front() != c) return false;
    text_.remove_prefix(1);
    return true;
  }
  /// `digits` digits, at most `most`.
  std::optional<int> number(std::size_t digits, int most) {
    if (text_.size() < digits) return std::nullopt;
    int value = 0;
    for (std::size_t i = 0; i < digits; ++i) {
      if (text_[i] < '0' || text_[i] > '9') return std::nullopt;
      value = 10 * value + (text_[i] - '0');
    }
    text_.remove_prefix(digits);
    return value <= most ? std::optional(value) : std::nullopt;
  }
  /// One to nine digits behind a decimal point [ns]; further ones are cut.
  std::optional<Stamp> decimals() {
    Stamp value = 0, unit = kSecond / 10;
    std::size_t count = 0;
    for (; front() >= '0' && front() <= '9'; text_.remove_prefix(1), ++count, unit /= 10)
      value += unit * (front() - '0');
    return count > 0 ? std::optional(value) : std::nullopt;
  }

 private:
  std::string_view text_;
};

std::optional<Stamp> take_clock(Parts& parts) {
  const auto hours = parts.number(2, 23);
  if (!hours || !parts.take(':')) return std::nullopt;
  const auto minutes = parts.number(2, 59);
  if (!minutes || !parts.take(':')) return std::nullopt;
  const auto seconds = parts.number(2, 60);
  if (!seconds) return std::nullopt;
  Stamp stamp = (Stamp{*hours} * 3600 + Stamp{*minutes} * 60 + Stamp{*seconds}) * kSecond;
  if (parts.take('.') || parts.take(',')) {
    const auto rest = parts.decimals();
    if (!rest) return std::nullopt;
    stamp += *rest;
  }
  return stamp;
}

std::optional<Stamp> take_date(Parts& parts) {
  namespace chrono = std::chrono;
  const auto year = parts.number(4, 2115);
  const char separator = parts.front();
  if (!year || *year < 1825 || (separator != '-' && separator != '/') || !parts.take(separator)) return std::nullopt;
  const auto month = parts.number(2, 12);
  if (!month || !parts.take(separator)) return std::nullopt;
  const auto day = parts.number(2, 31);
  if (!day) return std::nullopt;
  const chrono::year_month_day date{chrono::year{*year}, chrono::month{static_cast<unsigned>(*month)},
                                    chrono::day{static_cast<unsigned>(*day)}};
  if (!date.ok()) return std::nullopt;
  return Stamp{chrono::sys_days{date}.time_since_epoch().count()} * kDay;
}

/// Z, +02:00, -0330 or nothing: what is to be taken off.
std::optional<Stamp> take_zone(Parts& parts) {
  if (parts.done() || (parts.take('Z') && parts.done())) return 0;
  const bool east = parts.take('+');
  if (!east && !parts.take('-')) return std::nullopt;
  const auto hours = parts.number(2, 14);
  parts.take(':');
  const auto minutes = parts.number(2, 59);
  if (!hours || !minutes || !parts.done()) return std::nullopt;
  const Stamp offset = (Stamp{*hours} * 60 + *minutes) * 60 * kSecond;
  return east ? offset : -offset;
}

}  // namespace

std::optional<Stamp> parse_clock_stamp(std::string_view text) {
  Parts parts(text);
  if (text.size() > 2 && text[2] == ':') {
    const auto clock = take_clock(parts);
    return clock && parts.done() ? clock : std::nullopt;
  }
  const auto date = take_date(parts);
  if (!date || !(parts.take('T') || parts.take(' ') || parts.take('/'))) return std::nullopt;
  const auto clock = take_clock(parts);
  const auto zone = clock ? take_zone(parts) : std::nullopt;
  return zone ? std::optional(*date + *clock - *zone) : std::nullopt;
}

Stamp ClockDays::unrolled(Stamp time_of_day) {
  if (before_ && time_of_day - *before_ < -kDay / 2) days_ += kDay;
  before_ = time_of_day;
  return days_ + time_of_day;
}

}  // namespace phasescan
