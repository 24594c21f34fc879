#include "io/rosbag2_log.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <deque>

#include "io/decompress.hpp"
#include "io/foreign_files.hpp"
#include "io/log_input.hpp"
#include "io/mcap_log.hpp"
#include "io/ros_log.hpp"
#include "io/rosbag2_files.hpp"
#include "io/sqlite_bag.hpp"
#include "phasescan/io/error.hpp"

namespace phasescan {
namespace {

/// A file that is gone with the object.
class TemporaryFile {
 public:
  TemporaryFile() {
    const char* folder = std::getenv("TMPDIR");
    path_ = std::string(folder != nullptr && *folder != '\0' ? folder : "/tmp") + "/phasescan-XXXXXX";
    fd_ = ::mkostemp(path_.data(), O_CLOEXEC);
    if (fd_ < 0) throw SystemError(path_, std::strerror(errno));
  }
  ~TemporaryFile() {
    ::close(fd_);
    ::unlink(path_.c_str());
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  const std::string& path() const { return path_; }
  void write(Bytes bytes) {
    while (!bytes.empty()) {
      const ssize_t done = ::write(fd_, bytes.data(), bytes.size());
      if (done < 0 && errno == EINTR) continue;
      if (done < 0) throw SystemError(path_, std::strerror(errno));
      bytes = bytes.subspan(static_cast<std::size_t>(done));
    }
  }

 private:
  std::string path_;
  int fd_ = -1;
};

class SqliteContainer final : public ros::Container {
 public:
  /// `path` is what the user knows the file by; the database is in `unpacked` where there is one.
  SqliteContainer(std::string path, std::unique_ptr<TemporaryFile> unpacked, ros::RosLogReader& log)
      : path_(std::move(path)), unpacked_(std::move(unpacked)), bag_(unpacked_ ? unpacked_->path() : path_), log_(log) {
    if (!bag_.cut().empty()) log_.damage("truncated file", path_, bag_.cut());
    if (!bag_.head_damage().empty()) log_.damage("bad database", path_, bag_.head_damage());
    for (const BagTopic& topic : bag_.topics()) {
      const bool cdr = topic.serialization == "cdr" || topic.serialization.empty();
      channels_[topic.id] =
          log_.channel(topic.name, cdr ? topic.type : topic.type + " as " + topic.serialization, ros::Wire::kCdr);
    }
  }

  std::string format() const override { return "rosbag2 sqlite3"; }

  bool read_more() override {
    try {
      const std::optional<BagRow> row = bag_.next();
      if (!row) return false;
      const auto channel = channels_.find(row->topic_id);
      if (channel == channels_.end()) {
        log_.bad_message("topic " + std::to_string(row->topic_id), "the topic was never described");
      } else {
        log_.maybe_packed_message(*channel->second, row->time, row->data);
      }
    } catch (const DecodeError& error) {
      log_.damage("bad database", path_, error.what());
    }
    return true;
  }

 private:
  std::string path_;
  std::unique_ptr<TemporaryFile> unpacked_;
  SqliteBag bag_;
  ros::RosLogReader& log_;
  std::map<std::int64_t, ros::Channel*> channels_;
};

/// The rest of a stream in a file for sqlite; what was unpacked before damage is kept.
std::unique_ptr<TemporaryFile> unpack(const std::string& path, ByteStream& stream, ros::RosLogReader& log) {
  auto file = std::make_unique<TemporaryFile>();
  try {
    for (;;) {
      std::vector<std::uint8_t> piece(std::size_t{1} << 16);
      const std::size_t got = stream.read_some(piece.data(), piece.size());
      if (got == 0) break;
      file->write(Bytes(piece.data(), got));
    }
  } catch (const DecodeError& error) {
    log.damage("bad compression", path, error.what());
  }
  return file;
}

std::unique_ptr<ros::Container> open_split(const std::string& path, ros::RosLogReader& log) {
  ByteStream stream(open_file_source(path));
  bool packed = false;
  if (const Compression compression = sniff_compression(stream.peek(4)); compression != Compression::kNone) {
    stream = ByteStream(decompress(compression, open_file_source(path)));
    packed = true;
  }
  if (looks_like_mcap(stream.peek(16))) return mcap_container(path, std::move(stream), log);
  const Bytes first = stream.peek(LogInput::kPrefixBytes);
  if (const auto foreign = foreign_file({reinterpret_cast<const char*>(first.data()), first.size()}))
    throw DecodeError(*foreign);
  if (!looks_like_sqlite(first)) throw DecodeError("neither sqlite3 nor MCAP");
  return std::make_unique<SqliteContainer>(path, packed ? unpack(path, stream, log) : nullptr, log);
}

/// The files of a recording one after another: transforms of the first hold for all.
class FolderContainer final : public ros::Container {
 public:
  FolderContainer(std::deque<std::string> files, std::map<std::string, std::string> about, ros::RosLogReader& log)
      : files_(std::move(files)), about_(std::move(about)), log_(log) {
    about_["files"] = std::to_string(files_.size());
  }

  std::string format() const override { return "rosbag2 folder"; }
  void add_facts(std::map<std::string, std::string>& out) const override {
    out.insert(about_.begin(), about_.end());
    if (current_) current_->add_facts(out);
  }

  bool read_more() override {
    if (current_ && current_->read_more()) return true;
    if (files_.empty()) return false;
    const std::string path = files_.front();
    files_.pop_front();
    current_.reset();
    try {
      current_ = open_split(path, log_);
    } catch (const DecodeError& error) {
      log_.damage("bad file", path, error.what());
    } catch (const InputError& error) {
      log_.damage("missing file", error.file(), "named in metadata.yaml and not there");
    }
    return true;
  }

 private:
  std::deque<std::string> files_;
  std::map<std::string, std::string> about_;
  ros::RosLogReader& log_;
  std::unique_ptr<ros::Container> current_;
};

}  // namespace

std::unique_ptr<LogReader> open_rosbag2_folder(const std::string& path, const LogOptions& options) {
  Rosbag2Files found = find_rosbag2_files(path);
  auto log = std::make_unique<ros::RosLogReader>(path, options);
  for (const auto& [kind, place, why] : found.damages) log->damage(kind, place, why);
  log->read_from(std::make_unique<FolderContainer>(std::move(found.files), std::move(found.about), *log));
  return log;
}

std::unique_ptr<LogReader> open_rosbag2_sqlite(const std::string& path, const LogOptions& options) {
  auto log = std::make_unique<ros::RosLogReader>(path, options);
  try {
    log->read_from(std::make_unique<SqliteContainer>(path, nullptr, *log));
  } catch (const DecodeError& problem) {
    throw InputError(path, 0, problem.what());
  }
  return log;
}

std::unique_ptr<LogReader> open_rosbag2_packed_sqlite(const std::string& path, ByteStream stream,
                                                      const LogOptions& options) {
  auto log = std::make_unique<ros::RosLogReader>(path, options);
  try {
    auto file = unpack(path, stream, *log);
    log->read_from(std::make_unique<SqliteContainer>(path, std::move(file), *log));
  } catch (const DecodeError& problem) {
    throw InputError(path, 0, problem.what());
  }
  return log;
}

}  // namespace phasescan
