#include "io/scan_log.hpp"

#include <algorithm>
#include <vector>

#include "io/json.hpp"
#include "io/json_objects.hpp"
#include "io/log_format.hpp"
#include "io/text_log.hpp"
#include "phasescan/io/scan_json.hpp"

namespace phasescan {
namespace {

/// Makes entries of the texts of scan objects; gives times to a log without.
class ScanParser {
 public:
  LogEntry parse(const std::string& file, long line, const std::string& text) {
    const json::Place place{file, line, text};
    json::ScanArrays arrays;
    const bool taken = json::take_scan_arrays(text, arrays, rest_);
    if (!taken) arrays = {};
    json::Json object;
    try {
      object = json::parse(taken ? json::Place{file, line, rest_} : place);
    } catch (const InputError&) {
      json::parse(place);  // names the byte of the whole line
      throw;
    }
    LogEntry entry;
    entry.line = line;
    entry.scan = json::scan_from(object, place, arrays);
    entry.laser = "scan";
    const auto odometry = object.find("odometry");
    odometry_error_.clear();
    if (odometry != object.end() && !odometry->is_null()) {
      try {
        entry.odometry = json::pose_from(*odometry, place, "odometry");
      } catch (const InputError& error) {  // the scan itself is whole
        odometry_error_ = error.reason() + "; the scan is used without it";
      }
    }
    stamp(entry.scan, object, place);
    return entry;
  }

  /// Why the odometry of the last scan could not be read; empty where it could, or there was none.
  const std::string& odometry_error() const { return odometry_error_; }

  std::vector<LogRemark> remarks() const {
    if (scans_ < 2 || stamped_) return {};
    return {{"assumed stamps", "the scans state no times: 0.1 s a scan is assumed"}};
  }

 private:
  /// A scan without a stamp may be the first one of a clock that begins at 0.
  void stamp(Scan& scan, const json::Json& object, const json::Place& place) {
    constexpr Stamp kAssumed = 100'000'000;
    stamped_ = stamped_ || json::stamp_of(object, place).has_value();
    if (!stamped_) scan.stamp = scans_ * kAssumed;
    ++scans_;
  }

  std::string rest_, odometry_error_;
  Stamp scans_ = 0;
  bool stamped_ = false;
};

class ScanLogReader : public TextLogReader {
 public:
  using TextLogReader::TextLogReader;

  std::optional<LogEntry> next() override {
    while (next_line(text_)) {
      try {
        LogEntry entry = parser_.parse(path(), line_number(), text_);
        if (!parser_.odometry_error().empty()) damage_here("bad odometry", parser_.odometry_error());
        return entry;
      } catch (const InputError& error) {
        damage_here("bad line", error.reason());
      }
    }
    return std::nullopt;
  }
  std::string format() const override { return "scan log"; }
  std::vector<LogRemark> remarks() const override { return parser_.remarks(); }

 private:
  ScanParser parser_;
  std::string text_;
};

/// An array of scans.
class ScanArrayReader : public LogReader {
 public:
  explicit ScanArrayReader(LogInput& input)
      : path_(input.name()), objects_(InputStream(input.name(), std::make_unique<StreamSource>(input.take()))) {}

  std::optional<LogEntry> next() override {
    try {
      while (objects_.next(text_, line_)) {
        try {
          LogEntry entry = parser_.parse(path_, line_, text_);
          if (!parser_.odometry_error().empty())
            add_damage("bad odometry", InputError(path_, line_, parser_.odometry_error()).what());
          return entry;
        } catch (const InputError& error) {
          add_damage("bad scan", error.what());
        }
      }
    } catch (const InputError& error) {
      add_damage("truncated file", error.what());
    }
    return std::nullopt;
  }
  std::string format() const override { return "scans in a JSON array"; }
  std::vector<LogRemark> remarks() const override { return parser_.remarks(); }

