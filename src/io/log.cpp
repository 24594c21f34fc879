#include "phasescan/io/log.hpp"

#include "io/beam_geometry.hpp"
#include "io/csv_log.hpp"
#include "io/cut_log.hpp"
#include "io/foreign_files.hpp"
#include "io/log_format.hpp"
#include "phasescan/io/error.hpp"

namespace phasescan {
namespace {

// Asked in this order: what is recognised by a magic number first, text by its words after.
std::vector<LogFormat> log_formats() {
  return {
      rosbag1_format(),  rosbag2_format(),      mcap_format(), scan_log_format(), carmen_format(),  topic_echo_format(),
      echo_csv_format(), ultra_simple_format(), sick_format(), s_lines_format(),  lowcost_format(), csv_format(),
  };
}

/// Flags of a text without angles or units are a mistake for a file that states its own.
void expect_no_geometry(const LogInput& input, const LogOptions& options, std::string_view format) {
  if (!is_stated(options.beams) && !options.beams.clockwise && options.stamp_unit.empty()) return;
  throw InputError(input.name(), 0,
                   "states its own angles and times: " + std::string(format) +
                       "; expected no --fov, --angle-min, --angle-increment, --clockwise, --stamp-unit with it");
}

std::unique_ptr<LogReader> open_any(LogInput& input, const LogOptions& options) {
  if (!input.is_folder() && !options.columns.empty() && options.topic.empty()) return open_csv(input, options);
  if (const auto foreign = foreign_file(input.prefix())) throw InputError(input.name(), 0, *foreign);
  std::string names;
  for (const LogFormat& format : log_formats()) {
    if (format.probe(input)) {
      if (!options.topic.empty() && !format.topics)
        throw InputError(input.name(), 0,
                         "has no topics: " + std::string(format.name) + "; expected no --topic with it");
      if (!format.columns) expect_no_geometry(input, options, format.name);
      return format.open(input, options);
    }
    names += (names.empty() ? "" : ", ") + std::string(format.name);
  }
  if (const auto hint = numbers_hint(input.prefix())) throw InputError(input.name(), 1, *hint);
  throw InputError(input.name(), input.is_folder() ? 0 : 1,
                   std::string(input.is_folder() ? "is a folder of no known format" : "is of no known format") +
                       "; expected one of " + names);
}

}  // namespace

std::unique_ptr<LogReader> open_log(const std::string& path, const LogOptions& options) {
  LogInput input(path);
  const bool is_database = input.prefix().starts_with("SQLite format 3");  // not read front to back
  auto log = open_any(input, options);
  if (cuts_anything(options)) log = cut_log(std::move(log), options);
  if (input.is_file() && !is_database) log->count_bytes(input.bytes_read(), file_size_bytes(input.path()));
  return log;
}

}  // namespace phasescan
