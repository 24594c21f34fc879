// JSON pieces the readers share; kept out of the public headers because of its weight.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "phasescan/core/pose2.hpp"
#include "phasescan/scan/scan.hpp"

namespace phasescan::json {

using Json = nlohmann::json;

/// The text a message speaks of: file and number of the text's first line; `text` finds the line of a key.
struct Place {
  const std::string& file;
  long line = 1;
  std::string_view text;

  /// InputError at the line where `key` stands (the first line if it is empty or absent).
  [[noreturn]] void fail(std::string_view key, const std::string& reason) const;
};

/// Parses JSON that may hold NaN, Infinity and -Infinity as Python writes them; these become the strings "nan", "inf",
/// "-inf".
Json parse(const Place& place);

/// A number of an array: what is beyond any range is out of range.
float bounded(double value);

/// The long arrays of a scan object, read straight from its text: a tree of them would take most of the time.
struct ScanArrays {
  std::optional<std::vector<float>> ranges, intensities, angles;
};

/// Takes the arrays out of the text of a scan object; `rest` becomes the text with empty ones. False where one of them
/// holds anything but plain numbers and nulls: then the whole text is for `parse`, which says what is wrong.
bool take_scan_arrays(std::string_view text, ScanArrays& arrays, std::string& rest);

/// The time of a scan object: its "stamp" or "timestamp", or that of its "header", in seconds, in parts ({"sec",
/// "nanosec"}) or as a clock writes it. Nothing where none of them is there. @throws InputError for one that is no time
std::optional<Stamp> stamp_of(const Json& object, const Place& place);

/// A scan object. Arrays that were taken out of the text already stand in `taken`.
Scan scan_from(const Json& object, const Place& place, const ScanArrays& taken = {});

/// The text of a file that holds one scan; `path` is what errors call it. @throws InputError
Scan parse_scan_file(std::string text, const std::string& path);

/// {"x", "y", "theta"}, finite, theta wrapped.
Pose2 pose_from(const Json& object, const Place& place, std::string_view key);

/// Appends a scan, or a pose, as JSON text.
void append_scan(std::string& out, const Scan& scan);
void append_pose(std::string& out, const Pose2& pose);
/// Appends a string in quotes with what JSON needs escaped.
void append_string(std::string& out, std::string_view text);

}  // namespace phasescan::json
