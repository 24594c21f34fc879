// The containers of ROS, told apart by content, packed or not.
#include "io/log_format.hpp"
#include "io/mcap_log.hpp"
#include "io/rosbag1_log.hpp"
#include "io/rosbag2_log.hpp"
#include "io/sqlite_bag.hpp"
#include "phasescan/io/error.hpp"

namespace phasescan {
namespace {

Bytes first_bytes(const LogInput& input) {
  return {reinterpret_cast<const std::uint8_t*>(input.prefix().data()), input.prefix().size()};
}

std::unique_ptr<LogReader> open_rosbag2(LogInput& input, const LogOptions& options) {
  if (input.is_folder()) return open_rosbag2_folder(input.path(), options);
  if (input.is_packed()) return open_rosbag2_packed_sqlite(input.name(), input.take(), options);
  if (input.is_file()) return open_rosbag2_sqlite(input.path(), options);
  throw InputError(input.name(), 0,
                   "is a .db3 (sqlite3) on a pipe; expected it as a file, since a database is not read front to back");
}

}  // namespace

LogFormat rosbag1_format() {
  return {"rosbag1", [](const LogInput& input) { return looks_like_rosbag1(first_bytes(input)); }, open_rosbag1, true};
}

LogFormat rosbag2_format() {
  return {"rosbag2 (a folder or a .db3)",
          [](const LogInput& input) { return input.is_folder() || looks_like_sqlite(first_bytes(input)); },
          open_rosbag2, true};
}

LogFormat mcap_format() {
  return {"MCAP", [](const LogInput& input) { return looks_like_mcap(first_bytes(input)); },
          [](LogInput& input, const LogOptions& options) { return open_mcap(input.name(), input.take(), options); },
          true};
}

}  // namespace phasescan
