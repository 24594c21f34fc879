#include "phasescan/io/log.hpp"

#include <fmt/format.h>

#include <stdexcept>

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

/// Cuts that leave nothing of any log.
void expect_something_left(const LogOptions& options) {
  if (options.range_max > 0.0 && options.range_min >= options.range_max)
    throw std::invalid_argument(fmt::format("--range-min: {} is not below --range-max {}; expected a shorter range",
                                            options.range_min, options.range_max));
  if (options.from && options.to && *options.from > *options.to)
    throw std::invalid_argument(
        fmt::format("--from: {} is after --to {}; expected an earlier time", *options.from, *options.to));
}

/// Flags of logs with topics are a mistake for one without.
void expect_no_topic(const LogInput& input, const LogOptions& options, std::string_view format) {
  const char* flag = !options.topic.empty() ? "--topic" : !options.frame.empty() ? "--frame" : nullptr;
  if (flag == nullptr) return;
  throw InputError(input.name(), 0, fmt::format("has no topics: {}; expected no {} with it", format, flag));
}

std::unique_ptr<LogReader> open_any(LogInput& input, const LogOptions& options) {
  if (!input.is_folder() && !options.columns.empty() && options.topic.empty() && options.frame.empty())
    return open_csv(input, options);
  if (const auto foreign = foreign_file(input.prefix())) throw InputError(input.name(), 0, *foreign);
  std::string names;
  for (const LogFormat& format : log_formats()) {
    if (format.probe(input)) {
      if (!format.topics) expect_no_topic(input, options, format.name);
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
  expect_something_left(options);
  LogInput input(path);
  const bool is_database = input.prefix().starts_with("SQLite format 3");  // not read front to back
  auto log = open_any(input, options);
  if (cuts_anything(options)) log = cut_log(std::move(log), options);
  if (input.is_file() && !is_database) log->count_bytes(input.bytes_read(), file_size_bytes(input.path()));
  return log;
}

}  // namespace phasescan
