/// Scans as JSON (CONTRACT: scan JSON).
///
/// Read: 0, null, NaN, +-Infinity (as Python writes them), numbers outside range_min..range_max are missing beams, each
/// with its reason. Written: numbers in the shortest form that reads back the same; a missing beam is
///   0 for a sensor's unexplained "no return", null for an invalid one,
///   range_max + 1 for out of range and range_min / 2 for too near (0 where the limit is unknown),
/// so that reading the text again gives the same reasons. `stamp` is seconds with up to nine decimals, exact.
#pragma once

#include <string>
#include <string_view>

#include "phasescan/scan/scan.hpp"

namespace phasescan {

/// More beams than any planar lidar gives in a turn; a scan with more is refused.
inline constexpr std::size_t kMaxBeams = 1'000'000;

/// Parses one scan. `file` and `line` (the number of the text's first line) only name the place in messages.
/// @throws InputError "FILE:LINE: ..." for text that is no scan.
Scan parse_scan_json(std::string_view text, const std::string& file, long line = 1);

/// One scan as one line of JSON without newline.
std::string format_scan_json(const Scan& scan);

/// Reads a file that holds one scan, over any number of lines. @throws InputError, SystemError
Scan read_scan_file(const std::string& path);

}  // namespace phasescan
