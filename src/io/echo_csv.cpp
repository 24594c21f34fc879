// What `ros2 topic echo --csv` prints of scans: the message's numbers in their order, without names and counts.
//
//   sec,nanosec,frame_id,angle_min,angle_max,angle_increment,time_increment,scan_time,range_min,range_max,ranges..,intensities..
#include <algorithm>
#include <cmath>

#include "io/log_format.hpp"
#include "io/topic_text.hpp"
#include "io/text_numbers.hpp"

namespace phasescan {
namespace {

constexpr std::size_t kHead = 10;

/// How many of `numbers` values behind the head are ranges: as many as the angles say, within a twentieth, since
/// drivers state rounded increments; the others are intensities, none or as many.
std::optional<std::size_t> count_ranges(const ros::LaserScan& message, std::size_t numbers) {
  const double stated = 1.0 + (double{message.angle_max} - double{message.angle_min}) / double{message.angle_increment};
  const auto fits = [stated](std::size_t n) {
    return std::abs(stated - static_cast<double>(n)) < std::max(1.5, stated / 20.0);
  };
  if (numbers % 2 == 0 && fits(numbers / 2)) return numbers / 2;
  return fits(numbers) ? std::optional(numbers) : std::nullopt;
}

/// The head of a line; false where it is none.
bool read_head(const std::vector<std::string_view>& fields, ros::LaserScan& message) {
  if (fields.size() <= kHead) return false;
  const auto seconds = parse_number<std::int64_t>(fields[0]);
  const auto rest = parse_number<std::uint32_t>(fields[1]);
  const bool frame = !fields[2].empty() && !parse_number<double>(fields[2]);
  if (!seconds || std::abs(static_cast<double>(*seconds)) > kMostStampSeconds || !rest || *rest > 999'999'999 || !frame)
    return false;
  message.header.stamp = *seconds * 1'000'000'000 + Stamp{*rest};
  message.header.frame_id = fields[2];
  const auto places = scan_numbers(message);
  for (std::size_t i = 0; i < places.size(); ++i) {
    const auto number = parse_number<double>(fields[3 + i]);
    if (!number) return false;
    *places[i] = static_cast<float>(*number);
  }
  return true;
}

class EchoCsvReader final : public TopicTextReader {
 public:
  using TopicTextReader::TopicTextReader;

  std::string format() const override { return "csv of topic echo"; }

  std::optional<LogEntry> next() override {
    while (next_line(line_)) {
      try {
        if (auto entry = read_line()) return entry;
      } catch (const DecodeError& error) {
        damage_here("bad line", error.what());
      }
    }
    return std::nullopt;
  }

 private:
  std::optional<LogEntry> read_line() {
    split_fields(line_, ',', fields_);
    if (!read_head(fields_, message_)) throw DecodeError("no message; expected sec,nanosec,frame_id,angle_min,...");
    if (!is_wanted()) return std::nullopt;
    const auto count = count_ranges(message_, fields_.size() - kHead);
    if (!count) {
      const bool shortened = line_.find("...") != std::string::npos;
      throw DecodeError(shortened ? "the arrays were printed shortened; expected `ros2 topic echo --csv --full-length`"
                                  : std::to_string(fields_.size() - kHead) +
                                        " numbers behind the head do not fit its angles");
    }
    numbers_.clear();
    for (std::size_t i = kHead; i < fields_.size(); ++i) {
      const auto number = parse_number<double>(fields_[i]);
      if (!number)
        throw DecodeError("field " + std::to_string(i + 1) + " is " + quote_text(fields_[i]) + "; expected a number");
      numbers_.push_back(static_cast<float>(*number));
    }
    const auto middle = numbers_.begin() + static_cast<std::ptrdiff_t>(*count);
    message_.ranges.assign(numbers_.begin(), middle);
    message_.intensities.assign(middle, numbers_.end());
    return entry_of_message(line_number());
  }

  std::string line_;
  std::vector<std::string_view> fields_;
  std::vector<float> numbers_;
};

bool is_echo_csv(const LogInput& input) {
  const std::string_view prefix = input.prefix();
  std::vector<std::string_view> fields;
  split_fields(prefix.substr(0, prefix.find('\n')), ',', fields);
  ros::LaserScan message;
  return read_head(fields, message);
}

}  // namespace

LogFormat echo_csv_format() {
  return {"topic echo --csv", is_echo_csv,
          [](LogInput& input, const LogOptions& options) -> std::unique_ptr<LogReader> {
            return std::make_unique<EchoCsvReader>(input, options);
          }};
}

}  // namespace phasescan
