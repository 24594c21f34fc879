#include "phasescan/io/log.hpp"

#include <filesystem>

#include "io/csv_log.hpp"
#include "io/log_format.hpp"
#include "phasescan/io/error.hpp"

namespace phasescan {
namespace {

// Asked in this order: what is recognised by a magic number first, text by its words after.
std::vector<LogFormat> log_formats() {
  return {
      rosbag1_format(), rosbag2_format(), mcap_format(), scan_log_format(),
      carmen_format(),  lowcost_format(), csv_format(),
  };
}

}  // namespace

std::unique_ptr<LogReader> open_log(const std::string& path, const LogOptions& options) {
  LogInput input(path);
  if (!input.is_folder() && !options.columns.empty() && options.topic.empty()) return open_csv(input, options);
  std::string names;
  for (const LogFormat& format : log_formats()) {
    if (format.probe(input)) {
      if (!options.topic.empty() && !format.topics)
        throw InputError(input.name(), 0,
                         "has no topics: " + std::string(format.name) + "; expected no --topic with it");
      return format.open(input, options);
    }
    names += (names.empty() ? "" : ", ") + std::string(format.name);
  }
  throw InputError(input.name(), input.is_folder() ? 0 : 1,
                   std::string(input.is_folder() ? "is a folder of no known format" : "is of no known format") +
                       "; expected one of " + names);
}

bool can_be_read_again(const std::string& path) {
  std::error_code ignored;
  return is_regular_file(path) || std::filesystem::is_directory(path, ignored);
}

}  // namespace phasescan
