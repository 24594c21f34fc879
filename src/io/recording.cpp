#include "io/recording.hpp"

#include <filesystem>

#include "io/csv_log.hpp"
#include "io/decompress.hpp"
#include "io/lowcost_log.hpp"
#include "io/mcap_log.hpp"
#include "io/rosbag1_log.hpp"
#include "io/rosbag2_log.hpp"
#include "io/sqlite_bag.hpp"
#include "phasescan/io/error.hpp"

namespace phasescan {
namespace {

constexpr std::size_t kPrefixBytes = std::size_t{1} << 17;

/// The first line that is no comment.
std::string_view first_line(std::string_view text) {
  for (;;) {
    const std::size_t end = text.find('\n');
    std::string_view line = text.substr(0, end);
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    if (!line.empty() && line.front() != '#') return line;
    if (end == std::string_view::npos) return {};
    text.remove_prefix(end + 1);
  }
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
  const Bytes first = safe_peek(stream, kPrefixBytes);
  if (looks_like_rosbag1(first)) return open_rosbag1(path, std::move(stream), options);
  if (looks_like_mcap(first)) return open_mcap(path, std::move(stream), options);
  if (looks_like_sqlite(first)) {
    if (compression == Compression::kNone) return open_rosbag2_sqlite(path, options);
    return open_rosbag2_packed_sqlite(path, std::move(stream), options);
  }
  // Text is read through LineReader, which knows gzip alone.
  if (compression != Compression::kNone && compression != Compression::kGzip) return nullptr;
  if (!options.columns.empty()) return open_csv(path, options);
  const std::string_view text(reinterpret_cast<const char*>(first.data()), first.size());
  if (const auto lowcost = sniff_lowcost(first_line(text))) return open_lowcost(path, *lowcost);
  if (looks_like_csv(text)) return open_csv(path, options);
  return nullptr;
}

}  // namespace phasescan
