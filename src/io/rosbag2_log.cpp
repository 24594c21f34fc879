#include "io/rosbag2_log.hpp"

#include <fcntl.h>
#include <unistd.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <filesystem>
#include <fstream>

#include "io/decompress.hpp"
#include "io/mcap_log.hpp"
#include "io/ros_log.hpp"
#include "io/sqlite_bag.hpp"
#include "phasescan/io/error.hpp"

namespace phasescan {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kMostMetadataBytes = std::uintmax_t{1} << 24;
constexpr std::size_t kMostFiles = 100'000;

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
  if (!looks_like_sqlite(stream.peek(16))) throw DecodeError("neither sqlite3 nor MCAP");
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

/// metadata.yaml names the files relative to the folder; before version 4 with the folder's own name in front.
std::string split_path(const fs::path& folder, const std::string& stated) {
  for (const fs::path& candidate : {folder / stated, folder / (stated + ".zstd"), folder / fs::path(stated).filename(),
                                    folder / (fs::path(stated).filename().string() + ".zstd")}) {
    std::error_code error;
    if (fs::is_regular_file(candidate, error)) return candidate.string();
  }
  return (folder / stated).string();
}

struct Recording {
  bool whole = true;  ///< the metadata reach as far as their count of messages, which stands behind the files
  std::deque<std::string> files;
  std::map<std::string, std::string> about;
};

Recording read_metadata(const fs::path& folder, const fs::path& metadata) {
  std::error_code error;
  if (fs::file_size(metadata, error) > kMostMetadataBytes || error) {
    throw InputError(metadata.string(), 0, "larger than 16 MiB, or not readable; expected the metadata of rosbag2");
  }
  Recording out;
  try {
    std::ifstream file(metadata);
    const YAML::Node info = YAML::Load(file)["rosbag2_bagfile_information"];
    const YAML::Node paths = info["relative_file_paths"];
    if (!paths || !paths.IsSequence()) {
      throw InputError(metadata.string(), 0, "no relative_file_paths; expected the metadata of rosbag2");
    }
    for (const YAML::Node& path : paths) {
      if (out.files.size() < kMostFiles) out.files.push_back(split_path(folder, path.as<std::string>()));
    }
    out.whole = info["message_count"].IsDefined();
    for (const char* name : {"version", "storage_identifier", "compression_format", "compression_mode"}) {
      const YAML::Node value = info[name];
      if (value && value.IsScalar() && !value.Scalar().empty()) out.about[name] = value.Scalar();
    }
  } catch (const YAML::Exception& problem) {
    throw InputError(metadata.string(), problem.mark.line + 1, problem.msg + "; expected the metadata of rosbag2");
  }
  return out;
}

/// rosbag2 numbers its splits without leading zeros: compare runs of digits by value.
bool natural_less(const std::string& a, const std::string& b) {
  const auto number_at = [](const std::string& text) {
    const auto end = text.find_last_of("0123456789");
    if (end == std::string::npos) return std::string();
    const auto before = text.find_last_not_of("0123456789", end);
    return text.substr(before == std::string::npos ? 0 : before + 1,
                       end - (before == std::string::npos ? 0 : before + 1) + 1);
  };
  const std::string x = number_at(fs::path(a).stem().stem().string());
  const std::string y = number_at(fs::path(b).stem().stem().string());
  if (x.size() != y.size()) return x.size() < y.size();
  return x != y ? x < y : a < b;
}

Recording list_folder(const fs::path& folder) {
  Recording out;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end && out.files.size() < kMostFiles;
       it.increment(error)) {
    const std::string name = it->path().filename().string();
    const bool ours = name.ends_with(".db3") || name.ends_with(".mcap") || name.ends_with(".db3.zstd") ||
                      name.ends_with(".mcap.zstd");
    if (ours) out.files.push_back(it->path().string());
  }
  if (error) throw SystemError(folder.string(), error.message());
  std::sort(out.files.begin(), out.files.end(), natural_less);
  out.about["metadata.yaml"] = "missing: the files were taken by their numbers";
  return out;
}

/// x_0.db3 and x_0.db3.zstd are the same file.
std::string bare_name(const std::string& path) {
  const fs::path name = fs::path(path).filename();
  return (name.extension() == ".zstd" ? name.stem() : name).string();
}

/// Metadata that were cut off name too few files: the others are read as well.
void add_unnamed_files(const std::deque<std::string>& present, const std::string& metadata, Recording& stated,
                       ros::RosLogReader& log) {
  for (const std::string& path : present) {
    const auto same = [&path](const std::string& named) { return bare_name(named) == bare_name(path); };
    if (std::any_of(stated.files.begin(), stated.files.end(), same)) continue;
    log.damage("file not named", path, "is not named in " + metadata + ", which was cut off; it is read as well");
    stated.files.push_back(path);
  }
}

}  // namespace

std::unique_ptr<LogReader> open_rosbag2_folder(const std::string& path, const LogOptions& options) {
  const fs::path metadata = fs::path(path) / "metadata.yaml";
  std::error_code error;
  auto log = std::make_unique<ros::RosLogReader>(path, options);
  Recording recording = list_folder(path);
  if (fs::exists(metadata, error)) {
    try {
      Recording stated = read_metadata(path, metadata);
      if (!stated.whole) add_unnamed_files(recording.files, metadata.string(), stated, *log);
      recording = std::move(stated);
    } catch (const InputError& problem) {
      if (recording.files.empty()) throw;
      log->damage("bad metadata", problem.file(), problem.reason() + "; the files were taken by their numbers");
    }
  }
  if (recording.files.empty()) {
    throw InputError(path, 0, "is a folder without metadata.yaml, .db3 or .mcap; expected a rosbag2 recording");
  }
  log->read_from(std::make_unique<FolderContainer>(std::move(recording.files), std::move(recording.about), *log));
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
