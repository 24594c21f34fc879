#include "io/recording.hpp"

#include <filesystem>

#include "io/decompress.hpp"
#include "io/log_format.hpp"
#include "io/mcap_log.hpp"
#include "io/rosbag1_log.hpp"
#include "io/rosbag2_log.hpp"
#include "io/sqlite_bag.hpp"
#include "phasescan/io/error.hpp"

namespace phasescan {
namespace {

Bytes as_bytes(std::string_view text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

/// As much of the beginning as can be had; damage further on is the reader's to name.
Bytes safe_peek(ByteStream& stream, std::size_t n) {
  try {
    return stream.peek(n);
  } catch (const DecodeError&) {
    return stream.buffered();
  }
}

}  // namespace

std::unique_ptr<LogReader> open_recording(const std::string& path, const LogOptions& options) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error)) return open_rosbag2_folder(path, options);
  ByteStream stream(open_file_source(path));
  const Compression compression = sniff_compression(stream.peek(4));
  if (compression != Compression::kNone) stream = ByteStream(decompress(compression, open_file_source(path)));
  const Bytes first = safe_peek(stream, 16);
  if (looks_like_rosbag1(first)) return open_rosbag1(path, std::move(stream), options);
  if (looks_like_mcap(first)) return open_mcap(path, std::move(stream), options);
  if (looks_like_sqlite(first)) {
    if (compression == Compression::kNone) return open_rosbag2_sqlite(path, options);
    return open_rosbag2_packed_sqlite(path, std::move(stream), options);
  }
  return nullptr;
}

namespace {

std::unique_ptr<LogReader> open_known(const std::string& path, const LogOptions& options) {
  auto log = open_recording(path, options);
  if (!log) throw InputError(path, 0, "is no recording; expected a rosbag or an MCAP");
  return log;
}

}  // namespace

LogFormat rosbag1_format() {
  return {"rosbag1", [](const std::string&, std::string_view prefix) { return looks_like_rosbag1(as_bytes(prefix)); },
          open_known, true};
}

LogFormat rosbag2_format() {
  return {
      "rosbag2 (a folder or a .db3)",
      [](const std::string&, std::string_view prefix) { return prefix.empty() || looks_like_sqlite(as_bytes(prefix)); },
      open_known, true};
}

LogFormat mcap_format() {
  return {"MCAP", [](const std::string&, std::string_view prefix) { return looks_like_mcap(as_bytes(prefix)); },
          open_known, true};
}

}  // namespace phasescan
