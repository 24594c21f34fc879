#include "io/scan_log.hpp"

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
  explicit ScanFileReader(const std::string& path) { entry_.emplace().scan = read_scan_file(path); }

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

bool is_json_object(const std::string&, std::string_view prefix) {
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

std::unique_ptr<LogReader> open_json(const std::string& path, const LogOptions&) {
  LineReader lines(path);
  std::string line;
  while (lines.next(line) && line.find_first_not_of(" \t") == std::string::npos) {
  }
  if (line.find("\"reference\"") != std::string::npos) {
    throw InputError(path, lines.line_number(), "is a pairs file; expected a log of scans");
  }
  line.erase(line.find_last_not_of(" \t") + 1);
  if (line.ends_with('}') || !lines.line_was_ended()) return std::make_unique<ScanLogReader>(path);
  std::string second;
  while (lines.next(second) && second.find_first_not_of(" \t") == std::string::npos) {
  }
  const std::size_t start = second.find_first_not_of(" \t");
  const bool one_object = start != std::string::npos && second[start] != '{';
  if (one_object) return std::make_unique<ScanFileReader>(path);
  return std::make_unique<ScanLogReader>(path);
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
