#include "phasescan/io/log.hpp"

#include <filesystem>

#include "io/csv_log.hpp"
#include "io/log_format.hpp"
#include "phasescan/io/error.hpp"
#include "io/file.hpp"

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
  std::error_code ignored;
  const auto kind = std::filesystem::status(path, ignored).type();
  if (kind == std::filesystem::file_type::fifo || kind == std::filesystem::file_type::socket)
    throw InputError(path, 0, "is a pipe; expected a file, since a log is read more than once");
  const bool folder = kind == std::filesystem::file_type::directory;
  const std::string prefix = folder ? std::string() : read_prefix(path, kPrefixBytes);
  if (!folder && prefix.empty()) throw InputError(path, 1, "the file is empty; expected a log");
  if (!folder && !options.columns.empty() && options.topic.empty()) return open_csv(path, options);
  std::string names;
  for (const LogFormat& format : log_formats()) {
    if (format.probe(path, prefix)) {
      if (!options.topic.empty() && !format.topics)
        throw InputError(path, 0, "has no topics: " + std::string(format.name) + "; expected no --topic with it");
      return format.open(path, options);
    }
    names += (names.empty() ? "" : ", ") + std::string(format.name);
  }
  throw InputError(
      path, folder ? 0 : 1,
      std::string(folder ? "is a folder of no known format" : "is of no known format") + "; expected one of " + names);
}

}  // namespace phasescan
