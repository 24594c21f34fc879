// What `rostopic echo` and `ros2 topic echo` print of scans: YAML, a document a message.
//
//   header: / stamp: / secs: 1055, nsecs: 569000000 (sec, nanosec), frame_id: "laser", angle_min: -3.0, ...
//   ranges: [8.3, inf, ...]     or, ROS 2, a line "- 8.3" for each
//   ---
//
// By hand, not through the YAML library: arrays make up nearly all of it, and a tree of them takes a hundred times as
// long.
#include <cmath>
#include <optional>

#include "io/log_format.hpp"
#include "io/number.hpp"
#include "io/topic_text.hpp"
#include "phasescan/io/scan_json.hpp"

namespace phasescan {
namespace {

std::string_view trimmed(std::string_view text) {
  const std::size_t from = text.find_first_not_of(" \t\r");
  if (from == std::string_view::npos) return {};
  return text.substr(from, text.find_last_not_of(" \t\r") - from + 1);
}

/// 1.5, inf and nan (ROS 1), .inf, -.inf and .nan (ROS 2).
std::optional<double> yaml_number(std::string_view text) {
  if (const auto number = parse_number<double>(text)) return number;
  const bool negative = text.starts_with('-');
  if (negative) text.remove_prefix(1);
  if (!text.starts_with('.')) return std::nullopt;
  const auto word = parse_number<double>(text.substr(1));
  if (!word || std::isfinite(*word)) return std::nullopt;
  return negative ? -*word : *word;
}

/// What is wrong with the message being read.
struct BadMessage {
  std::string reason;
};

class TopicEchoReader final : public TopicTextReader {
 public:
  using TopicTextReader::TopicTextReader;

  std::string format() const override { return "text of topic echo"; }

  std::optional<LogEntry> next() override {
    while (next_line(line_)) {
      if (line_.starts_with("---")) {
        if (auto entry = finish_message()) return entry;
        continue;
      }
      if (!bad_.empty()) continue;
      try {
        read_line(line_);
      } catch (const BadMessage& bad) {
        bad_ = bad.reason;
        bad_line_ = line_number();
      }
    }
    return finish_last();
  }

 private:
  void read_line(std::string_view line) {
    if (array_ != nullptr && !in_brackets_ && line.starts_with("- ")) return add_number(trimmed(line.substr(2)));
    const std::string_view text = trimmed(line);
    if (text.starts_with("- ") || text == "-") {
      if (array_ != nullptr) add_number(trimmed(text.substr(1)));
      return;
    }
    if (in_brackets_) return read_list(text);
    array_ = nullptr;
    const std::size_t colon = text.find(':');
    if (colon == std::string_view::npos) return;
    const std::string_view key = text.substr(0, colon), value = trimmed(text.substr(colon + 1));
    if (key == "header") begun_ = begun_ ? begun_ : line_number();
    if (key == "ranges" || key == "intensities") {
      array_ = key == "ranges" ? &message_.ranges : &message_.intensities;
      has_ranges_ = has_ranges_ || key == "ranges";
      if (value.starts_with('[')) read_list(value.substr(1));
      return;
    }
    read_field(key, value);
  }

  /// The inside of [1.0, 2.0, ...], which may go on on the next line.
  void read_list(std::string_view text) {
    in_brackets_ = true;
    for (;;) {
      while (!text.empty() && take_plain(text)) {
      }
      const std::size_t end = text.find_first_of(",]");
      const std::string_view word = trimmed(text.substr(0, end));
      if (!word.empty()) add_number(word);
      if (end == std::string_view::npos) return;
      if (text[end] == ']') {
        in_brackets_ = false;
        array_ = nullptr;
        return;
      }
      text.remove_prefix(end + 1);
    }
  }

  /// A number and the comma behind it from the front of a list: nearly all there is in one.
  bool take_plain(std::string_view& text) {
    const std::size_t from = text.find_first_not_of(' ');
    if (from == std::string_view::npos) return false;
    const char *const begin = text.data() + from, *const end = text.data() + text.size();
    double value = 0.0;
    const char* next = read_plain_decimal(begin, end, value);
    if (next == nullptr) {
      const auto [stop, error] = std::from_chars(begin, end, value);
      next = error == std::errc{} ? stop : end;
    }
    if (next == end || *next != ',' || array_->size() >= kMaxBeams) return false;
    array_->push_back(static_cast<float>(value));
    text.remove_prefix(static_cast<std::size_t>(next - text.data()) + 1);
    return true;
  }

