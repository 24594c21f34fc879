// SICK's telegrams as text (CoLa A): LMDscandata of LMS1xx, LMS5xx, TiM, MRS; a telegram between STX and ETX or on a
// line; io/sick_telegram.hpp says what is in one.
#include <optional>

#include "io/log_format.hpp"
#include "io/sick_telegram.hpp"
#include "io/text_log.hpp"
#include "io/text_numbers.hpp"

namespace phasescan {
namespace {

constexpr double kAheadIs90_deg = -90.0;  // models whose ahead is 0 cannot be told apart in a log

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
    SickTelegram telegram = read_sick_telegram(words_, kAheadIs90_deg);
    if (telegram.layer != 0) {
      ++other_layers_;
      return std::nullopt;
    }
    LogEntry entry;
    entry.scan = std::move(telegram.scan);
    entry.scan.stamp = stamp_of(telegram.started_us);
    entry.laser = "sick";
    entry.line = line_number();
    return entry;
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
