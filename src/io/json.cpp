#include "io/json.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "phasescan/io/error.hpp"
#include "io/clock_stamp.hpp"
#include "io/file.hpp"
#include "io/number.hpp"
#include "phasescan/io/scan_json.hpp"

namespace phasescan::json {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// Beyond these a number cannot be what the field means (degrees for radians is caught by nothing, a garbage exponent
// is).
constexpr double kAngleLimit = 1000.0;    // [rad]
constexpr double kRangeLimit = 100000.0;  // [m]: out of any range
constexpr double kBeamTimeLimit = 1.0;    // [s] between beams: absurd values are read as unknown

long line_at(const Place& place, std::size_t offset) {
  const auto end = place.text.begin() + static_cast<std::ptrdiff_t>(std::min(offset, place.text.size()));
  return place.line + static_cast<long>(std::count(place.text.begin(), end, '\n'));
}

// Python's json module writes bare NaN, Infinity and -Infinity, which is no JSON: the same text with those in quotes,
// or nothing where there are none.
std::optional<std::string> with_quoted_specials(std::string_view text) {
  static constexpr std::array<std::pair<std::string_view, std::string_view>, 3> kWords{
      {{"NaN", "\"nan\""}, {"-Infinity", "\"-inf\""}, {"Infinity", "\"inf\""}}};
  std::string out;
  bool in_string = false, any = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (in_string && c == '\\' && i + 1 < text.size()) {
      out += c;
      out += text[++i];
      continue;
    }
    if (c == '"') in_string = !in_string;
    if (!in_string) {
      const auto* word = std::find_if(kWords.begin(), kWords.end(),
                                      [&](const auto& w) { return text.substr(i).starts_with(w.first); });
      if (word != kWords.end()) {
        out += word->second;
        i += word->first.size() - 1;
        any = true;
        continue;
      }
    }
    out += c;
  }
  return any ? std::optional(out) : std::nullopt;
}

std::string kind_of(const Json& value) {
  if (value.is_string()) return quote_text(value.get_ref<const std::string&>());
  return std::string("a value of type ") + value.type_name();
}

// A number, or one of the words for what is no finite number; nothing for anything else.
std::optional<double> number_from(const Json& value) {
  if (value.is_number()) return value.get<double>();
  if (!value.is_string()) return std::nullopt;
  const auto& word = value.get_ref<const std::string&>();
  if (word == "nan") return std::numeric_limits<double>::quiet_NaN();
  if (word == "inf") return kInfinity;
  if (word == "-inf") return -kInfinity;
  return std::nullopt;
}

double number_of(const Json& object, const Place& place, const char* key, std::optional<double> absent) {
  const auto found = object.find(key);
  if (found == object.end() || (found->is_null() && absent)) {
    if (absent) return *absent;
    place.fail("", std::string("\"") + key + "\" is missing; expected a number");
  }
  const auto value = number_from(*found);
  if (!value) place.fail(key, std::string("\"") + key + "\" is " + kind_of(*found) + "; expected a number");
  return *value;
}

double angle_of(const Json& object, const Place& place, const char* key) {
  const double value = number_of(object, place, key, std::nullopt);
  if (!(std::abs(value) <= kAngleLimit)) {
    place.fail(key, std::string("\"") + key + "\" is not a possible angle; expected radians");
  }
  return value;
}

const Json* array_of(const Json& object, const Place& place, const char* key) {
  const auto found = object.find(key);
  if (found == object.end() || found->is_null()) return nullptr;
  if (!found->is_array()) place.fail(key, std::string("\"") + key + "\" is " + kind_of(*found) + "; expected an array");
  if (found->size() > kMaxBeams) {
    place.fail(key, std::string("\"") + key + "\" has " + std::to_string(found->size()) +
                        " entries; expected at most " + std::to_string(kMaxBeams));
  }
  return &*found;
}

std::vector<float> numbers_of(const Json& array, const Place& place, const char* key) {
  std::vector<float> out;
  out.reserve(array.size());
  for (const Json& entry : array) {
    const auto value = entry.is_null() ? std::numeric_limits<double>::quiet_NaN() : number_from(entry);
    if (!value) {
      place.fail(key, std::string("\"") + key + "\"[" + std::to_string(out.size()) + "] is " + kind_of(entry) +
                          "; expected a number or null");
    }
    out.push_back(bounded(*value));
  }
  return out;
}