  void add_number(std::string_view word) {
    const auto value = yaml_number(word);
    if (!value && word.find("...") != std::string_view::npos)
      throw BadMessage{"the arrays were printed shortened; expected `ros2 topic echo --full-length`"};
    if (!value) throw BadMessage{quote_text(word) + " stands among the numbers; expected a number"};
    if (array_->size() >= kMaxBeams) throw BadMessage{"more beams than any scan has"};
    array_->push_back(static_cast<float>(*value));
  }

  void read_field(std::string_view key, std::string_view value) {
    if (key == "frame_id") {
      if (value.size() > 1 && (value.front() == '"' || value.front() == '\''))
        value = value.substr(1, value.size() - 2);
      message_.header.frame_id = value;
      return;
    }
    const bool seconds = key == "secs" || key == "sec", rest = key == "nsecs" || key == "nanosec";
    static constexpr std::string_view kNames[] = {"angle_min", "angle_max", "angle_increment", "time_increment",
                                                  "scan_time", "range_min", "range_max"};
    const auto places = scan_numbers(message_);
    const auto* name = std::find(std::begin(kNames), std::end(kNames), key);
    if (!seconds && !rest && name == std::end(kNames)) return;
    const auto number = yaml_number(value);
    if (!number) throw BadMessage{std::string(key) + " is " + quote_text(value) + "; expected a number"};
    if (name != std::end(kNames)) {
      *places[static_cast<std::size_t>(name - std::begin(kNames))] = static_cast<float>(*number);
    } else if (!(std::abs(*number) < (seconds ? kMostStampSeconds : 1e9))) {
      throw BadMessage{"a time that is none"};
    } else {
      message_.header.stamp += static_cast<Stamp>(*number) * (seconds ? 1'000'000'000 : 1);
    }
  }

  std::optional<LogEntry> finish_message() {
    std::optional<LogEntry> entry;
    const long line = begun_ ? begun_ : line_number();
    try {
      if (!bad_.empty()) throw BadMessage{bad_};
      if (in_brackets_) throw BadMessage{"a list without its end"};
      if (has_ranges_ && is_wanted()) entry = entry_of_message(line);
    } catch (const BadMessage& bad) {
      add_damage("bad message", InputError(path(), bad_.empty() ? line : bad_line_, bad.reason).what());
    } catch (const DecodeError& error) {
      add_damage("bad message", InputError(path(), line, error.what()).what());
    }
    begin_message();
    return entry;
  }

  /// The end of the file in the place of "---": whole where the beams are as many as the angles say.
  std::optional<LogEntry> finish_last() {
    if (!has_ranges_ && bad_.empty()) return std::nullopt;
    const double beams = 1.0 + (message_.angle_max - message_.angle_min) / message_.angle_increment;
    const bool whole = std::abs(beams - static_cast<double>(message_.ranges.size())) < 1.5 && line_was_ended();
    if (bad_.empty() && !whole) {
      add_damage("truncated message", InputError(path(), begun_, "the file ends inside the message").what());
      begin_message();
      return std::nullopt;
    }
    return finish_message();
  }

  void begin_message() {
    message_.header = {};
    message_.ranges.clear();
    message_.intensities.clear();
    message_.angle_min = message_.angle_max = message_.angle_increment = 0.0F;
    message_.time_increment = message_.scan_time = message_.range_min = message_.range_max = 0.0F;
    array_ = nullptr;
    has_ranges_ = in_brackets_ = false;
    begun_ = 0;
    bad_.clear();
  }

  std::string line_;
  std::vector<float>* array_ = nullptr;  ///< what "- 1.0" belongs to
  bool has_ranges_ = false, in_brackets_ = false;
  long begun_ = 0, bad_line_ = 0;
  std::string bad_;  ///< why the message cannot be read; the rest of it is passed over
};

bool is_topic_echo(const LogInput& input) {
  const std::string_view prefix = input.prefix();
  const auto has_line = [prefix](std::string_view begin) {
    return prefix.starts_with(begin) || prefix.find("\n" + std::string(begin)) != std::string_view::npos;
  };
  return has_line("header:") && has_line("angle_min:") && has_line("ranges:");
}

}  // namespace

LogFormat topic_echo_format() {
  return {"topic echo", is_topic_echo, [](LogInput& input, const LogOptions& options) -> std::unique_ptr<LogReader> {
            return std::make_unique<TopicEchoReader>(input, options);
          }};
}

}  // namespace phasescan
