#include "io/foreign_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <vector>

#include "io/clock_stamp.hpp"
#include "io/text_numbers.hpp"

namespace phasescan {
namespace {

struct Foreign {
  std::string_view magic;
  std::size_t at;
  std::string_view what;
};

constexpr Foreign kForeign[] = {
    {"version https://git-lfs.github.com/spec", 0,
     "is a Git LFS pointer, not the file it stands for; `git lfs pull` fetches that"},
    {"PK\x03\x04", 0, "is a zip archive; expected the log in it, unpacked"},
    {"7z\xbc\xaf\x27\x1c", 0, "is a 7z archive; expected the log in it, unpacked"},
    {"\xfd"
     "7zXZ",
     0, "is packed with xz; expected it unpacked, or packed with gzip, bzip2, lz4 or zstd"},
    {"ustar", 257, "is a tar archive; expected the log in it, unpacked"},
    {"\xd4\xc3\xb2\xa1", 0, "is a capture of network packets (pcap); expected what the driver makes of them"},
    {"\x0a\x0d\x0d\x0a", 0, "is a capture of network packets (pcapng); expected what the driver makes of them"},
    {"# .PCD", 0, "is a point cloud (PCD); expected a log of laser scans"},
    {"ply\n", 0, "is a point cloud (PLY); expected a log of laser scans"},
    {"LASF", 0, "is a point cloud (LAS); expected a log of laser scans"},
    {"\x89HDF\r\n", 0, "is an HDF5 file; expected a log of laser scans"},
    {"\x93NUMPY", 0, "is a numpy array; `np.savetxt(\"log.txt\", a)` makes text of it, read with --columns"},
    {"MATLAB 5.0", 0, "is a MATLAB file; `writematrix(a, \"log.csv\")` makes text of it, read with --columns"},
    {"\x89PNG", 0, "is a picture; expected a log of laser scans"},
    {"%PDF", 0, "is a PDF; expected a log of laser scans"},
};

/// Objects one after the other, each with the name of its class in front: 0x80 + length, "CSensoryFrame".
bool is_rawlog(std::string_view prefix) {
  if (prefix.size() < 2 || (prefix[0] & 0x80) == 0) return false;
  const auto length = static_cast<std::size_t>(prefix[0] & 0x7F);
  const std::string_view name = prefix.substr(1, length);
  const auto is_word = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == ':' || c == '_'; };
  return length > 4 && name.size() == length && (name[0] == 'C' || name.starts_with("mrpt")) &&
         std::all_of(name.begin(), name.end(), is_word);
}

bool is_one_of(std::string_view prefix, const Foreign& foreign) {
  return prefix.size() > foreign.at && prefix.substr(foreign.at).starts_with(foreign.magic);
}

struct NumberLines {
  std::vector<std::vector<double>> rows;  ///< the first lines, at most two; a stamp as a clock writes it stands as NaN
  bool clock = false;                     ///< the first field is a stamp as a clock writes it
};

/// The first lines, where they are numbers, behind a stamp or not; else none.
NumberLines number_lines(std::string_view text, char& separator) {
  NumberLines lines;
  std::vector<std::string_view> fields;
  while (!text.empty() && lines.rows.size() < 2) {
    const std::size_t end = text.find('\n');
    std::string_view line = text.substr(0, end);
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    if (line.find_first_not_of(" \t") == std::string_view::npos || line.front() == '#' || line.front() == '%') continue;
    separator = ' ';
    for (const char candidate : {',', ';', '\t'}) {
      if (separator == ' ' && line.find(candidate) != std::string_view::npos) separator = candidate;
    }
    split_fields(line, separator, fields);
    while (!fields.empty() && fields.back().empty()) fields.pop_back();
    // A line longer than what is looked at ends inside a number.
    if (end == std::string_view::npos && fields.size() > 1) fields.pop_back();
    const bool clock = fields.size() > 1 && parse_clock_stamp(fields.front()).has_value();
    if (clock) fields.front() = "nan";
    lines.clock |= clock;
    lines.rows.emplace_back();
    if (!parse_numbers(fields, lines.rows.back())) return {};
  }
  return lines;
}

}  // namespace

std::optional<std::string> foreign_file(std::string_view prefix) {
  if (is_rawlog(prefix))
    return "is an MRPT rawlog; `rawlog-edit --export-2d-scans-txt` makes text of it, which is read with --columns";
  for (const Foreign& foreign : kForeign) {
    if (is_one_of(prefix, foreign)) return std::string(foreign.what);
  }
  return std::nullopt;
}

std::optional<std::string> numbers_hint(std::string_view prefix) {
  char separator = ' ';
  const auto [rows, clock] = number_lines(prefix, separator);
  if (rows.empty() || rows[0].size() < 2) return std::nullopt;
  const std::size_t count = rows[0].size();
  if (clock && count == 2) return std::nullopt;  // one number at a time is no scan
  if (count <= 4) {
    const char* names = count == 2   ? "angle_deg,range_mm"
                        : count == 3 ? (clock ? "stamp,angle_deg,range_mm" : "angle_deg,range_mm,quality")
                        : clock      ? "stamp,quality,angle_deg,range_mm"
                                     : "stamp,angle_deg,range_mm,quality";
    return fmt::format(
        "{} numbers a line and no header; expected --columns with their names, for example --columns {} for a beam a "
        "line",
        count, names);
  }
  // A first number that runs on while the others are of one kind is a time.
  const bool stamped =
      clock || (rows.size() > 1 && rows[1].size() > 1 && rows[1][0] > rows[0][0] && rows[0][0] > 100.0 * rows[0][1]);
  return fmt::format(
      "{} numbers a line and no header; expected --columns {} and the field of view, --fov DEG (a scan a "
      "line; the names say what comes before the ranges, units as in stamp_ms,ranges_mm)",
      count, stamped ? "stamp,ranges" : "ranges");
}

}  // namespace phasescan