void expect_count(const std::vector<float>& values, std::size_t beams, const Place& place, const char* key) {
  if (values.size() == beams) return;
  place.fail(key, std::string("\"") + key + "\" has " + std::to_string(values.size()) +
                      " entries; expected one for each of the " + std::to_string(beams) + " ranges");
}

/// A number of seconds with its own digits, which a double does not hold at 1.7e9 s.
Stamp exact_seconds(double seconds, const Place& place, const char* key) {
  if (!(std::abs(seconds) < kMostStampSeconds))
    place.fail(key, std::string("\"") + key + "\" is not a possible time; expected seconds");
  const Stamp rough = stamp_from_seconds(seconds);
  const std::string quoted = "\"" + std::string(key) + "\"";
  for (std::size_t at = place.text.find(quoted); at != std::string_view::npos; at = place.text.find(quoted, at + 1)) {
    const std::size_t from = place.text.find_first_not_of(": \t\r\n", at + quoted.size());
    if (from == std::string_view::npos) break;
    const auto exact = parse_stamp(place.text.substr(from, place.text.find_first_of(",} \t\r\n", from) - from));
    if (exact && std::abs(*exact - rough) < 1000) return *exact;
  }
  return rough;
}

/// {"sec", "nanosec"} of ROS 2, {"secs", "nsecs"} of ROS 1, {"sec", "nsec"} of Foxglove.
std::optional<Stamp> stamp_of_parts(const Json& object) {
  std::optional<double> seconds, rest;
  for (const auto& [key, value] : object.items()) {
    const auto number = number_from(value);
    if (key == "sec" || key == "secs") seconds = number;
    if (key == "nanosec" || key == "nsec" || key == "nsecs") rest = number;
  }
  if (!seconds || !(std::abs(*seconds) < kMostStampSeconds) || !(rest.value_or(0.0) >= 0.0 && rest.value_or(0.0) < 1e9))
    return std::nullopt;
  return stamp_from_seconds(std::floor(*seconds)) + static_cast<Stamp>(rest.value_or(0.0));
}

/// A number that is a time in s, or by its size in ms, us or ns.
double seconds_by_size(double value) {
  const double size = std::abs(value);
  return size > 1e17 ? value * 1e-9 : size > 1e14 ? value * 1e-6 : size > 1e11 ? value * 1e-3 : value;
}

}  // namespace

std::optional<Stamp> stamp_of(const Json& object, const Place& place) {
  const auto header = object.find("header");
  const bool has_header = header != object.end() && header->is_object();
  for (const auto& [where, key] : {std::pair{&object, "stamp"}, std::pair{&object, "timestamp"},
                                   std::pair{has_header ? &*header : &object, "stamp"}}) {
    const auto found = where->find(key);
    if (found == where->end() || found->is_null()) continue;
    if (found->is_object()) {
      if (const auto stamp = stamp_of_parts(*found)) return stamp;
      place.fail(key, std::string("\"") + key + "\" is no time; expected seconds, or {\"sec\": .., \"nanosec\": ..}");
    }
    const auto number = number_from(*found);
    const bool clock = found->is_string() && !number;
    if (const auto stamp = clock ? parse_clock_stamp(found->get_ref<const std::string&>()) : std::nullopt) return stamp;
    if (!number) place.fail(key, std::string("\"") + key + "\" is " + kind_of(*found) + "; expected seconds");
    // Whole numbers of 2^53 and more lose digits as doubles.
    if (std::string_view(key) == "timestamp" && found->is_number_integer() && std::abs(*number) > 1e17)
      return found->get<std::int64_t>();
    return exact_seconds(std::string_view(key) == "timestamp" ? seconds_by_size(*number) : *number, place, key);
  }
  return std::nullopt;
}

float bounded(double value) {
  return static_cast<float>(value > kRangeLimit ? kInfinity : value);
}

