#include "io/scan_log.hpp"

#include <algorithm>
#include <vector>

#include "io/json.hpp"
#include "io/log_format.hpp"
#include "io/text_log.hpp"
#include "io/scan_json.hpp"

namespace phasescan {
namespace {

class ScanLogReader : public TextLogReader {
 public:
  using TextLogReader::TextLogReader;

  std::optional<LogEntry> next() override {
    while (next_line(text_)) {
      try {
        return parse();
      } catch (const InputError& error) {
        damage_here("bad line", error.reason());
      }
    }
    return std::nullopt;
  }
  std::string format() const override { return "scan log"; }

 private:
  LogEntry parse() {
    const json::Place place{path(), line_number(), text_};
    json::ScanArrays arrays;
    const bool taken = json::take_scan_arrays(text_, arrays, rest_);
    if (!taken) arrays = {};
    json::Json object;
    try {
      object = json::parse(taken ? json::Place{path(), line_number(), rest_} : place);
    } catch (const InputError&) {
      json::parse(place);  // names the byte of the whole line
      throw;
    }
    LogEntry entry;
    entry.line = line_number();
    entry.scan = json::scan_from(object, place, arrays);
    entry.laser = "scan";
    const auto odometry = object.find("odometry");
    if (odometry != object.end() && !odometry->is_null())
      entry.odometry = json::pose_from(*odometry, place, "odometry");
    return entry;
  }

  std::string text_, rest_;
};

// A scan's text over several lines (a scan JSON file made for reading) is a log of that one scan.
class ScanFileReader : public LogReader {
 public:
  explicit ScanFileReader(LogInput& input) {
    InputStream stream(input.name(), std::make_unique<StreamSource>(input.take()));
    entry_.emplace().scan = parse_scan_file(read_all(stream, LineReader::kMaxLineBytes), input.name());
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

bool is_json_object(const LogInput& input) {
  const std::string_view prefix = input.prefix();
  const std::size_t first = prefix.find_first_not_of(" \t\r\n\xEF\xBB\xBF");
  if (first == std::string_view::npos) return false;
  if (prefix[first] == '{') return true;
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