 private:
  std::string path_;
  JsonObjects objects_;
  ScanParser parser_;
  std::string text_;
  long line_ = 1;
};

// A scan's text over several lines (a scan JSON file made for reading) is a log of that one scan.
class ScanFileReader : public LogReader {
 public:
  explicit ScanFileReader(LogInput& input) {
    InputStream stream(input.name(), std::make_unique<StreamSource>(input.take()));
    entry_.emplace().scan = json::parse_scan_file(read_all(stream, LineReader::kMaxLineBytes), input.name());
  }

  std::optional<LogEntry> next() override {
    auto out = std::move(entry_);
    entry_.reset();
    if (out) {
      out->laser = "scan";
      out->line = 1;
    }
    return out;
  }
  std::string format() const override { return "scan"; }

 private:
  std::optional<LogEntry> entry_;
};

/// "[{": an array of objects.
bool starts_array(std::string_view prefix) {
  const std::size_t open = prefix.find('[');
  const std::size_t next = prefix.find_first_not_of(" \t\r\n", std::min(open, prefix.size() - 1) + 1);
  return open != std::string_view::npos && next != std::string_view::npos && prefix[next] == '{';
}

bool is_json_object(const LogInput& input) {
  const std::string_view prefix = input.prefix();
  const std::size_t first = prefix.find_first_not_of(" \t\r\n\xEF\xBB\xBF");
  if (first == std::string_view::npos) return false;
  if (prefix[first] == '{') return true;
  if (prefix[first] == '[') return starts_array(prefix);
  // A log whose beginning was cut off, or rubbish before it: a scan on a later line tells.
  for (std::size_t at = prefix.find("\n{"); at != std::string_view::npos; at = prefix.find("\n{", at + 1)) {
    const std::string_view line = prefix.substr(at + 1, prefix.find('\n', at + 1) - at - 1);
    if (line.find("\"ranges\"") != std::string_view::npos) return true;
  }
  return false;
}

bool is_blank(std::string_view line) {
  return line.find_first_not_of(" \t\r\xEF\xBB\xBF") == std::string_view::npos;
}

/// A first line that does not end an object, and a second one that begins none: one object over several lines.
bool is_one_object(std::string_view prefix) {
  std::vector<std::string_view> lines;
  while (lines.size() < 2) {
    const std::size_t end = prefix.find('\n');
    // A line that does not end here is longer than anyone writes for reading.
    if (end == std::string_view::npos && (lines.empty() || prefix.empty())) return false;
    const std::string_view line = prefix.substr(0, end);
    if (!is_blank(line)) lines.push_back(line);
    prefix.remove_prefix(end == std::string_view::npos ? prefix.size() : end + 1);
  }
  const std::size_t last = lines[0].find_last_not_of(" \t\r");
  return lines[0][last] != '}' && lines[1][lines[1].find_first_not_of(" \t")] != '{';
}

std::unique_ptr<LogReader> open_json(LogInput& input, const LogOptions&) {
  const std::string_view prefix = input.prefix();
  const std::size_t start = std::min(prefix.find('{'), prefix.size());
  const std::string_view first_line = prefix.substr(start, prefix.find('\n', start) - start);
  if (first_line.find("\"reference\"") != std::string_view::npos) {
    const long line =
        1 + static_cast<long>(std::count(prefix.begin(), prefix.begin() + static_cast<long>(start), '\n'));
    throw InputError(input.name(), line, "is a pairs file; expected a log of scans");
  }
  if (prefix[prefix.find_first_not_of(" \t\r\n\xEF\xBB\xBF")] == '[') return std::make_unique<ScanArrayReader>(input);
  if (is_one_object(prefix)) return std::make_unique<ScanFileReader>(input);
  return std::make_unique<ScanLogReader>(input);
}

}  // namespace

LogFormat scan_log_format() {
  return {"scan log (JSON Lines)", is_json_object, open_json};
}

std::string format_log_line(const LogEntry& entry) {
  std::string out = format_scan_json(entry.scan);
  if (entry.odometry) {
    out.back() = ',';
    out += " \"odometry\": ";
    json::append_pose(out, *entry.odometry * entry.T_base_laser);
    out += '}';
  }
  return out;
}

}  // namespace phasescan
