#include "phasescan/io/scan_json.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "io/json.hpp"
#include "phasescan/io/error.hpp"
#include "io/file.hpp"
#include "io/number.hpp"

namespace phasescan {
namespace {

void append_range(std::string& out, const Scan& scan, std::size_t i) {
  const ScanGeometry& g = scan.geometry;
  switch (scan.states[i]) {
    case BeamState::kHit:
      return append_number(out, scan.ranges[i]);
    case BeamState::kInvalid:
      out += "null";
      return;
    case BeamState::kOutOfRange:
      return append_number(out, g.range_max > 0.0 ? static_cast<float>(g.range_max + 1.0) : 0.0F);
    case BeamState::kTooNear:
      return append_number(out, static_cast<float>(g.range_min / 2.0));
    case BeamState::kNoReturn:
      break;
  }
  out += '0';
}

void append_array(std::string& out, std::string_view key, std::span<const float> values) {
  out += ", \"" + std::string(key) + "\": [";
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (i > 0) out += ',';
    if (std::isfinite(values[i])) {
      append_number(out, values[i]);
    } else {
      out += "null";
    }
  }
  out += ']';
}

}  // namespace

namespace json {

void append_scan(std::string& out, const Scan& scan) {
  const auto field = [&](std::string_view key, double value) {
    out += out.ends_with('{') ? "\"" : ", \"";
    out.append(key).append("\": ");
    append_number(out, value);
  };
  out += '{';
  if (scan.angles.empty()) {
    field("angle_min", scan.geometry.angle_min);
    field("angle_increment", scan.geometry.angle_increment);
  }
  field("range_min", scan.geometry.range_min);
  field("range_max", scan.geometry.range_max);
  out += ", \"ranges\": [";
  for (std::size_t i = 0; i < scan.size(); ++i) {
    if (i > 0) out += ',';
    append_range(out, scan, i);
  }
  out += ']';
  if (scan.stamp != 0) {
    out += ", \"stamp\": ";
    append_stamp(out, scan.stamp);
  }
  if (scan.time_increment != 0.0) field("time_increment", scan.time_increment);
  if (!scan.intensities.empty()) append_array(out, "intensities", scan.intensities);
  if (!scan.angles.empty()) append_array(out, "angles", scan.angles);
  out += '}';
}

void append_pose(std::string& out, const Pose2& pose) {
  out += "{\"x\": ";
  append_number(out, pose.x);
  out += ", \"y\": ";
  append_number(out, pose.y);
  out += ", \"theta\": ";
  append_number(out, pose.theta);
  out += '}';
}

void append_string(std::string& out, std::string_view text) {
  out += Json(text).dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace json

Scan parse_scan_json(std::string_view text, const std::string& file, long line) {
  const json::Place place{file, line, text};
  return json::scan_from(json::parse(place), place);
}

std::string format_scan_json(const Scan& scan) {
  std::string out;
  json::append_scan(out, scan);
  return out;
}

Scan read_scan_file(const std::string& path) {
  return json::parse_scan_file(read_file(path, LineReader::kMaxLineBytes), path);
}

Scan json::parse_scan_file(std::string text, const std::string& path) {
  if (text.starts_with("\xEF\xBB\xBF")) text.erase(0, 3);
  if (text.find_first_not_of(" \t\r\n") == std::string::npos)
    throw InputError(path, 1, "the file is empty; expected a scan as JSON");
  return parse_scan_json(text, path);
}

}  // namespace phasescan