void Place::fail(std::string_view key, const std::string& reason) const {
  const std::size_t at = key.empty() ? 0 : text.find("\"" + std::string(key) + "\"");
  throw InputError(file, at == std::string_view::npos ? line : line_at(*this, at), reason);
}

Json parse(const Place& place) {
  try {
    return Json::parse(place.text);
  } catch (const Json::exception&) {
    const auto repaired = with_quoted_specials(place.text);
    const std::string_view text = repaired ? std::string_view(*repaired) : place.text;
    try {
      return Json::parse(text);
    } catch (const Json::parse_error& error) {
      const bool cut = error.byte > text.size();
      throw InputError(place.file, line_at({place.file, place.line, text}, error.byte == 0 ? 0 : error.byte - 1),
                       cut ? "the JSON text is cut off; expected a whole object"
                           : "is not JSON at byte " + std::to_string(error.byte) + ": " +
                                 quote_text(text.substr(std::max<std::size_t>(error.byte, 1) - 1, 20)) +
                                 "; expected a JSON object");
    } catch (const Json::exception&) {
      throw InputError(place.file, place.line,
                       "holds a number too large for a double; expected JSON with ordinary numbers");
    }
  }
}

Scan scan_from(const Json& object, const Place& place, const ScanArrays& taken) {
  if (!object.is_object()) place.fail("", "is " + kind_of(object) + "; expected a scan object");
  const auto array = [&](const std::optional<std::vector<float>>& there, const char* key) {
    if (there) return there;
    const Json* found = array_of(object, place, key);
    return found == nullptr ? std::nullopt : std::optional(numbers_of(*found, place, key));
  };
  const auto raw = array(taken.ranges, "ranges");
  if (!raw) place.fail("", "\"ranges\" is missing; expected a scan with an array of ranges");
  ScanGeometry geometry;
  const auto angles = array(taken.angles, "angles");
  if (angles) {
    expect_count(*angles, raw->size(), place, "angles");
    for (const float angle : *angles) {
      if (!(std::abs(angle) <= static_cast<float>(kAngleLimit)))
        place.fail("angles", "\"angles\" holds no possible angle; expected radians");
    }
  } else {
    geometry.angle_min = angle_of(object, place, "angle_min");
    geometry.angle_increment = angle_of(object, place, "angle_increment");
    if (geometry.angle_increment == 0.0 && raw->size() > 1) {
      place.fail("angle_increment",
                 "\"angle_increment\" is 0; expected radians between beams, negative for a clockwise sensor");
    }
  }
  geometry.range_min = number_of(object, place, "range_min", 0.0);
  geometry.range_max = number_of(object, place, "range_max", 0.0);
  Scan scan = make_scan(*raw, geometry, angles.value_or(std::vector<float>()));
  scan.stamp = stamp_of(object, place).value_or(0);
  const double step = number_of(object, place, "time_increment", 0.0);
  scan.time_increment = step > 0.0 && step <= kBeamTimeLimit ? step : 0.0;
  if (auto intensities = array(taken.intensities, "intensities"); intensities && !intensities->empty()) {
    expect_count(*intensities, raw->size(), place, "intensities");
    for (float& value : *intensities) value = std::isfinite(value) ? value : 0.0F;
    scan.intensities = std::move(*intensities);
  }
  return scan;
}

Pose2 pose_from(const Json& object, const Place& place, std::string_view key) {
  const std::string expected = "; expected {\"x\": .., \"y\": .., \"theta\": ..}";
  if (!object.is_object()) place.fail(key, "\"" + std::string(key) + "\" is " + kind_of(object) + expected);
  double values[3];
  const char* const names[3] = {"x", "y", "theta"};
  for (int i = 0; i < 3; ++i) {
    const auto found = object.find(names[i]);
    const auto value = found == object.end() ? std::nullopt : number_from(*found);
    if (!value || !(std::abs(*value) < 1e9)) {
      place.fail(key, "\"" + std::string(key) + "\" has no usable \"" + names[i] + "\"" + expected);
    }
    values[i] = *value;
  }
  return {values[0], values[1], wrap_angle(values[2])};
}

}  // namespace phasescan::json
